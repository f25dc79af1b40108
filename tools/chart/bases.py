"""Directional bases: what a few floats can say about E(n), and what they are worth at equal memory."""
import csv
import math
import pathlib
import random

import probes
import tables
from front import slug
from steps import File, Out, Point, Step
from writer.gltf import Gltf
from writer.shapes import Piece

TITLE = "Directional bases"
ABOUT = """First, light that is the same everywhere: the error is the basis' alone (RMS over normals and colours, divided by the mean E).
One, four and sixty-four distant lights have a closed form; environments are judged by their exact irradiance. The grids are baked
from millions of photons, whose noise is a few tenths of a per cent at most. Then whole rooms at equal memory: the more floats a vertex takes, the
fewer vertices there are."""

BASES = (("vectors", "optimal"), ("vectors", "paper"), ("vectors9", "optimal"), ("sh9", "optimal"), ("ambient_cube", "optimal"),
         ("sh4", "optimal"))
FLOATS = {"vectors": 12, "vectors9": 9, "sh9": 9, "ambient_cube": 6, "sh4": 4}


def label(basis, reconstruction):
    return "vectors, paper's remap" if reconstruction == "paper" else basis


def tiny_scene(path, lights):
    """Two black specks, which say where the grid goes, under distant lights: [(direction travelled, lux)]."""
    gltf, specks = Gltf(), Piece()
    for s in (-0.5, 0.5):
        specks.quad((s, s, s), (s - math.copysign(1e-3, s), s, s), (s - math.copysign(1e-3, s), s - math.copysign(1e-3, s), s),
                    (s, s - math.copysign(1e-3, s), s - math.copysign(1e-3, s)))
    gltf.node("specks", mesh=gltf.mesh("specks", {"black": specks}, {"black": gltf.material("black", (0.0, 0.0, 0.0))}))
    if lights:
        punctual = gltf.root.setdefault("extensions", {}).setdefault("KHR_lights_punctual", {"lights": []})["lights"]
        gltf.used.add("KHR_lights_punctual")
    for d, lux in lights:
        # A node's light shines along its -Z: the rotation that takes -Z to d.
        axis = (d[1], -d[0], 0.0)  # (0, 0, -1) x d
        w = 1 - d[2]
        q = [*axis, w] if w > 1e-9 else [1.0, 0.0, 0.0, 0.0]
        length = math.sqrt(sum(x * x for x in q))
        punctual.append({"type": "directional", "color": [1.0, 1.0, 1.0], "intensity": lux})
        gltf.node("light", rotation=[x / length for x in q], extensions={"KHR_lights_punctual": {"light": len(punctual) - 1}})
    gltf.save(pathlib.Path(path))
    return path


def directional_points(suite, inputs):
    count, photons = (500, "2m") if suite == "full" else (200, "500k")
    normals = File(probes.normals(inputs.path(f"normals_{count}.csv"), count))
    cases = []
    for lights in (1, 4, 64):
        rng = random.Random(lights)
        for sample in range(3 if suite == "full" else 1):
            light = [(probes.direction(rng), rng.uniform(0.5, 1.5)) for _ in range(lights)]
            path = inputs.path(f"lights_{lights}_{sample}.gltf")
            cases.append((f"{lights} distant light{'s' if lights > 1 else ''}", str(sample), File(tiny_scene(path, light)), (), light))
    empty = File(tiny_scene(inputs.path("lights_0.gltf"), []))
    for name, environment in inputs.environments("quick").items():
        cases.append(("environments", name, empty, ("--env", environment), None))

    for panel, name, scene, options, light in cases:
        truth = None
        if light is None:
            truth = Step(("probe", options[1], "--points", normals, Out("csv")))
        for basis, reconstruction in BASES:
            bake = Step(("bake", "grid", scene, *options, "--direct", "--resolution", 2, "--guard", "off", "--basis", basis, "--photons",
                         photons, Out("vdb")))
            probe = Step(("probe", bake, "--points", normals, "--guard", "off", "--nudge", 0, "--reconstruction", reconstruction,
                          Out("csv")))

            def measure(run, probe=probe, truth=truth, light=light, basis=basis):
                read = probes.rows(run.output(probe))
                exact = probes.rows(run.output(truth)) if truth else [([e] * 3, [0.0] * 3) for e in closed_form(normals, light)]
                found = probes.errors(read, exact, by_mean=True)
                return {"floats": FLOATS[basis], **{k: found[k] for k in ("nrmse", "nrmse_se", "worst")}}

            yield Point("bases", panel, label(basis, reconstruction), name, [s for s in (bake, truth, probe) if s], measure)


def closed_form(normals, light):
    with open(normals.path, newline="", encoding="ascii") as file:
        for row in csv.DictReader(file):
            n = [float(row[c]) for c in ("nx", "ny", "nz")]
            yield sum(lux * max(0.0, -sum(a * b for a, b in zip(n, d))) for d, lux in light)


def finest_voxel(extent_m, vertices):
    """Voxel size of the largest grid of at most so many vertices, by the rule of `ivory bake grid`."""
    start = (math.prod(extent_m) / vertices) ** (1 / 3)

    def count(voxel_m):
        return math.prod(max(2, math.ceil(e / voxel_m - 1e-3)) for e in extent_m)

    return max((v for v in (start * (0.8 + 0.002 * i) for i in range(500)) if count(v) <= vertices), key=lambda v: (count(v), -v))


