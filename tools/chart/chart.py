#!/usr/bin/env python3
"""Measures ivory's methods against each other and draws what came out; called by `ivory chart`."""
import argparse
import contextlib
import dataclasses
import fnmatch
import importlib
import json
import os
import signal
import sys
import tempfile

# The scenes' writers; installed or not, they lie beside the tools.
sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "scenes"))

import page  # noqa: E402
import summary  # noqa: E402
import tables  # noqa: E402
from inputs import Inputs  # noqa: E402
from kept import Kept  # noqa: E402
from process import Failure, Stop  # noqa: E402
from runner import Runner  # noqa: E402

CURVES = ("grid", "economy", "bases", "sh9", "fiv", "cubemap", "lobes", "rates", "stability")
WHOLE = ("quick", "full")
APART = ("economy",)  # curves that no suite has: their sweeps take hours
ROUGH = ("grid", "sh9")  # curves that know the size rough


class Parser(argparse.ArgumentParser):
    def error(self, message):
        print(f"ivory: {message}", file=sys.stderr)
        sys.exit(2)


def parse(arguments):
    parser = Parser(prog="ivory chart", description=__doc__)
    parser.add_argument("suite", metavar="SUITE", choices=(*WHOLE, *CURVES),
                        help="quick (minutes), full (under two hours on two cores), or a curve: " + ", ".join(CURVES) +
                             "; neither suite has " + ", ".join(APART))
    parser.add_argument("-o", "--output", metavar="FOLDER", required=True,
                        help="results.jsonl, charts (.svg, .png) and index.html (SUITE.html of one curve) go there")
    parser.add_argument("--list", action="store_true", help="print the points instead of measuring them")
    parser.add_argument("--only", metavar="PATTERN", action="append", default=[],
                        help="only points whose name CURVE/SCENE/SERIES/SETTING matches; * and ? are wild; may be repeated")
    parser.add_argument("--draw", action="store_true", help="measure nothing, draw what results.jsonl has")
    parser.add_argument("--any-build", action="store_true", help="keep results of other builds of ivory of this version")
    parser.add_argument("--fill", metavar="FILE.md", action="append", default=[],
                        help="rewrite the tables between <!-- chart: NAME --> and <!-- /chart --> of this file, and copy its charts/NAME.png")
    parser.add_argument("--size", choices=("rough", *WHOLE), help="of a single curve [quick]; rough, of grid and sh9, is a try")
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    parser.add_argument("--quiet", action="store_true")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--ivory", required=True, help=argparse.SUPPRESS)
    parser.add_argument("--source", required=True, help=argparse.SUPPRESS)
    options = parser.parse_args(arguments)
    if options.suite in WHOLE and options.size:
        parser.error(f"--size is of a single curve; the suite {options.suite} has its own")
    if options.size == "rough" and options.suite not in ROUGH:
        parser.error(f"--size rough is of {' and '.join(ROUGH)}; {options.suite} has quick and full")
    options.size = options.suite if options.suite in WHOLE else options.size or "quick"
    options.output = os.path.abspath(options.output)
    return options


def check(options):
    """What would only be found after hours."""
    if os.path.exists(options.output) and not os.path.isdir(options.output):
        raise Failure(f"{options.output}: is no folder; choose another")
    for path in options.fill:
        if not os.path.isfile(path):
            raise Failure(f"{path}: no such file; --fill rewrites a document that is there")
        if not os.access(path, os.W_OK) or not os.access(os.path.dirname(os.path.abspath(path)), os.W_OK):
            raise Failure(f"{path}: cannot be written; --fill rewrites it")


@dataclasses.dataclass
class Curve:
    name: str
    module: object
    points: list  # those asked for
    left_out: list  # names of those that --only left out
    records: list = dataclasses.field(default_factory=list)
    charts: list = dataclasses.field(default_factory=list)  # (name, title)
    tables: list = dataclasses.field(default_factory=list)  # of the page
    markdown: dict = dataclasses.field(default_factory=dict)

    def missing(self):
        """Names of points of the whole curve that there is no record of."""
        had = {r["name"] for r in self.records}
        return self.left_out + [p.name for p in self.points if p.name not in had]


def plan(name, options, runner, inputs):
    """The curve, or None where even its points cannot be told."""
    try:
        module = importlib.import_module(name)
        points = list(module.points(options.size, inputs, runner))
    except Stop:
        raise
    except Exception as error:
        runner.fail(name, error)
        return None
    if len({p.name for p in points}) != len(points):
        raise Failure(f"{name}: two points have one name")
    chosen = [p for p in points if not options.only or any(fnmatch.fnmatch(p.name, o) for o in options.only)]
    return Curve(name, module, chosen, [p.name for p in points if p not in chosen])


def list_points(options, runner, inputs):
    found = []
    for name in options.curves:
        curve = plan(name, options, runner, inputs)
        found += [{"name": p.name, "done": runner.is_done(p)} for p in curve.points] if curve else []
    if options.json:
        print(json.dumps({"points": found, "failed": len(runner.failed)}))
    else:
        print("".join(("done  " if p["done"] else "      ") + p["name"] + "\n" for p in found), end="")
    return 1 if runner.failed else 0


