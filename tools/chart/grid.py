"""Irradiance-vector grids beside path tracing and a photon map: whole pictures of indirect light."""
import math
import re

import tables
from front import slug
from steps import File, Out, Point, Step

TITLE = "Indirect light: irradiance-vector grids, path tracing, photon maps"
ABOUT = """Indirect light alone, the bake counted. Every picture is compared with two independent path-traced ones whose own noise is
left out of the error (`ivory compare A REF REF2`), so that errors below that noise, the grey line, can be told too. `16 vertices` are
those along the longest side; settings of curves are numbers of photons, samples, gather rays or
paths a light probe. Grids and photon maps are read at 16 samples a pixel, behind gather rays at
4: where curves run level in scenes of much detail, the samples of edges and highlights are the limit."""

SIZE = {"rough": "32x24", "quick": "120x90", "full": "240x180"}
# Two of so many samples a pixel; fewer where a sample takes long. Their noise is taken out of the errors.
REFERENCE_SAMPLES = {"rough": "16", "quick": "1k", "full": "2k"}
FEWER_REFERENCE_SAMPLES = {"interior": "1k", "sunlit garden": "1k"}
DIRECT_SAMPLES, GATHER_SAMPLES = 16, 4


def scenes(suite, inputs):
    """{name: (scene, options)}"""
    found = {"Cornell box": (inputs.bundled("cornell_box.gltf"), ()), "two rooms": (inputs.bundled("two_rooms.gltf"), ())}
    if suite != "full":
        return found
    bunny = inputs.bunny_room()
    if bunny:
        found["bunny's room"] = (bunny[0], ())
    interior = inputs.sample("gltf/cornellbox_stratum/cornellbox.gltf")
    if interior:
        found["interior"] = (inputs.with_camera(interior, "interior.gltf", (3.2, 1.2, 0.0), (0.2, 0.8, 0.0), 0.9), ())
    garden, sun = inputs.sample("gltf/japanese_bridge_garden.glb"), inputs.sample("env/noon_grass_1k.hdr")
    if garden and sun:
        placed = inputs.with_camera(garden, "garden.glb", (4.2, 3.6, 5.2), (0.0, 1.2, 0.3), 0.7)
        found["sunlit garden"] = (placed, ("--env", File(sun)))
    return found


def plan(suite):
    """(vertices along the long side, photons) of grids read directly."""
    if suite == "full":
        return ((8, ("125k", "500k", "2m")), (16, ("125k", "500k", "2m", "8m")), (32, ("500k", "2m", "8m", "32m")),
                (64, ("2m", "8m", "32m")))
    return ((8, ("100k", "400k")), (16, ("100k", "400k")), (32, ("400k", "1600k")))


class Scene:
    def __init__(self, name, path, options, suite, runner):
        self.name, self.file, self.options, self.size = name, File(path), options, SIZE[suite]
        info = runner.result(Step(("info", self.file)))["result"]
        self.extent = max(b - a for a, b in zip(info["bounds_min_m"], info["bounds_max_m"]))
        samples = FEWER_REFERENCE_SAMPLES.get(name, REFERENCE_SAMPLES[suite])
        self.references = [Step(("render", self.file, *options, "--method", "path", "--samples", samples,
                                 "--size", self.size, "--seed", seed, "--indirect-only", Out("exr"))) for seed in (101, 102)]

    def bake(self, vertices, photons, *options):
        voxel = f"{1.00001 * self.extent / vertices:.7g}"
        return Step(("bake", "grid", self.file, *self.options, "--voxel-size", voxel, "--photons", photons, *options, Out("vdb")),
                    timed=True)

    def probes(self, vertices, rays):
        """The same vertices as light probes, path-traced one by one."""
        voxel = f"{1.00001 * self.extent / vertices:.7g}"
        return Step(("bake", "grid", self.file, *self.options, "--voxel-size", voxel, "--by", "probes", "--probe-rays", rays, Out("vdb")),
                    timed=True)

    def render(self, method, samples, *options):
        return Step(("render", self.file, *self.options, "--method", method, "--samples", samples, "--size", self.size,
                     "--indirect-only", *options, Out("exr")), timed=True)

    def point(self, series, label, picture, bake=None, join=True, method=""):
        compare = Step(("compare", picture, *self.references))
        steps = [s for s in (bake, picture, compare) if s]

        def measure(run):
            return {**errors(run.result(compare)), "method": method or series,
                    "memory_bytes": run.result(bake)["memory_bytes"] if bake else run.result(picture).get("map_bytes", 0)}

        return Point("grid", self.name, series, label, steps, measure, join)


