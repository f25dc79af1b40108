"""The places where methods fail, each swept through the failure by `ivory bench stability`."""
import subprocess

import tables
from process import Failure
from steps import Point, Step

TITLE = "Where methods fail"
ABOUT = """One plot and one sentence a place: errors against closed forms or slow twins as a parameter is swept through the failure.
Dashes are the bounds that the tests hold; lines without dashes only show what fails. `ivory bench stability` prints the points."""


def points(suite, inputs, runner):
    listed = subprocess.run([runner.ivory, "bench", "stability", "--list"], capture_output=True, text=True)
    if listed.returncode != 0:
        raise Failure(listed.stderr.strip())
    found = []
    for line in listed.stdout.splitlines():
        name = line.split()[0]
        step = Step(("bench", "stability", name, *(["--quick"] if suite == "quick" else [])), timed=True, seconds="once")

        def measure(run, step=step):
            lines = run.result(step)["points"]
            within = all(p["bound"] is None or (p["error"] is not None and p["error"] <= p["bound"]) for p in lines)
            return {"points": lines, "within_bounds": within}

        found.append(Point("stability", name, "sweep", "all", [step], measure, name=f"stability/{name}"))
    return found


def draw(records, figures):
    for r in records:
        rows = r["points"]
        first = rows[0]
        lines, bounds = [], []
        for series in dict.fromkeys(p["series"] for p in rows):
            here = sorted((p["x"], p["error"], p["bound"]) for p in rows if p["series"] == series)
            lines.append((series, [x for x, _, _ in here], [e for _, e, _ in here], None))
            bounds.append([(x, b) for x, _, b in here if b is not None])
        figures.sweep(f"stability_{r['panel']}", first["title"], first["sentence"],
                      [("", first["x_label"], first["y_label"], first["log_x"], first["log_y"], lines)], bounds=bounds)


def page_tables(records):
    rows = []
    for r in records:
        held = [p for p in r["points"] if p["bound"] is not None]
        worst = max(held, key=lambda p: p["error"] / p["bound"] if p["bound"] > 0 else p["error"], default=None)
        rows.append((r["panel"], r["points"][0]["title"], len(r["points"]), "yes" if r["within_bounds"] else "NO",
                     f"{worst['series']} at {tables.number(worst['x'])}: {tables.number(worst['error'])} of {tables.number(worst['bound'])}"
                     if worst else "–", tables.seconds(r["time_s"])))
    return [("All sweeps", ("case", "what", "points", "within bounds", "nearest to its bound", "time"), rows, ())]


def markdown_tables(records):
    rows = []
    for r in records:
        shown = [p for p in r["points"] if p["bound"] is None] or r["points"]
        held = [p for p in r["points"] if p["bound"] is not None]
        worst, best = max(shown, key=lambda p: p["error"]), max(held, key=lambda p: p["error"], default=None)
        rows.append((r["points"][0]["title"], r["points"][0]["sentence"],
                     f"{tables.number(worst['error'], 2)} ({worst['series']}, {r['points'][0]['x_label']} {tables.number(worst['x'], 2)})",
                     f"{tables.number(best['error'], 2)} ({best['series']})" if best else "–"))
    return {"stability": tables.markdown(("place", "what happens", "worst shown", "worst of what is held to a bound"), rows)}
