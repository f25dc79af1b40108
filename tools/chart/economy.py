"""An error asked for, beside an exhaustive sweep over spacing, photons and basis: what the contract chose, and what it cost."""
import math

import probes
import tables
from front import error_of, pareto, slug
from steps import File, Out, Point, Step

TITLE = "An error asked for, and the grid that came"
ABOUT = """`ivory bake grid --target-error` chooses spacing, photons, basis and where to refine, measures what came out and says so. The error is
the RMS of indirect E over points of surfaces and free space, divided by the mean of E there; here it is measured against path-traced
truth of other seeds than the certificate's, whose noise is taken off. Beside it stand grids of one spacing, for all of which the choice
was made by hand. Times are those of whole commands, the certificate included."""

TARGETS = {"quick": ("5%", "2%"), "full": ("5%", "2%", "1%")}
VERTICES = {"quick": (8, 16, 32), "full": (8, 16, 32, 64, 96)}
PHOTONS = {"quick": ("125k", "500k", "2m"), "full": ("125k", "500k", "2m", "8m", "32m")}
BASES = {"quick": (), "full": ("sh9",)}
# How many photons a vertex are still worth a try, and how many points and paths judge: of 2,000 points in the Cornell
# box one, beside the lamp, held half of the squared error, so many points and few paths tell more than the reverse.
PHOTONS_A_VERTEX = (3, 3000)
POINTS, SAMPLES = {"quick": 3000, "full": 20000}, {"quick": "400", "full": "800"}


def scenes(suite, inputs):
    """{name: (scene, options)}: inside and outside, sun, sky, lamps, emissive surfaces."""
    found = {"two rooms": (inputs.bundled("two_rooms.gltf"), ()), "Cornell box": (inputs.bundled("cornell_box.gltf"), ())}
    if suite != "full":
        return found
    found["furnished room"] = (inputs.bundled("room_boxes_rotated.gltf"), ())
    found["rooms with thin walls"] = (inputs.bundled("leak_rotated.gltf"), ())
    found["plaza, sky"] = (inputs.bundled("plaza.gltf"), ("--env", File(inputs.bundled("sky.hdr"))))
    bunny = inputs.bunny_room()
    if bunny:
        found["bunny's room"] = (bunny[0], ())
    interior = inputs.sample("gltf/cornellbox_stratum/cornellbox.gltf")
    if interior:
        found["interior"] = (interior, ())
    garden, sun = inputs.sample("gltf/japanese_bridge_garden.glb"), inputs.sample("env/noon_grass_1k.hdr")
    if garden and sun:
        found["sunlit garden"] = (garden, ("--env", File(sun)))
    return found


def count(text):
    return int(text[:-1]) * {"k": 1_000, "m": 1_000_000}[text[-1]]


def scene_points(name, path, options, suite, runner):
    scene = File(path)
    info = runner.result(Step(("info", scene)))["result"]
    extent_m = [b - a for a, b in zip(info["bounds_min_m"], info["bounds_max_m"])]
    places = Step(("points", scene, "--count", POINTS[suite], "--seed", 77, Out("csv")))
    truth = Step(("probe", scene, *options, "--points", places, "--indirect-only", "--samples", SAMPLES[suite], "--seed", 78, Out("csv")))

    def point(series, label, bake, join):
        probe = Step(("probe", bake, "--scene", scene, "--points", places, Out("csv")))

        def measure(run):
            read, exact = probes.rows(run.output(probe)), probes.rows(run.output(truth))
            lit = [(r, t) for r, t in zip(read, exact) if max(t[0]) > 0]
            result = run.result(bake)
            certificate = result.get("certificate", {})
            return {**probes.errors([r for r, _ in lit], [t for _, t in lit], by_mean=True), "memory_bytes": result["memory_bytes"],
                    "bake_bytes": result.get("bake_bytes", 0), **{k: certificate[k] for k in ("target", "error", "low", "high") if k in certificate},
                    **({"predicted": result["plan"]["error"]} if "plan" in result else {})}

        return Point("economy", name, series, label, [bake, places, truth, probe], measure, join)

    for target in TARGETS[suite]:
        bake = Step(("bake", "grid", scene, *options, "--target-error", target, Out("vdb")), timed=True)
        yield point(CONTRACT, target, bake, True)
    for vertices in VERTICES[suite]:
        voxel_m = max(extent_m) / vertices * 1.00001
        grid = math.prod(max(2, math.ceil(e / voxel_m - 1e-3)) for e in extent_m)
        for basis in ("vectors", *BASES[suite]):
            for photons in PHOTONS[suite]:
                if PHOTONS_A_VERTEX[0] <= count(photons) / grid <= PHOTONS_A_VERTEX[1]:
                    bake = Step(("bake", "grid", scene, *options, "--voxel-size", f"{voxel_m:.7g}", "--photons", photons, "--basis", basis, Out("vdb")),
                                timed=True)
                    yield point(f"{vertices} vertices" + (f", {basis}" if basis != "vectors" else ""), photons, bake, True)