def errors(result):
    return {"nrmse": result["nrmse"], "nrmse_se": result["nrmse_standard_error"], "nrmse_floor": result["reference_nrmse"],
            "relative_rmse": result["relative_rmse"], "relative_rmse_se": result["relative_rmse_standard_error"],
            "relative_rmse_floor": result["reference_relative_rmse"]}


def scene_points(scene, suite):
    full = suite == "full"
    for samples in (1, 4, 16, 64, 256) if full else (1, 4, 16, 64):
        yield scene.point("path tracing", str(samples), scene.render("path", samples))
    for neighbours, photons in ((50, ("30k", "100k", "300k", "1m", "3m", "10m")), (200, ("300k", "3m"))) if full else ((50, ("30k", "100k", "300k")),):
        for n in photons:
            yield scene.point(f"photon map, {neighbours} neighbours", n,
                              scene.render("photonmap", DIRECT_SAMPLES, "--photons", n, "--neighbours", neighbours))
    for n in ("100k", "3m") if full else ("100k",):
        yield scene.point("photon map behind 16 gather rays", n,
                          scene.render("photonmap", GATHER_SAMPLES, "--photons", n, "--gather", 16))

    def direct(series, label, bake, *options, join=False, method=""):
        return scene.point(series, label, scene.render("direct", DIRECT_SAMPLES, "--grid", bake, *options), bake, join, method)

    for vertices, photons in plan(suite):
        for n in photons:
            yield direct(f"grid, {vertices} vertices", n, scene.bake(vertices, n), join=True, method="grid as it comes")
    for vertices, counts in ((16, (16, 64, 256, 1024)), (32, (16, 64, 256))) if full else ((16, (16, 64)),):
        for rays in counts:
            yield direct(f"light probes, {vertices} vertices", str(rays), scene.probes(vertices, rays), join=True, method="light probes")
    for vertices, photons in ((16, "500k"), (32, "2m")) if full else ((16, "400k"),):
        bake = scene.bake(vertices, photons)
        for rays in (4, 16, 64) if full else (4, 16):
            yield scene.point(f"grid, {vertices} vertices, behind gather rays", str(rays),
                              scene.render("gather", GATHER_SAMPLES, "--gather", rays, "--cache", "off", "--grid", bake),
                              bake)

    # Where the photons' noise is the larger part of the error, and where the grid's own is.
    for vertices, photons in ((32, "2m"), (16, "8m")) if full else ((16, "400k"),):
        def changed(what, bake_options=(), read_options=(), vertices=vertices, photons=photons):
            return direct(f"{vertices} vertices, {photons}, but", what, scene.bake(vertices, photons, *bake_options), *read_options,
                          method=f"grid, {what}")

        for estimator in ("face", "face_paper"):
            yield changed(f"estimator {estimator}", ("--estimator", estimator))
        for basis in ("vectors9", "sh9", "ambient_cube", "sh4"):
            yield changed(f"basis {basis}", ("--basis", basis))
        yield changed("paper's remap", (), ("--reconstruction", "paper"))
        yield changed("tricubic", (), ("--interpolation", "tricubic"))
        yield changed("guard by planes", (), ("--guard", "planes"))
        yield changed("no guard", ("--guard", "off"), ("--guard", "off"))


def points(suite, inputs, runner):
    return [point for name, (path, options) in scenes(suite, inputs).items()
            for point in scene_points(Scene(name, path, options, suite, runner), suite)]


def draw(records, figures):
    for name in dict.fromkeys(r["panel"] for r in records):
        here = [r for r in records if r["panel"] == name]
        figures.costs(here, slug("grid", name), f"Indirect light: {name}", "")


def page_tables(records):
    return [(f"All points: {name}", *tables.points_table([r for r in records if r["panel"] == name]))
            for name in dict.fromkeys(r["panel"] for r in records)]


def markdown_tables(records):
    return {"grid_front": tables.front_table(records), "grid_on_front": tables.on_front(records),
            "grid_time": time_table(records), "grid_changes": changes_table(records), "grid_probes": probes_table(records)}


