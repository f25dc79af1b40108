"""Localized cube maps: by texels, by how they are read, by distance to the wall."""
import math
import pathlib
import random

import probes
import tables
from front import slug
from steps import File, Out, Point, Step
from writer import shapes
from writer.gltf import Gltf

TITLE = "Objects near a point: localized cube maps"
ABOUT = """E on a ball of 25 cm radius on its way to the wall of a coloured box, and at random points with random normals in free space of
whole rooms, against path tracing (light of punctual lights left out where the scene has any: no map holds it). NRMSE over points
and colours; the worst point in units of the range."""

LOOKUPS = ("convolved", "point", "polygon_paper", "polygon")
RADIUS_M = 0.25
GAPS_M = {"quick": (0.75, 0.3, 0.05, 0.01), "full": (0.75, 0.5, 0.3, 0.2, 0.1, 0.05, 0.02, 0.01)}


def box(inputs):
    """Half side 1 m, a wall a colour, a lamp in the ceiling."""
    walls = {"red": ((0, 4, 6, 2), (0.75, 0.1, 0.1)), "green": ((1, 3, 7, 5), (0.1, 0.65, 0.15)),
             "blue": ((0, 2, 3, 1), (0.15, 0.2, 0.7)), "yellow": ((4, 5, 7, 6), (0.7, 0.6, 0.1)),
             "floor": ((0, 1, 5, 4), (0.7, 0.7, 0.7)), "ceiling": ((2, 6, 7, 3), (0.7, 0.7, 0.7))}
    corner = [(-1.0 + 2 * (i & 1), -1.0 + (i & 2), -1.0 + (i & 4) / 2) for i in range(8)]
    gltf, pieces, materials = Gltf(), {}, {}
    for name, (corners, albedo) in walls.items():
        pieces[name] = shapes.Piece()
        pieces[name].quad_facing([corner[i] for i in corners], (0.0, 0.0, 0.0))
        materials[name] = gltf.material(name, albedo)
    pieces["lamp"] = shapes.Piece()
    pieces["lamp"].quad_facing([(-0.3, 0.999, -0.3), (0.3, 0.999, -0.3), (0.3, 0.999, 0.3), (-0.3, 0.999, 0.3)], (0.0, 0.0, 0.0))
    materials["lamp"] = gltf.material("lamp", (0.0, 0.0, 0.0), (10.0, 10.0, 10.0))
    gltf.node("box", mesh=gltf.mesh("box", pieces, materials))
    path = inputs.path("coloured_box.gltf")
    gltf.save(pathlib.Path(path))
    return path


def ball_points(inputs, gap, count):
    center = (-(1 - gap - RADIUS_M), 0.22, -0.38)
    found = []
    for i in range(count):  # a spiral
        y = 1 - (2 * i + 1) / count
        r, angle = math.sqrt(1 - y * y), 2.399963 * i
        n = (r * math.cos(angle), y, r * math.sin(angle))
        found.append((tuple(c + RADIUS_M * x for c, x in zip(center, n)), n))
    return probes.write(inputs.path(f"ball_{gap}_{count}.csv"), found)


def rooms(inputs, suite):
    """name, scene, reference point, corners of free space, is it lit by punctual lights?"""
    yield "coloured box", box(inputs), "0.25,-0.1,0.3", ((-0.98,) * 3, (0.98,) * 3), False
    yield ("two rooms", inputs.bundled("two_rooms.gltf"), "0.3,1.5,-7.5", ((-2.4, 0.1, -9.9), (2.4, 2.9, -5.1)), False)
    if suite == "full":
        yield ("furnished room", inputs.bundled("room_boxes.gltf"), "0.1,1.6,0.2", ((-2.4, 1.85, -1.9), (2.4, 2.7, 1.9)), True)
        yield "Cornell box", inputs.bundled("cornell_box.gltf"), "0.28,0.40,0.28", ((0.02, 0.36, 0.02), (0.53, 0.5, 0.53)), False