CONTRACT = "asked for"


def points(suite, inputs, runner):
    return [point for name, (path, options) in scenes(suite, inputs).items() for point in scene_points(name, path, options, suite, runner)]


def cost_of_error(sweep, x, error):
    """Least cost at which the sweep reaches that error, between points of its front by power laws; None where it does not."""
    front = pareto(sweep, x, "nrmse")
    reached = next((i for i, r in enumerate(front) if error_of(r, "nrmse") <= error), None)
    if reached is None:
        return None
    if reached == 0:
        return front[0][x]
    (x0, e0), (x1, e1) = ((r[x], error_of(r, "nrmse")) for r in front[reached - 1:reached + 1])
    return math.exp(math.log(x0) + (math.log(e0) - math.log(error)) / (math.log(e0) - math.log(e1)) * (math.log(x1) - math.log(x0)))


def ratio(record, sweep, x):
    best = cost_of_error(sweep, x, error_of(record, "nrmse"))
    return record[x] / best if best else None


def draw(records, figures):
    for name in dict.fromkeys(r["panel"] for r in records):
        figures.costs([r for r in records if r["panel"] == name], slug("economy", name), f"An error asked for, beside a sweep: {name}", "",
                      axes=(("time_s", "nrmse"), ("memory_bytes", "nrmse")), names={"time_s": "time of the bake, s", "nrmse": "RMS error / mean E"})


def rows(records):
    for name in dict.fromkeys(r["panel"] for r in records):
        here = [r for r in records if r["panel"] == name]
        sweep = [r for r in here if r["series"] != CONTRACT]
        for r in here:
            if r["series"] == CONTRACT and r["nrmse"] > 0:
                ratios = [ratio(r, sweep, x) for x in ("time_s", "memory_bytes")]
                yield (name, r["label"], f"{tables.percent(r['error'])} ({tables.percent(r['low'])} to {tables.percent(r['high'])})",
                       f"{tables.percent(r['nrmse'])} ± {tables.number(100 * r['nrmse_se'], 2)}", tables.number(r["error"] / r["nrmse"], 3),
                       tables.number(r["predicted"] / r["nrmse"], 3) if "predicted" in r else "–", tables.seconds(r["time_s"]),
                       *("the sweep never reaches it" if x is None else tables.number(x, 2) for x in ratios))


HEAD = ("scene", "asked", "certified (95 %)", "true", "certified ÷ true", "predicted ÷ true", "time", "time ÷ best of the sweep", "memory ÷ best")


def page_tables(records):
    return [("What was asked for and what came", HEAD, list(rows(records)), ()),
            *((f"All points: {name}", *tables.points_table([r for r in records if r["panel"] == name]))
              for name in dict.fromkeys(r["panel"] for r in records))]


def markdown_tables(records):
    return {"economy": tables.markdown(HEAD, list(rows(records)))}
