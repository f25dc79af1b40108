"""Occluder tables: shadows on planes against rays, and pictures with up to sixty occluders against path tracing."""
import pathlib
import random

import tables
from grid import errors, path_tracing_seconds
from front import slug
from steps import File, Out, Point, Step
from writer import shapes
from writer.gltf import Gltf

TITLE = "Moving occluders: FIV tables"
ABOUT = """First, planes beside and through one occluder, and several over one plane (`ivory bench fiv`): NRMSE of E against rays to every
texel of the environment, one line a number of spheres or samples. Then whole pictures of occluders on a floor under the sky against
path tracing (one bounce: light of the sky and its shadow): the bake counts once, however many occluders it serves."""

AMBIENT_BYTES = 6 * 64 * 64 * 3 * 4  # the irradiance map of the unshadowed light, floats
CASES = {"floating": ("six_hemispheres",), "standing": ("six_hemispheres", "one_vector", "published_scale"),
         "tilted": ("six_hemispheres", "one_vector", "published_scale"), "two": ("covers", "discs", "product", "uncorrected"),
         "four": ("covers", "discs", "product", "uncorrected")}
TITLES = {"floating": "over a plane", "standing": "standing on a plane", "tilted": "a plane through it", "two": "two over a plane",
          "four": "four over a plane"}


def table_bytes(samples, hemispheres):
    a, p, d = (int(x) for x in samples.split(","))
    return a * p * d * 9 * 4 * (4 if hemispheres == 6 else 1)


def plane_points(suite, inputs):
    mesh = File(inputs.occluder())
    known = inputs.environments(suite)
    lights = [(name, ("--env", environment)) for name, environment in known.items()
              if name in ("sky", "drachenfels_cellar", "noon_grass")]
    lights += [("two area lights", ("--light", "two")), ("one hard light", ("--light", "one"))]
    if suite == "full":
        samples, truth = ("16,9,8", "32,17,15", "64,33,30", "128,65,30"), 64
        spheres = ("64,33,8", "64,33,15", "64,33,60")
    else:
        lights = [l for l in lights if l[0] in ("sky", "one hard light")]
        samples, truth, spheres = ("16,9,8", "32,17,15", "64,33,30"), 32, ()
    for name, options in lights:
        for s in (*samples, *(spheres if name == "sky" else ())):
            bench = Step(("bench", "fiv", mesh, *options, "--samples", s, "--truth", truth))
            for case, variants in CASES.items():
                for variant in variants:
                    hemispheres = 1 if variant in ("one_vector", "published_scale") else 6

                    def measure(run, bench=bench, case=case, variant=variant, s=s, hemispheres=hemispheres, name=name):
                        result = run.result(bench)
                        return {"nrmse": result["nrmse"][case][variant], "memory_bytes": table_bytes(s, hemispheres), "samples": s,
                                "light": name,
                                "read_ns": result["read_one_ns" if hemispheres == 1 else "read_six_ns"],
                                "ray_ns": result["occlusion_ray_ns"]}

                    yield Point("fiv", f"{name}, {case}", variant.replace("_", " "), s, [bench], measure, join=s in samples)


