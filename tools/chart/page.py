"""One HTML page that holds everything: charts inside, tables, how it was measured. No file beside it is needed."""
import base64
import html
import os
import re

import tables

STYLE = """body{font:15px/1.5 system-ui,sans-serif;max-width:1280px;margin:2em auto;padding:0 1em;color:#222}
h1{font-weight:600}h2{margin-top:2.5em;border-bottom:1px solid #ccc}figure{margin:1.5em 0}figure img{max-width:100%}
table{border-collapse:collapse;font-size:13px}td,th{padding:2px 9px;text-align:right;
border-bottom:1px solid #e5e5e5;vertical-align:top}td.text,th.text{text-align:left}tr.front{background:#eaf4ea}
code{font-size:12px;background:#f4f4f4;padding:0 3px;word-break:break-all}nav a{margin-right:1.2em}details{margin:1em 0}"""


def paragraph(text):
    return "<p>" + re.sub(r"`([^`]*)`", r"<code>\1</code>", html.escape(" ".join(text.split()))) + "</p>"


def picture(folder, name, title):
    with open(os.path.join(folder, f"{name}.svg"), "rb") as file:
        data = base64.b64encode(file.read()).decode()
    return (f'<figure id="{name}"><img alt="{html.escape(title)}" src="data:image/svg+xml;base64,{data}">'
            "</figure>")


def table(rows, head, front=()):
    def cell(value, tag, text):
        return f'<{tag}{" class=text" if text else ""}>{html.escape(str(value))}</{tag}>'
    words = [all(not tables.is_number(row[i]) for row in rows) for i in range(len(head))]
    lines = ["<tr>" + "".join(cell(h, "th", w) for h, w in zip(head, words)) + "</tr>"]
    for i, row in enumerate(rows):
        lines.append(f'<tr{" class=front" if i in front else ""}>' + "".join(cell(v, "td", w) for v, w in zip(row, words)) + "</tr>")
    return "<table>" + "".join(lines) + "</table>"


def start_up(records):
    taken = [r["start_up_s"] for r in records if r["start_up_s"] > 0]
    if not taken:
        return "where it is not what the command reports itself."
    span = " to ".join(dict.fromkeys(tables.seconds(s) for s in (min(taken), max(taken))))
    return f"but the {span} of each command in which the program starts and links its libraries (`ivory --version`)."


def disturbance(records):
    """What others took of the processors while points were timed, the worst first."""
    known = [r for r in records if r["foreign"] is not None]
    if not known:
        return "What others took of the processors meanwhile is not known."
    worst = max(known, key=lambda r: r["foreign"])
    return (f"Others took at most {tables.percent(worst['foreign'])} of one core meanwhile (`{worst['name']}`); commands under which they "
            "took more than 10 % were run again, up to twice.")


def write(folder, suite, whole, sections, skipped, records, runner):
    """index.html of a whole suite, SUITE.html of a part. sections: [(id, title, about, figures, tables: [(heading, head, rows, front)])]."""
    machines = {(r["machine"]["cpu"], r["machine"]["cores"]) for r in records}
    builds = sorted({r["build"] for r in records})
    out = ["<!doctype html><html lang=en><meta charset=utf-8><title>ivory: speed against accuracy</title>",
           f"<style>{STYLE}</style><h1>ivory: speed against accuracy</h1>",
           paragraph(f"Suite `{suite}`, {runner.version} (build {', '.join(builds)}), "
                     f"{'; '.join(f'{cpu}, {cores} cores' for cpu, cores in sorted(machines))}, {runner.threads} threads. Each mark is "
                     "one or two commands; all are in results.jsonl with seed, machine, time and peak memory. Time: the whole command, "
                     f"reading the scene included, {start_up(records)} The least of three runs counts where it is under a second. "
                     f"{disturbance(records)} Rings and dashes: the Pareto front, which nothing else is both cheaper and better than."),
           "<nav>" + "".join(f'<a href="#{i}">{html.escape(t)}</a>' for i, t, *_ in sections) + "</nav>"]
    for identifier, title, about, figures, section_tables in sections:
        out.append(f'<h2 id="{identifier}">{html.escape(title)}</h2>{paragraph(about)}')
        out += [picture(folder, *f) for f in figures]
        for heading, head, rows, front in section_tables:
            out.append(f"<details><summary>{html.escape(heading)}</summary>{table(rows, head, front)}</details>")
    if skipped:
        out.append("<h2>Skipped or failed</h2><ul>" + "".join(f"<li>{html.escape(a)}: {html.escape(b)}</li>" for a, b in skipped) + "</ul>")
    path = os.path.join(folder, "index.html" if whole else f"{suite}.html")
    with open(path + ".part", "w", encoding="utf-8") as file:
        file.write("\n".join(out))
    os.replace(path + ".part", path)
    return path