def seconds_to(curve, nrmse):
    """Time at which a series of (time, error), its noise falling, comes to that error: between its points by their logarithms; None
    where it never does."""
    points = sorted(curve)
    if points and points[0][1] <= nrmse:
        return points[0][0]
    for (t0, e0), (t1, e1) in zip(points, points[1:]):
        if e0 > nrmse >= e1 > 0:
            return math.exp(math.log(t0) + math.log(t1 / t0) * math.log(nrmse / e0) / math.log(e1 / e0))
    return None


def probes_table(records):
    """Time of photons to the error of light probes at the same vertices."""
    rows = []
    for r in records:
        found = re.fullmatch("light probes, ([0-9]+) vertices", r["series"])
        if not found or not r["nrmse"] > 0:
            continue
        photons = [(p["time_s"], p["nrmse"]) for p in records
                   if p["panel"] == r["panel"] and p["series"] == f"grid, {found.group(1)} vertices"]
        same = seconds_to(photons, r["nrmse"])
        rows.append((r["panel"], f"{found.group(1)} vertices, {r['label']} paths each", tables.seconds(r["time_s"]),
                     tables.percent(r["nrmse"]), tables.seconds(same) if same else "not reached",
                     tables.number(r["time_s"] / same, 2) if same else "–"))
    return tables.markdown(("scene", "light probes", "bake + picture", "NRMSE", "photons to the same", "ratio"), rows)


def changes_table(records):
    """What one thing changed does to error, time and memory, over what the defaults give: geometric mean, least and most over scenes."""
    def ratios(change, base, figure):
        logs = [math.log(r[figure] / b[figure]) for r, b in zip(change, base) if r[figure] > 0 and b[figure] > 0]
        if not logs:
            return "–"
        mean, *ends = (tables.number(math.exp(x), 2) for x in (sum(logs) / len(logs), min(logs), max(logs)))
        return f"{mean} ({ends[0]} to {ends[1]})" if ends[0] != ends[1] else mean

    rows = []
    for series, label in dict.fromkeys((r["series"], r["label"]) for r in records if r["series"].endswith(", but")):
        vertices, photons = re.match("([0-9]+) vertices, ([0-9]+[km]?), but", series).groups()
        change = [r for r in records if (r["series"], r["label"]) == (series, label)]
        base = [next((b for b in records if b["panel"] == r["panel"] and b["series"] == f"grid, {vertices} vertices" and
                      b["label"] == photons), r) for r in change]
        rows.append((label, f"{vertices} vertices, {photons} photons",
                     *(ratios(change, base, figure) for figure in ("nrmse", "relative_rmse", "time_s", "memory_bytes"))))
    return tables.markdown(("changed to", "at", "NRMSE ÷", "relative RMSE ÷", "time ÷", "memory ÷"), rows)


def path_tracing_seconds(records, nrmse):
    """Time of path tracing to that error, from its two longest runs among a scene's records: its error falls with the root of its
    samples, and its time is loading, which both share, and so much a sample."""
    short, long = sorted((r for r in records if r["series"] == "path tracing"), key=lambda r: r["time_s"])[-2:]
    n_short, n_long = int(short["label"]), int(long["label"])
    a_sample = (long["time_s"] - short["time_s"]) / (n_long - n_short)
    return max(0.0, long["time_s"] - a_sample * n_long) + a_sample * n_long * (long["nrmse"] / nrmse) ** 2


def time_table(records):
    """Time of path tracing to the error of each grid read directly."""
    rows = []
    for panel in dict.fromkeys(r["panel"] for r in records):
        here = [r for r in records if r["panel"] == panel]
        if not any(r["series"] == "path tracing" for r in here):
            continue
        for r in here:
            if re.fullmatch("grid, [0-9]+ vertices", r["series"]) and r["nrmse"] > 0:
                same = path_tracing_seconds(here, r["nrmse"])
                rows.append((panel, f"{r['series'][6:]}, {r['label']} photons", tables.seconds(r["time_s"]), tables.percent(r["nrmse"]),
                             tables.seconds(same), tables.number(same / r["time_s"], 2)))
    return tables.markdown(("scene", "grid", "bake + picture", "NRMSE", "path tracing to the same", "ratio"), rows)
