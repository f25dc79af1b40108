"""Distant light: spherical harmonics by order and window, and irradiance maps by size, over all environments at hand."""
import probes
import tables
from steps import File, Out, Point, Step

TITLE = "Distant light: SH9 and irradiance maps"
ABOUT = """E at random normals against the sum over all texels of the map (`ivory probe MAP`), whose own error bound is drawn
too; RMS over normals and colours, divided by the mean E. Time is that of reading the map and baking; the errors that both bakes measure of themselves are left out."""


def points(suite, inputs, runner):
    count = {"rough": 60, "quick": 500, "full": 2000}[suite]
    normals = File(probes.normals(inputs.path(f"normals_{count}.csv"), count))
    sizes = {"rough": (4,), "quick": (4, 16, 64), "full": (4, 8, 16, 32, 64, 128)}[suite]
    windows = {"rough": ("none", "auto"), "quick": ("none", "auto", "4"), "full": ("none", "auto", "3", "4", "6")}[suite]
    found = []
    for name, environment in inputs.environments(suite).items():
        truth = Step(("probe", environment, "--points", normals, Out("csv")))

        def add(series, label, bake, memory, truth=truth, name=name):
            probe = Step(("probe", bake, "--points", normals, Out("csv")))

            def measure(run):
                made = run.result(bake)
                exact = probes.rows(run.output(truth))
                mean_lux = sum(sum(e) for e, _ in exact) / (3 * len(exact))
                return {**probes.errors(probes.rows(run.output(probe)), exact, by_mean=True),
                        "nrmse_floor": run.result(truth)["error_bound_lux"] / mean_lux,
                        "time_s": made["read_seconds"] + made.get("projection_seconds", made.get("bake_seconds")),
                        "memory_bytes": memory, "least": made.get("least_irradiance_lux")}

            found.append(Point("sh9", name, series, label, [bake, truth, probe], measure))

        for order in (0, 1, 2):
            add("SH", f"order {order}", Step(("bake", "sh9", environment, "--order", order, Out("json")), timed=True, seconds="once"), 12 * (order + 1) ** 2)
        for window in windows[1:]:
            add("SH9, window", window, Step(("bake", "sh9", environment, "--order", 2, "--window", window, Out("json")), timed=True, seconds="once"), 108)
        for size in sizes:
            add("irradiance map", str(size), Step(("bake", "difmap", environment, "--size", size, Out("exr")), timed=True, seconds="once"),
                6 * size * size * 12)
    return found


def draw(records, figures):
    names = list(dict.fromkeys(r["panel"] for r in records))

    def lines(series, x):
        return [(name, [x(r) for r in records if r["panel"] == name and r["series"] == series],
                 [r["nrmse"] for r in records if r["panel"] == name and r["series"] == series], None) for name in names]

    floor = "largest error of the truth"

    def with_floor(series, x):
        """And the largest of the bounds, over the range of x."""
        xs = [x(r) for r in records if r["series"] == series]
        if not xs:
            return []
        return lines(series, x) + [(floor, [min(xs), max(xs)], [max(r["nrmse_floor"] for r in records)] * 2, None)]

    windows = ["none", *dict.fromkeys(r["label"] for r in records if r["series"] == "SH9, window")]
    by_window = []
    for name in names:
        here = {r["label"]: r["nrmse"] for r in records if r["panel"] == name and r["series"] == "SH9, window"}
        here["none"] = next((r["nrmse"] for r in records if r["panel"] == name and r["label"] == "order 2"), None)
        ready = [w for w in windows if here.get(w)]
        by_window.append((name, ready, [here[w] for w in ready], None))
    figures.sweep("sh9_order", "Distant light: error against memory, by environment", "", [
        ("spherical harmonics, order 0 to 2", "memory", "RMS error / mean E", True, True, with_floor("SH", lambda r: r["memory_bytes"])),
        ("irradiance maps, by texels along an edge", "memory", "RMS error / mean E", True, True,
         with_floor("irradiance map", lambda r: r["memory_bytes"])),
        ("nine coefficients, by window", "window", "RMS error / mean E", False, True, by_window)], columns=3)
    figures.sweep("sh9_time", "Distant light: error against time of the bake", "", [
        ("spherical harmonics, order 0 to 2", "time of the bake, s", "RMS error / mean E", True, True, with_floor("SH", lambda r: r["time_s"])),
        ("irradiance maps", "time of the bake, s", "RMS error / mean E", True, True, with_floor("irradiance map", lambda r: r["time_s"]))], columns=2)


def page_tables(records):
    head = ("environment", "method", "setting", "memory", "time", "RMS error / mean E", "worst / mean E", "least E, lux")
    rows = [(r["panel"], r["series"], r["label"], tables.size(r["memory_bytes"]), tables.seconds(r["time_s"]), tables.percent(r["nrmse"]),
             tables.percent(r["worst"]), "–" if r["least"] is None else tables.number(r["least"])) for r in records]
    return [("All points", head, rows, ())]


def markdown_tables(records):
    settings = [("SH", "order 0"), ("SH", "order 1"), ("SH", "order 2"), ("SH9, window", "auto"), ("irradiance map", "16"),
                ("irradiance map", "64")]
    rows = []
    for name in dict.fromkeys(r["panel"] for r in records):
        here = {(r["series"], r["label"]): r for r in records if r["panel"] == name}
        rows.append((name, *(tables.percent(here[s]["nrmse"]) if s in here else "–" for s in settings)))
    return {"sh9": tables.markdown(("environment", "order 0", "order 1", "order 2 (SH9)", "SH9, auto window", "irradiance map, 16",
                                    "irradiance map, 64"), rows)}