def crowd(inputs, count):
    """`count` knots of several sizes on a floor of 8 m, as nodes of one mesh, so close that shadows meet."""
    path = inputs.path(f"crowd_{count}.gltf")
    gltf, floor, rng = Gltf(), shapes.Piece(), random.Random(7)
    floor.positions = [(-4.0, 0.0, -4.0), (-4.0, 0.0, 4.0), (4.0, 0.0, 4.0), (4.0, 0.0, -4.0)]
    floor.triangles = [(0, 1, 2), (0, 2, 3)]
    gltf.node("floor", mesh=gltf.mesh("floor", {"stone": floor}, {"stone": gltf.material("stone", (0.6, 0.58, 0.55))}))
    mesh = gltf.mesh("knot", {"clay": shapes.torus_knot(200, 24, True)}, {"clay": gltf.material("clay", (0.7, 0.55, 0.45))},
                     quantize_scale=1.0)
    side = max(1, round(count ** 0.5 + 0.49))
    cell = 6.4 / side
    for i in range(count):
        scale = min(0.9, 0.42 * cell) * rng.uniform(0.8, 1.1)
        x, z = (-3.2 + cell * (k + 0.5 + rng.uniform(-0.15, 0.15)) for k in (i % side, i // side))
        gltf.node("knot", mesh=mesh, scale=[scale] * 3, translation=[x, scale * rng.uniform(0.5, 0.9), z])
    gltf.camera("visitor", (1.2, 3.6, 5.6), (0.0, 0.0, 0.0), 0.8)
    gltf.save(pathlib.Path(path))
    return path


def picture_points(suite, inputs):
    environments = inputs.environments(suite)
    full = suite == "full"
    names = [n for n in ("sky", "noon_grass") if n in environments] if full else ["sky"]
    size, reference = ("240x180", "1k") if full else ("120x90", "1k")
    knot = File(inputs.bundled("knot.glb"))
    for name in names:
        env = ("--env", environments[name])

        def scene_points(count, tables_wanted, samples_of_paths, extra=()):
            scene = File(crowd(inputs, count))
            panel = f"{count} knot{'s' if count > 1 else ''}, {name}"
            references = [Step(("render", scene, *env, "--method", "path", "--max-bounces", 1, "--samples", reference, "--size", size,
                                "--seed", seed, Out("exr"))) for seed in (101, 102)]

            def picture(series, label, image, bakes, memory, join=True):
                compare = Step(("compare", image, *references))

                def measure(run):
                    return {**errors(run.result(compare)), "memory_bytes": memory, "occluders": count,
                            "picture_s": run.seconds(image), "bake_s": sum(run.seconds(b) for b in bakes)}

                return Point("fiv", panel, series, label, [*bakes, image, compare], measure, join)

            ambient = Step(("bake", "difmap", environments[name], "--size", 64, Out("exr")), timed=True)
            for n in samples_of_paths:
                yield picture("path tracing", str(n), Step(("render", scene, *env, "--method", "path", "--max-bounces", 1, "--samples", n,
                                                            "--size", size, Out("exr")), timed=True), (), 0)
            for samples, hemispheres, precision in tables_wanted:
                bake = Step(("bake", "fiv", knot, *env, "--samples", samples, "--hemispheres", hemispheres, "--precision", precision,
                             Out("exr")), timed=True)
                for overlap in ("covers", *extra):
                    image = Step(("render", scene, *env, "--method", "fiv", "--occluder", ("knot=", bake), "--samples", 4, "--size", size,
                                  "--overlap", overlap, "--ambient", ambient, Out("exr")), timed=True)
                    series = "six hemispheres" if hemispheres == 6 else "one vector"
                    series += "" if precision == "float32" else ", float16"
                    series += "" if overlap == "covers" else f", overlaps by {overlap}"
                    memory = table_bytes(samples, hemispheres) // (1 if precision == "float32" else 2) + AMBIENT_BYTES
                    yield picture(series, samples, image, (bake, ambient), memory, overlap == "covers")

        if full:
            sizes = [(s, h, "float32") for h in (6, 1) for s in ("16,9,8", "32,17,15", "64,33,30", "128,65,30")]
            sizes += [("64,33,30", 6, "float16"), ("64,33,30", 1, "float16")]
            yield from scene_points(1, sizes, (1, 4, 16, 64))
            for count in (4, 15, 60):
                yield from scene_points(count, [("64,33,30", 6, "float32")], (1, 4, 16, 64), ("discs", "product", "none"))
        else:
            yield from scene_points(1, [("16,9,8", 6, "float32"), ("32,17,15", 6, "float32"), ("32,17,15", 1, "float32"),
                                        ("32,17,15", 6, "float16")], (1, 4, 16))
            for count in (15, 60):
                yield from scene_points(count, [("32,17,15", 6, "float32")], (1, 4, 16), ("none",))


def points(suite, inputs, runner):
    return [*plane_points(suite, inputs), *picture_points(suite, inputs)]


def draw(records, figures):
    planes = [r for r in records if "samples" in r]
    for case in CASES:
        here = [r for r in planes if r["panel"].endswith(", " + case) and r["join"]]
        lights = list(dict.fromkeys(r["light"] for r in here))
        panels = []
        for light in lights:
            lines = []
            for series in dict.fromkeys(r["series"] for r in here):
                line = [r for r in here if r["light"] == light and r["series"] == series]
                if line:
                    lines.append((series, [r["memory_bytes"] for r in line], [r["nrmse"] for r in line], None))
            panels.append((light, "memory", "NRMSE", True, True, lines))
        if panels:
            figures.sweep(f"fiv_{case}", f"FIV tables: {TITLES[case]}", "By the size of the table.", panels)
    spheres = [r for r in planes if r["samples"].startswith("64,33,") and r["series"] in ("six hemispheres", "covers")]
    if any(not r["join"] for r in spheres):
        lights = list(dict.fromkeys(r["light"] for r in spheres if not r["join"]))
        figures.sweep("fiv_spheres", "FIV tables: number of distance spheres", "64×33 directions; radii placed by the pilot bake.", [
            (light, "spheres", "NRMSE", True, True,
             [(case, *zip(*sorted((int(r["samples"].split(",")[2]), r["nrmse"]) for r in spheres
                                  if r["light"] == light and r["panel"].endswith(", " + case))), None) for case in CASES])
            for light in lights])
    pictures = [r for r in records if "occluders" in r]
    for panel in dict.fromkeys(r["panel"] for r in pictures):
        figures.costs([r for r in pictures if r["panel"] == panel], slug("fiv", panel),
                      f"FIV tables in a picture: {panel}", "", axes=(("time_s", "nrmse"), ("picture_s", "nrmse"), ("memory_bytes", "nrmse"),
                                                                     ("picture_s", "relative_rmse")))
    counts = sorted({r["occluders"] for r in pictures})
    if len(counts) > 1:
        # One setting that all numbers of occluders have.
        common = set.intersection(*({r["label"] for r in pictures if r["occluders"] == c and r["series"] == "six hemispheres"} for c in counts))
        lines = []
        for name in dict.fromkeys(r["panel"].split(", ")[1] for r in pictures):
            here = [r for r in pictures if r["panel"].endswith(", " + name)]
            tabled = sorted((r for r in here if r["series"] == "six hemispheres" and r["label"] == max(common)), key=lambda r: r["occluders"])
            same = [path_tracing_seconds([p for p in here if p["occluders"] == r["occluders"]], r["nrmse"]) for r in tabled]
            xs = [r["occluders"] for r in tabled]
            lines += [(f"tables, {name}", xs, [r["picture_s"] for r in tabled], None),
                      (f"path tracing to the same error, {name}", xs, same, None)]
        figures.sweep("fiv_occluders", f"FIV tables of {max(common).replace(',', '×')} samples: time of a picture by the number of occluders", "",
                      [("", "occluders", "time of a picture, s", True, True, lines)])


def page_tables(records):
    planes = [r for r in records if "samples" in r]
    rows = [(r["light"], TITLES[r["panel"].rsplit(", ", 1)[1]], r["series"], r["label"], tables.size(r["memory_bytes"]),
             tables.percent(r["nrmse"]), f"{r['read_ns']:.0f} ns", f"{r['ray_ns']:.0f} ns") for r in planes]
    found = [("All points on planes", ("light", "case", "method", "samples", "memory", "NRMSE", "one reading", "one occlusion ray"), rows,
              ())]
    pictures = [r for r in records if "occluders" in r]
    return found + [(f"All points: {panel}", *tables.points_table([r for r in pictures if r["panel"] == panel]))
                    for panel in dict.fromkeys(r["panel"] for r in pictures)]


def markdown_tables(records):
    planes = [r for r in records if "samples" in r]
    columns = [(c, v.replace("_", " ")) for c, variants in CASES.items() for v in variants]
    rows = []
    for light, samples in dict.fromkeys((r["light"], r["samples"]) for r in planes):
        here = {(r["panel"].rsplit(", ", 1)[1], r["series"]): r["nrmse"] for r in planes if (r["light"], r["samples"]) == (light, samples)}
        rows.append((light, samples.replace(",", "×"), *(tables.number(here[c]) if c in here else "–" for c in columns)))
    head = ("environment", "samples", *(f"{TITLES[c]}: {v}" for c, v in columns))
    return {"fiv_planes": tables.markdown(head, rows), "fiv_front": tables.front_table([r for r in records if "occluders" in r])}
