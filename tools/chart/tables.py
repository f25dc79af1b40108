"""Tables of the results, and Markdown between markers in documents.

`<!-- chart: NAME -->` ... `<!-- /chart -->` in a Markdown file is replaced by the table NAME of the results.
"""
import os
import re
import shlex
import shutil

from front import error_of, pareto

MARKER = re.compile(r"(<!-- chart: ([a-z0-9_]+) -->\n)(.*?)(<!-- /chart -->)", re.DOTALL)


def number(x, digits=3):
    """1.23, 0.0123, 12,300: `digits` significant."""
    if x == 0:
        return "0"
    if abs(x) < 1e-4:
        return f"{x:.{digits - 1}e}"
    text = f"{x:.{digits}g}"
    return text if "e" not in text else f"{x:,.0f}"


def is_number(text):
    return bool(re.match(r"^[-+]?[\d.,]+(e[-+]\d+)?( ?(±|%|s|ms|ns|kB|MB|B).*)?$", str(text)))


def seconds(s):
    return f"{1000 * s:.0f} ms" if s < 1 else f"{s:.1f} s" if s < 100 else f"{s:.0f} s"


def size(b):
    for unit, scale in (("MB", 1e6), ("kB", 1e3)):
        if b >= scale:
            return f"{number(b / scale)} {unit}"
    return f"{b:.0f} B" if b else "–"


def percent(x):
    return f"{number(100 * x)} %"


def nrmse(record):
    """With "at most" before it where its standard error is larger."""
    return ("≤ " if record["nrmse"] < error_of(record, "nrmse") else "") + percent(error_of(record, "nrmse"))


def points_table(records):
    """(head, rows, indices of rows on the Pareto front by time) of points with an error."""
    front = [r["name"] for r in pareto(records, "time_s", "nrmse")]
    records = sorted(records, key=lambda r: r.get("time_s", 0))
    head = ("method", "setting", "time", "memory", "peak memory", "NRMSE", "relative RMSE", "command")
    rows = [(r["series"], r["label"], seconds(r.get("time_s", 0)), size(r.get("memory_bytes", 0)),
             size(r.get("peak_memory_bytes", 0)), f"{percent(r['nrmse'])} ± {number(100 * r.get('nrmse_se', 0), 2)}",
             percent(r["relative_rmse"]) if "relative_rmse" in r else "–", " && ".join(short(c) for c in r["commands"]))
            for r in records]
    return head, rows, [i for i, r in enumerate(records) if r["name"] in front]


def short(command):
    """A command without the folders of its files."""
    return " ".join(os.path.basename(w) if "/" in w else w for w in shlex.split(command))


def front_table(records):
    """The Pareto front by time of each panel, in Markdown."""
    lines = ["| scene | method | setting | time | memory | NRMSE |", "|---|---|---|---|---|---|"]
    for panel in dict.fromkeys(r["panel"] for r in records):
        for r in pareto([r for r in records if r["panel"] == panel], "time_s", "nrmse"):
            lines.append(f"| {panel} | {r['series']} | {r['label']} | {seconds(r['time_s'])} | {size(r['memory_bytes'])} | "
                         f"{nrmse(r)} |")
    return "\n".join(lines) + "\n"


def on_front(records):
    """Of each method: in how many panels it is on the front of error against time, and against memory; in Markdown."""
    panels = list(dict.fromkeys(r["panel"] for r in records))
    rows = []
    for method in dict.fromkeys(r["method"] for r in records):
        where = [p for p in panels if any(r["panel"] == p and r["method"] == method for r in records)]
        cells = [sum(method in {r["method"] for r in pareto([r for r in records if r["panel"] == p], x, "nrmse")} for p in where)
                 for x in ("time_s", "memory_bytes")]
        stored = any(r["memory_bytes"] > 0 for r in records if r["method"] == method)
        rows.append((method, f"{cells[0]} of {len(where)}", f"{cells[1]} of {len(where)}" if stored else "stores nothing"))
    rows.sort(key=lambda row: -int(row[1].split()[0]))
    return markdown(("method", "scenes where it is on the front by time", "by memory"), rows)


def markdown(head, rows):
    return "\n".join(["| " + " | ".join(head) + " |", "|" + "---|" * len(head)] +
                     ["| " + " | ".join(str(c) for c in row) + " |" for row in rows]) + "\n"


def rewrite(path, tables, folder, charts):
    """Replaces what stands between the markers, and copies those of the charts that the document shows as charts/NAME.png or .svg to
    beside it; returns what the results do not have."""
    with open(path, encoding="utf-8") as file:
        text = file.read()
    missing = []

    def fill(match):
        if match[2] not in tables:
            missing.append(match[2])
            return match[0]
        return match[1] + tables[match[2]] + match[4]

    new = MARKER.sub(fill, text)
    for name in dict.fromkeys(re.findall(r"\]\(charts/([a-z0-9_]+\.(?:png|svg))\)", text)):
        if name.rsplit(".", 1)[0] in charts and os.path.exists(os.path.join(folder, name)):
            target = os.path.join(os.path.dirname(path), "charts")
            os.makedirs(target, exist_ok=True)
            shutil.copyfile(os.path.join(folder, name), os.path.join(target, name))
        else:
            missing.append(name)
    if new != text:
        with open(path + ".part", "w", encoding="utf-8") as file:
            file.write(new)
        os.replace(path + ".part", path)
    return missing