def equal_memory_points(suite, inputs, runner):
    rooms = {"furnished room": (inputs.bundled("room_boxes_rotated.gltf"), inputs.bundled("room_boxes_rotated_points.csv"))}
    bunny = inputs.bunny_room() if suite == "full" else None
    if bunny:
        rooms["bunny's room"] = bunny
    budgets, photons, samples = ((250_000, 1_000_000, 4_000_000, 16_000_000), "8m", "16k") if suite == "full" else ((64_000, 250_000, 1_000_000), "1m", "4k")
    for name, (scene, points) in rooms.items():
        scene, points = File(scene), File(points)
        info = runner.result(Step(("info", scene)))["result"]
        extent_m = [b - a for a, b in zip(info["bounds_min_m"], info["bounds_max_m"])]
        truth = Step(("probe", scene, "--points", points, "--indirect-only", "--samples", samples, Out("csv")))
        for budget in budgets:
            for basis, reconstruction in BASES:
                vertices = budget // (12 * FLOATS[basis] + 20)  # and guard and visible fraction
                bake = Step(("bake", "grid", scene, "--voxel-size", f"{finest_voxel(extent_m, vertices):.6g}", "--photons", photons,
                             "--basis", basis, Out("vdb")), timed=True)
                probe = Step(("probe", bake, "--scene", scene, "--points", points, "--reconstruction", reconstruction, Out("csv")))

                def measure(run, bake=bake, probe=probe, truth=truth):
                    return {**probes.errors(probes.rows(run.output(probe)), probes.rows(run.output(truth))),
                            "memory_bytes": run.result(bake)["memory_bytes"]}

                yield Point("bases", f"{name}, equal memory", label(basis, reconstruction), tables.size(budget),
                            [bake, truth, probe], measure)


def points(suite, inputs, runner):
    return [*directional_points(suite, inputs), *equal_memory_points(suite, inputs, runner)]


def draw(records, figures):
    panels = []
    directional = [r for r in records if "floats" in r]
    for panel in dict.fromkeys(r["panel"] for r in directional):
        lines = []
        for series in dict.fromkeys(r["series"] for r in directional):
            here = [r for r in directional if r["panel"] == panel and r["series"] == series]
            if here:
                lines.append((series, [r["floats"] for r in here], [r["nrmse"] for r in here], None))
        panels.append((panel, "floats a channel", "RMS error / mean E", False, True, lines))
    if panels:
        figures.sweep("bases_directional", "Directional bases: error in light that is the same everywhere",
                      "A mark a set of lights or environment.", panels, columns=2, joined=False)
    for panel in dict.fromkeys(r["panel"] for r in records if "memory_bytes" in r):
        here = [r for r in records if r["panel"] == panel]
        figures.costs(here, slug("bases", panel.split(",")[0]), f"Bases: {panel}",
                      "Bake time grows with the number of vertices alone.",
                      axes=(("memory_bytes", "nrmse"), ("memory_bytes", "relative_rmse")))


def page_tables(records):
    found = []
    for panel in dict.fromkeys(r["panel"] for r in records):
        here = [r for r in records if r["panel"] == panel]
        head = ("basis", "case", "memory" if "memory_bytes" in here[0] else "floats a channel", "NRMSE" if "memory_bytes" in here[0] else
                "RMS error / mean E", "worst")
        rows = [(r["series"], r["label"], tables.size(r["memory_bytes"]) if "memory_bytes" in r else r["floats"],
                 f"{tables.percent(r['nrmse'])} ± {tables.number(100 * r['nrmse_se'], 2)}", tables.percent(r["worst"])) for r in here]
        found.append((f"All points: {panel}", head, rows, ()))
    return found


def markdown_tables(records):
    directional = [r for r in records if "floats" in r]
    panels = list(dict.fromkeys(r["panel"] for r in directional))
    rows = []
    for series in dict.fromkeys(r["series"] for r in directional):
        here = [r for r in directional if r["series"] == series]
        cells = [[r["nrmse"] for r in here if r["panel"] == p] for p in panels]
        rows.append((series, here[0]["floats"], *(tables.percent(sum(c) / len(c)) if c else "–" for c in cells)))
    found = {"bases_directional": tables.markdown(("basis", "floats a channel", *panels), rows)} if rows else {}
    memory = [r for r in records if "memory_bytes" in r]
    if memory:
        budgets = list(dict.fromkeys((r["panel"], r["label"]) for r in memory))
        rows = []
        for panel, budget in budgets:
            here = {r["series"]: r for r in memory if (r["panel"], r["label"]) == (panel, budget)}
            rows.append((panel.split(",")[0], budget, *(f"{tables.percent(here[s]['nrmse'])} ({tables.size(here[s]['memory_bytes'])})" if s in here
                                                        else "–" for s in dict.fromkeys(r["series"] for r in memory))))
        found["bases_memory"] = tables.markdown(("room", "at most", *dict.fromkeys(r["series"] for r in memory)), rows)
    return found
