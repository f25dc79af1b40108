"""Cosine lobes: soft shadows by depth of the mask, threshold and exponent, beside shadow rays and spherical Gaussians."""
import pathlib

import make_bunny_room
import make_lobes_scenes
import tables
from steps import File, Out, Point, Step

TITLE = "Spherical lights: cosine lobes"
ABOUT = """The plane under the Stanford bunny and a spherical light, 320×240 pixels, one sample a pixel at the same places, one thread. Truth
is Monte Carlo with many rays on the same spheres (the lobes' own error) or on the mesh (the sphere set's too); a quarter as many rays
tell how far the truth itself may be off. Times are of rays and shading alone, tables and spheres read before, the least of three."""

# glTF roughness r: alpha = r^2, exponent (1/alpha^2 - 1)/2.
ROUGHNESS = (0.12, 0.18, 0.25, 0.35, 0.5, 0.7, 0.9)


def render(scene, *options, timed=True):
    return Step(("render", scene, "--method", "lobes", "--samples", 1, "--size", "320x240", *options, Out("exr")), timed=timed,
                seconds="render_seconds", threads=1)


def rough_scenes(inputs):
    """{roughness: scene} of the plane, metal."""
    animal, found = make_bunny_room.bunny(pathlib.Path("/usr/share/glmark2/models/bunny.obj")), {}
    for r in ROUGHNESS:
        found[r] = inputs.path(f"bunny_rough_{r}.glb")
        make_lobes_scenes.scene(pathlib.Path(found[r]), animal, {
            "pbrMetallicRoughness": {"baseColorFactor": [0.7, 0.7, 0.7, 1.0], "metallicFactor": 1.0, "roughnessFactor": r},
            "extensions": {}})
    return found


