"""One HTML page that holds everything: charts inside, tables, how it was measured. No file beside it is needed."""
import base64
import os
import re

import jinja2
import markupsafe

import tables


def code(text):
    """Running text with `code` marked up."""
    return markupsafe.Markup(re.sub(r"`([^`]*)`", r"<code>\1</code>", str(markupsafe.escape(" ".join(text.split())))))


def text_columns(rows, head):
    """For each column: does it hold words, to be set flush left?"""
    return [all(not tables.is_number(row[i]) for row in rows) for i in range(len(head))]


def start_up(records):
    taken = [r["start_up_s"] for r in records if r["start_up_s"] > 0]
    if not taken:
        return "where it is not what the command reports itself."
    span = " to ".join(dict.fromkeys(tables.seconds(s) for s in (min(taken), max(taken))))
    return f"but the {span} of each command in which the program starts and links its libraries (`ivory --version`)."


def disturbance(records):
    """What other programs took of the processors while points were timed, the worst first."""
    known = [r for r in records if r["foreign"] is not None]
    if not known:
        return "What other programs took of the processors meanwhile is not known."
    worst = max(known, key=lambda r: r["foreign"])
    return (f"Other programs took at most {tables.percent(worst['foreign'])} of one core meanwhile (`{worst['name']}`); commands under "
            "which they took more than 10 % were run again, up to twice.")


def about(suite, records, runner):
    machines = sorted({(r["machine"]["cpu"], r["machine"]["cores"]) for r in records})
    builds = sorted({r["build"] for r in records})
    return (f"Suite `{suite}`, {runner.version} (build {', '.join(builds)}), {'; '.join(f'{cpu}, {cores} cores' for cpu, cores in machines)}, "
            f"{runner.threads} threads. Each mark is one or two commands; all are in results.jsonl with seed, machine, time and peak memory. "
            f"Time: the whole command, reading the scene included, {start_up(records)} The least of three runs counts where it is under a "
            f"second. {disturbance(records)} Rings and dashes: the Pareto front, which nothing else is both cheaper and better than.")


def write(folder, suite, whole, sections, skipped, records, runner):
    """index.html of a whole suite, SUITE.html of a part. sections: [{"id", "title", "about", "figures": [(name, title)],
    "tables": [(heading, head, rows, indices of rows on the front)]}]."""
    def svg(name):
        with open(os.path.join(folder, f"{name}.svg"), "rb") as file:
            return base64.b64encode(file.read()).decode()

    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(os.path.dirname(os.path.abspath(__file__))), autoescape=True,
                                     trim_blocks=True)
    environment.filters.update(code=code, svg=svg, text_columns=text_columns)
    text = environment.get_template("page.html").render(about=about(suite, records, runner), sections=sections, skipped=skipped)
    path = os.path.join(folder, "index.html" if whole else f"{suite}.html")
    with open(path + ".part", "w", encoding="utf-8") as file:
        file.write(text)
    os.replace(path + ".part", path)
    return path