def points(suite, inputs, runner):
    full = suite == "full"
    sizes = (2, 4, 8, 16) if full else (2, 4, 8)
    samples, capture = ("8k", ()) if full else ("1k", ("--capture", 64))

    def bake(scene, at, texels):
        return Step(("bake", "cubemap", scene, "--at", at, "--size", texels, *capture, Out("exr")), timed=True)

    found = []

    def add(panel, series, texels, made, lookup, table, truth, **more):
        probe = Step(("probe", made, "--points", table, "--lookup", lookup, Out("csv")))
        bench = Step(("bench", "cubemap", made), threads=1)

        def measure(run):
            costs = run.result(bench)["maps"][0]
            return {**probes.errors(probes.rows(run.output(probe)), probes.rows(run.output(truth))), "memory_bytes": costs[f"{lookup}_bytes"], "read_ns": costs[f"{lookup}_ns"], **more}

        found.append(Point("cubemap", panel, series, more.get("mark", str(texels)), [made, truth, bench, probe], measure))

    scene = File(box(inputs))
    for gap in GAPS_M[suite]:
        table = File(ball_points(inputs, gap, 400 if full else 150))
        truth = Step(("probe", scene, "--points", table, "--samples", samples, Out("csv")))
        for texels in sizes[:3]:
            for lookup in LOOKUPS:
                add(f"ball at the wall, {texels}x{texels}", lookup, texels, bake(scene, "0,0,0", texels), lookup, table, truth, gap=gap,
                    mark=f"{gap} m")

    for name, path, at, (low, high), punctual in rooms(inputs, suite):
        rng, count = random.Random(1), 600 if full else 150
        table = File(probes.write(inputs.path(f"inside_{name.replace(' ', '_')}_{count}.csv"), [
            ([rng.uniform(a, b) for a, b in zip(low, high)], probes.direction(rng)) for _ in range(count)]))
        truth = Step(("probe", File(path), "--points", table, "--samples", samples, *(["--indirect-only"] if punctual else []), Out("csv")))
        for texels in sizes:
            for lookup in LOOKUPS:
                add(name, lookup, texels, bake(File(path), at, texels), lookup, table, truth)
    return found


def draw(records, figures):
    ball = [r for r in records if "gap" in r]
    panels = []
    for y, y_name in (("nrmse", "NRMSE"), ("worst", "worst point / range")):
        for panel in dict.fromkeys(r["panel"] for r in ball):
            lines = []
            for lookup in LOOKUPS:
                line = sorted((r["gap"], r[y], r["nrmse_se"] if y == "nrmse" else 0) for r in ball if r["panel"] == panel and
                              r["series"] == lookup)
                if line:
                    xs, ys, es = zip(*line)
                    lines.append((lookup, xs, ys, [min(e, 0.9 * v) for e, v in zip(es, ys)] if any(es) else None))
            panels.append((panel.split(", ")[1] + " texels a face", "distance to the wall, m", y_name, True, True, lines))
    if panels:
        figures.sweep("cubemap_wall", "Cube maps: a ball on its way to the wall", "", panels, columns=len(panels) // 2)
    for panel in dict.fromkeys(r["panel"] for r in records if "gap" not in r):
        figures.costs([r for r in records if r["panel"] == panel], slug("cubemap", panel), f"Cube maps: {panel}",
                      "Settings: texels along an edge of a face.", axes=(("read_ns", "nrmse"), ("memory_bytes", "nrmse"), ("memory_bytes", "relative_rmse"),
                                                                  ("read_ns", "relative_rmse")))


def page_tables(records):
    head = ("scene", "texels or distance", "read as", "memory", "one reading", "NRMSE", "worst / range", "bake")
    rows = [(r["panel"], r["label"], r["series"], tables.size(r["memory_bytes"]), f"{r['read_ns']:.0f} ns",
             f"{tables.percent(r['nrmse'])} ± {tables.number(100 * r['nrmse_se'], 2)}", tables.percent(r["worst"]),
             tables.seconds(r["time_s"])) for r in records]
    return [("All points", head, rows, ())]


def markdown_tables(records):
    found = {}
    for key, chosen in (("cubemap_wall", [r for r in records if "gap" in r]), ("cubemap_rooms", [r for r in records if "gap" not in r])):
        rows = []
        for panel, mark in dict.fromkeys((r["panel"], r["label"]) for r in chosen):
            here = {r["series"]: r for r in chosen if (r["panel"], r["label"]) == (panel, mark)}
            rows.append((panel, mark, *(f"{tables.number(here[s]['nrmse'], 2)}, {tables.number(here[s]['worst'], 2)}" if s in here else "–"
                                        for s in LOOKUPS)))
        if rows:
            found[key] = tables.markdown(("scene", "distance" if key.endswith("wall") else "texels", *LOOKUPS), rows)
    return found