def points(suite, inputs, runner):
    full = suite == "full"
    if not inputs.bunny("bunny.glb") or not inputs.bunny("bunny_plane.glb") or not inputs.bunny("bunny_gloss.glb"):
        return []
    table = ("--lobes", Step(("bake", "lobes", Out("exr"))))
    truth_rays = 4096 if full else 1024

    def spheres(count):
        return ("--spheres", Step(("bake", "spheres", File(inputs.bunny("bunny.glb")), "--count", count, Out("json"))))

    found = []

    def add(panel, series, label, image, reference, rough, join=True, **more):
        compare, own = Step(("compare", image, reference)), Step(("compare", rough, reference))

        def measure(run):
            result = run.result(compare)
            return {"nrmse": result["nrmse"], "nrmse_se": result["nrmse_standard_error"], "relative_rmse": result["relative_rmse"],
                    "relative_rmse_se": result["relative_rmse_standard_error"],
                    # Errors of rays fall with at least the root of their number.
                    "nrmse_floor": run.result(own)["nrmse"] / 2, "relative_rmse_floor": run.result(own)["relative_rmse"] / 2, **more}

        found.append(Point("lobes", panel, series, label, [image, reference, rough, compare, own], measure, join))

    def references(scene, *options):
        return [render(scene, *table, *options, "--shadow-rays", n, timed=False) for n in (truth_rays, truth_rays // 4)]

    depths = (1, 2, 3, 4, 5) if full else (2, 3, 4, 5)
    rays = [n for n in (1, 4, 16, 64, 256) if n <= truth_rays // 8]
    set64 = spheres(64)
    for panel, name in (("matt plane, truth: the same 64 spheres", "bunny_plane.glb"),
                        ("glossy plane, truth: the same 64 spheres", "bunny_gloss.glb")):
        scene = File(inputs.bunny(name))
        refs = references(scene, *set64, "--shadows", "spheres")
        for d in depths:
            add(panel, "lobes, 64 spheres, by mask depth", str(d), render(scene, *table, *set64, "--mask-depth", d), *refs)
        for n in rays:
            add(panel, "shadow rays on the spheres", str(n),
                render(scene, *table, *set64, "--shadows", "spheres", "--shadow-rays", n), *refs)
        if name == "bunny_gloss.glb":
            for t in ("0", "0.0001", "0.001", "0.01", "0.1"):
                add(panel, "lobes, depth 5, by threshold", t, render(scene, *table, *set64, "--mask-depth", 5, "--threshold", t), *refs)
            for s in (0, 1, 2, 3, 4):
                add(panel, "lobes, depth 5, by split", str(s), render(scene, *table, *set64, "--mask-depth", 5, "--split", s), *refs)
        else:
            for m in ("center", "inside", "touched"):
                add(panel, "lobes, depth 5, by mask rule", m, render(scene, *table, *set64, "--mask-depth", 5, "--mask", m), *refs,
                    join=False)

    scene = File(inputs.bunny("bunny_plane.glb"))
    refs = references(scene, "--shadows", "mesh")
    panel = "matt plane, truth: the mesh"
    for c in (16, 64, 256):
        for d in depths:
            add(panel, f"lobes, {c} spheres, by mask depth", str(d), render(scene, *table, *spheres(c), "--mask-depth", d), *refs)
    for n in rays:
        add(panel, "shadow rays on the mesh", str(n), render(scene, *table, "--shadows", "mesh", "--shadow-rays", n), *refs)

    if full:
        for r, path in rough_scenes(inputs).items():
            scene = File(path)
            refs = references(scene, *set64, "--shadows", "spheres")
            alpha = r * r
            for d in (3, 5):
                add("exponents, truth: the same 64 spheres", f"lobes, depth {d}", f"roughness {r}",
                    render(scene, *table, *set64, "--mask-depth", d), *refs, exponent=(1 / alpha ** 2 - 1) / 2)

    bench = Step(("bench", "gaussians"))

    for c in (16, 64, 256):
        fit = Step(spheres(c)[1].arguments, timed=True)
        found.append(Point("lobes", "sphere sets of the bunny", "spheres", str(c), [fit], lambda run, fit=fit: {"fit": run.result(fit)}))
    found.append(Point("lobes", "one ball of light", "lobes and Gaussians", "all", [bench],
                       lambda run: {"rows": run.result(bench)["rows"], "gaussians": True}))
    return found


def is_picture(record):
    return "gaussians" not in record and "fit" not in record


def draw(records, figures):
    pictures = [r for r in records if is_picture(r) and "exponent" not in r]
    for panel in dict.fromkeys(r["panel"] for r in pictures):
        figures.costs([r for r in pictures if r["panel"] == panel],
                      "lobes_" + {"matt plane, truth: the mesh": "mesh", "matt plane, truth: the same 64 spheres": "matt",
                                  "glossy plane, truth: the same 64 spheres": "gloss"}[panel], f"Cosine lobes: {panel}", "",
                      axes=(("time_s", "nrmse"), ("time_s", "relative_rmse")), names={"time_s": "time of the picture, s"})
    exponents = [r for r in records if "exponent" in r]
    if exponents:
        figures.sweep("lobes_exponents", "Cosine lobes: glossy shadows by exponent", "", [
            ("", "exponent of the highlight", "NRMSE", True, True,
             [(s, [r["exponent"] for r in exponents if r["series"] == s], [r["nrmse"] for r in exponents if r["series"] == s], None)
              for s in dict.fromkeys(r["series"] for r in exponents)])])
    for r in [r for r in records if "gaussians" in r][:1]:
        panels = []
        for half in dict.fromkeys(row["half_angle_deg"] for row in r["rows"]):
            rows = [row for row in r["rows"] if row["half_angle_deg"] == half and row["exact"] > 0]
            facing = rows[0]["exact"]
            panels.append((f"light of half angle {half}°", "angle from the normal, degrees", "error, % of E facing the light", False, False, [
                (label, [row["angle_deg"] for row in rows], [100 * (row[key] - row["exact"]) / facing for row in rows], None)
                for label, key in (("cosine lobes", "lobes"), ("spherical Gaussians, cosine as one", "gaussians"),
                                   ("spherical Gaussians, fitted irradiance", "gaussians_fitted"))]))
        figures.sweep("lobes_gaussians", "One unshadowed spherical light on a matt surface: cosine lobes and spherical Gaussians",
                      "Gaussians: the light as the Gaussian of equal flux and width; its irradiance by the cosine as the widely used single Gaussian, and by Hill's fit.", panels, columns=2)


def page_tables(records):
    pictures = [r for r in records if is_picture(r)]
    return [(f"All points: {panel}", *tables.points_table([r for r in pictures if r["panel"] == panel]))
            for panel in dict.fromkeys(r["panel"] for r in pictures)]


def markdown_tables(records):
    found = {"lobes_front": tables.front_table([{**r, "memory_bytes": 0} for r in records if is_picture(r) and "exponent" not in r])}
    fits = [r for r in records if "fit" in r]
    if fits:
        found["spheres"] = tables.markdown(
            ("spheres", "volume outside the mesh", "volume uncovered", "mean distance of the surfaces ÷ bounding radius", "time"),
            [(r["label"], tables.percent(r["fit"]["volume_outside"]), tables.percent(r["fit"]["volume_uncovered"]),
              tables.percent(r["fit"]["surface_mean"]), tables.seconds(r["time_s"])) for r in fits])
    return found