def draw(curve, figures, runner):
    before = len(figures.made)
    try:
        curve.module.draw(curve.records, figures)
        curve.tables = curve.module.page_tables(curve.records)
        curve.markdown = curve.module.markdown_tables(curve.records)
    except Exception as error:  # a part of a curve may lack what its charts stand on
        runner.fail(f"charts of {curve.name}", error)
    curve.charts = figures.made[before:]


def fill(options, curves, figures, failed_plans):
    """Documents get tables of whole curves only; what is kept of earlier runs serves for curves that this one leaves out."""
    kept = Kept(options.output, options.size)
    kept.drawn({name for name, _ in figures.made})
    partial = {name: "its points cannot be told" for name in failed_plans}
    for curve in curves:
        missing = curve.missing()
        if missing:
            partial[curve.name] = (f"{len(missing)} of {len(curve.points) + len(curve.left_out)} points are missing, "
                                   f"the first {missing[0]}")
        elif curve.markdown:
            kept.put(curve.name, curve.markdown, [name for name, _ in curve.charts])
    if options.suite in WHOLE:
        if partial:
            partial["summary"] = f"{', '.join(partial)} is not whole"
        else:
            kept.put("summary", {"summary": summary.table([r for c in curves for r in c.records])}, [])
    kept.save()
    found, charts = kept.of(left_out=partial)
    for path in options.fill:
        for name, why in partial.items():
            print(f"ivory: {path}: tables and charts of {name} left as they were: {why}", file=sys.stderr)
        missing = tables.rewrite(path, found, options.output, charts)
        if missing:
            print(f"ivory: {path}: these results have no {', '.join(missing)}; left as it was", file=sys.stderr)


def report(options, curves, figures, runner, written):
    """What is to be said at the end, and the exit code."""
    records = [r for c in curves for r in c.records]
    if runner.failed:
        print(f"ivory: {len(runner.failed)} points failed, the first: {runner.failed[0][0]}: {runner.failed[0][1]}", file=sys.stderr)
    sweeps = [r for r in records if "within_bounds" in r]
    broken = [r["name"] for r in sweeps if not r["within_bounds"]]
    if broken:
        print(f"ivory: {len(broken)} of {len(sweeps)} sweeps break their bounds: {', '.join(broken)}", file=sys.stderr)
    if options.json:
        print(json.dumps({"page": written, "points": len(records), "charts": len(figures.made), "failed": len(runner.failed)}))
    elif not options.quiet:
        print(f"{written}: {len(records)} points, {len(figures.made)} charts")
    return 1 if runner.failed or broken else 0


def measure(options, runner, inputs):
    from plot import Figures  # loads matplotlib, which lists and refusals do without
    figures, curves, failed_plans = Figures(runner.folder), [], []
    for name in options.curves:
        curve = plan(name, options, runner, inputs)
        if curve is None:
            failed_plans.append(name)
            continue
        curve.records = runner.points(curve.points)
        curves.append(curve)
        if curve.records:
            draw(curve, figures, runner)
    records = [r for c in curves for r in c.records]
    if not records:
        raise Failure("nothing was measured; see --list and --only" +
                      ("; --any-build takes what another build of ivory measured" if options.draw else ""))
    if not options.quiet:
        for what, why in inputs.skipped:
            print(f"skipped: {what}: {why}", file=sys.stderr)
    sections = [{"id": c.name, "title": c.module.TITLE, "about": c.module.ABOUT, "figures": c.charts, "tables": c.tables}
                for c in curves if c.records]
    written = page.write(runner.folder, options.suite, options.suite in WHOLE, sections, inputs.skipped + runner.failed, records, runner)
    fill(options, curves, figures, failed_plans)
    return report(options, curves, figures, runner, written)


def main(arguments):
    options = parse(arguments)
    options.curves = tuple(c for c in CURVES if c not in APART) if options.suite in WHOLE else (options.suite,)
    check(options)
    reading = options.list or options.draw
    with contextlib.ExitStack() as stack:
        runner = Runner(options.ivory, options.output, options.threads, options.any_build, options.quiet, reading)
        ready = os.path.join(runner.folder, "scenes")
        made = stack.enter_context(tempfile.TemporaryDirectory(prefix="ivory_chart_")) if reading else ready
        inputs = Inputs(options.source, made, ready if reading else None)
        return (list_points if options.list else measure)(options, runner, inputs)


def end(*_):
    raise KeyboardInterrupt


if __name__ == "__main__":
    for number in (signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) != signal.SIG_IGN:  # as nohup has it
            signal.signal(number, end)
    try:
        sys.exit(main(sys.argv[1:]))
    except (Failure, Stop) as failure:
        print(f"ivory: {failure}", file=sys.stderr)
    except OSError as error:
        print(f"ivory: {error.filename or 'ivory chart'}: {error.strerror or error}", file=sys.stderr)
    except KeyboardInterrupt:
        print("ivory: interrupted; the same command goes on from here", file=sys.stderr)
    sys.exit(1)
