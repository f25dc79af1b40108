#!/usr/bin/env python3
"""Measures ivory's methods against each other and draws what came out; called by `ivory chart`."""
import argparse
import fnmatch
import importlib
import json
import os
import sys

import page
import summary
import tables
from inputs import Inputs
from plot import Figures
from runner import Failure, Runner

CURVES = ("grid", "bases", "sh9", "fiv", "cubemap", "lobes", "rates", "stability")
WHOLE = ("quick", "full")
SUITES = {"quick": CURVES, "full": CURVES, "stability": ("stability",)}


def parse(arguments):
    parser = argparse.ArgumentParser(prog="ivory chart", description=__doc__)
    parser.add_argument("suite", metavar="SUITE", help="quick (minutes), full (under two hours on two cores), stability, or a curve: " +
                        ", ".join(CURVES))
    parser.add_argument("-o", "--output", metavar="FOLDER", help="results.jsonl, charts (.svg, .png) and index.html (SUITE.html of one curve) go there")
    parser.add_argument("--list", action="store_true", help="print the points instead of measuring them")
    parser.add_argument("--only", metavar="PATTERN", action="append", default=[],
                        help="only points whose name CURVE/SCENE/SERIES/SETTING matches; * and ? are wild; may be repeated")
    parser.add_argument("--draw", action="store_true", help="measure nothing, draw what results.jsonl has")
    parser.add_argument("--any-build", action="store_true", help="keep results of other builds of ivory of this version")
    parser.add_argument("--fill", metavar="FILE.md", action="append", default=[],
                        help="rewrite the tables between <!-- chart: NAME --> and <!-- /chart --> of this file, and copy its charts/NAME.png")
    parser.add_argument("--size", choices=("quick", "full"), default="quick", help="of a single curve [quick]")
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    parser.add_argument("--quiet", action="store_true")
    parser.add_argument("--ivory", required=True, help=argparse.SUPPRESS)
    parser.add_argument("--source", required=True, help=argparse.SUPPRESS)
    options = parser.parse_args(arguments)
    if options.suite not in SUITES and options.suite not in CURVES:
        parser.error(f"no suite or curve '{options.suite}'; there are {', '.join((*SUITES, *CURVES))}")
    if not options.output:
        parser.error("-o FOLDER is missing")
    return options


def wanted(point, patterns):
    return not patterns or any(fnmatch.fnmatch(point.name, p) for p in patterns)


def main(arguments):
    options = parse(arguments)
    curves = SUITES.get(options.suite, (options.suite,))
    size = "full" if options.suite == "full" or (options.suite not in SUITES and options.size == "full") else "quick"
    os.makedirs(options.output, exist_ok=True)
    runner = Runner(options.ivory, os.path.abspath(options.output), options.threads, options.any_build, options.quiet)
    inputs = Inputs(options.source, runner.folder)
    figures, sections, all_records, markdown = Figures(runner.folder), [], [], {}
    for name in curves:
        curve = importlib.import_module(name)
        try:
            points = [p for p in curve.points(size, inputs, runner) if wanted(p, options.only)]
        except (Failure, OSError) as failure:
            runner.failed.append((name, str(failure)))
            continue
        if len({p.name for p in points}) != len(points):
            raise Failure(f"{name}: two points have one name")
        if options.list:
            for p in points:
                print(("done  " if runner.known(p) else "      ") + p.name)
            continue
        records = [runner.point(p) for p in points if runner.known(p)] if options.draw else runner.points(points)
        if not records:
            continue
        before = len(figures.made)
        curve.draw(records, figures)
        section_tables = curve.page_tables(records)
        markdown.update(curve.markdown_tables(records))
        sections.append((name, curve.TITLE, curve.ABOUT, figures.made[before:], section_tables))
        all_records += records
    if options.list:
        return 0
    if runner.failed:
        print(f"ivory: {len(runner.failed)} points failed, the first: {runner.failed[0][0]}: {runner.failed[0][1]}", file=sys.stderr)
    if not all_records:
        raise Failure("nothing was measured; see --list and --only" +
                      ("; --any-build takes what another build of ivory measured" if options.draw else ""))
    written = page.write(runner.folder, options.suite, options.suite in WHOLE, sections, inputs.skipped + runner.failed, all_records, runner)
    if options.suite in WHOLE:
        markdown["summary"] = summary.table(all_records)
    kept = os.path.join(runner.folder, "tables.json")
    if os.path.exists(kept):  # those of other curves
        with open(kept, encoding="utf-8") as file:
            markdown = {**json.load(file), **markdown}
    with open(kept, "w", encoding="utf-8") as file:
        json.dump(markdown, file, indent=1)
    for path in options.fill:
        missing = tables.rewrite(path, markdown, runner.folder)
        if missing:
            print(f"ivory: {path}: these results have no {', '.join(missing)}; left as it was", file=sys.stderr)
    if not options.quiet:
        for what, why in inputs.skipped:
            print(f"skipped: {what}: {why}", file=sys.stderr)
        print(f"{written}: {len(all_records)} points, {len(figures.made)} charts")
    return 1 if runner.failed else 0


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except Failure as failure:
        print(f"ivory: {failure}", file=sys.stderr)
        sys.exit(1)
    except KeyboardInterrupt:
        print("ivory: interrupted; the same command goes on from here", file=sys.stderr)
        sys.exit(1)
