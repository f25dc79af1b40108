"""Charts of error against cost: log-log, error bars, the references' own error as a floor, the Pareto front marked."""
import math
import os
import textwrap

import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot, ticker  # noqa: E402

from front import error_of, pareto  # noqa: E402

pyplot.rcParams.update({"font.size": 9, "axes.grid": True, "grid.alpha": 0.25, "axes.axisbelow": True, "legend.fontsize": 8,
                        "legend.frameon": False, "savefig.dpi": 120, "svg.fonttype": "none", "svg.hashsalt": "ivory",
                        "axes.spines.top": False, "axes.spines.right": False})
# Of series i; beyond the last colour they start again with other marks, hollow.
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#7f3c8d", "#4d4d4d", "#80b918", "#a83232")
MARKS = "osD^vP*X<>"


def style(i):
    """Colour, mark and its filling of the series of that number."""
    return {"color": COLOURS[i % len(COLOURS)], "marker": MARKS[(i + i // len(COLOURS)) % len(MARKS)],
            "markerfacecolor": COLOURS[i % len(COLOURS)] if i < len(COLOURS) else "white"}


def plain(x, _=None):
    if x == 0:
        return "0"
    return f"{x:.10f}".rstrip("0").rstrip(".") if 1e-3 <= abs(x) < 1e6 else f"{x:.0e}".replace("e-0", "e-").replace("e+0", "e")


def percent(x, _=None):
    return plain(100 * x) + " %"


def size(x, _=None):
    for unit, scale in (("MB", 1e6), ("kB", 1e3)):
        if x >= scale:
            return f"{plain(x / scale)} {unit}"
    return f"{plain(x)} B"


def logarithmic(axis, form):
    """Ticks at 1, 2, 5; over many decades at each, or at every few. What is zero or below stays linear around zero."""
    data = [v for line in axis.axes.lines for v in (line.get_xdata() if axis.axis_name == "x" else line.get_ydata())]
    positive = [abs(v) for v in data if isinstance(v, (int, float)) and v != 0]
    if positive and any(isinstance(v, (int, float)) and v <= 0 for v in data):
        least = max(min(positive), 1e-12 * max(positive))
        scale = {"linthresh": least, "linscale": 0.4}
        (axis.axes.set_xscale if axis.axis_name == "x" else axis.axes.set_yscale)("symlog", **scale)
        decades = math.log10(max(positive) / least)
        axis.set_major_locator(ticker.SymmetricalLogLocator(base=10 ** max(1, math.ceil(decades / 8)), linthresh=least))
        # The tick at the threshold would stand upon that at zero.
        axis.set_major_formatter(ticker.FuncFormatter(lambda v, i=None: "" if 0 < abs(v) < 1.5 * least else form(v)))
        if min(v for v in data if isinstance(v, (int, float))) >= 0:
            (axis.axes.set_xlim if axis.axis_name == "x" else axis.axes.set_ylim)(-0.3 * least, 2 * max(positive))
        return
    axis.axes.set_xscale("log") if axis.axis_name == "x" else axis.axes.set_yscale("log")
    low, high = axis.get_view_interval()
    decades = math.log10(high / low) if low > 0 else 1
    axis.set_major_locator(ticker.LogLocator(subs=(1, 2, 5) if decades < 2.5 else (1,), numticks=12))
    axis.set_minor_locator(ticker.NullLocator() if decades < 2.5 else ticker.LogLocator(subs=range(2, 10), numticks=12))
    axis.set_minor_formatter(ticker.NullFormatter())
    axis.set_major_formatter(ticker.FuncFormatter(form))


FORMATS = {"memory_bytes": size, "nrmse": percent, "relative_rmse": percent}


def settings(series, records):
    """A curve's name in the legend: with its first and last setting."""
    labels = list(dict.fromkeys(r["label"] for r in records))
    return series + (f": {labels[0]} to {labels[-1]}" if len(labels) > 1 else f": {labels[0]}" if labels[0] else "")


class Figures:
    """Writes NAME.svg and NAME.png into the folder and remembers them for the page."""

    def __init__(self, folder):
        self.folder = folder
        self.made = []  # (name, title)

    def save(self, figure, name, title, caption=""):
        figure.suptitle(title, fontsize=11)
        if caption:
            width = int(17 * figure.get_figwidth())
            figure.supxlabel("\n".join(textwrap.wrap(caption, width)), fontsize=8.5, color="#444444")
        for extension, options in (("svg", {"metadata": {"Date": None}}), ("png", {})):
            path = os.path.join(self.folder, f"{name}.{extension}")
            figure.savefig(f"{path}.part", format=extension, bbox_inches="tight", **options)
            os.replace(f"{path}.part", path)
        pyplot.close(figure)
        self.made.append((name, title))

    def costs(self, records, name, title, caption, axes=None, names=None):
        """One panel a pair (cost, error) of `axes`; one line a series. names: other titles of axes than NAMES.

        What the marks are stands in the legend alone: settings in the order of a curve; of series that are no curve, a mark a
        setting, the same in each of them."""
        axes = axes or (("time_s", "nrmse"), ("memory_bytes", "nrmse"), ("time_s", "relative_rmse"),
                        ("memory_bytes", "relative_rmse"))
        axes = [(x, y) for x, y in axes if any(r.get(x, 0) > 0 and r.get(y, 0) > 0 for r in records)]
        if not axes:
            return
        columns = 2 if len(axes) > 1 else 1
        rows = (len(axes) + columns - 1) // columns
        figure, panels = pyplot.subplots(rows, columns, figsize=(5.6 * columns, 4.1 * rows), squeeze=False,
                                         constrained_layout=True)
        series = {}
        for r in records:
            series.setdefault(r["series"], []).append(r)
        variants = list(dict.fromkeys(r["label"] for r in records if not r.get("join", True)))
        for panel, (x, y) in zip(panels.flat, axes):
            for i, (name_of, here) in enumerate(series.items()):
                if here[0].get("join", True):
                    self._line(panel, here, x, y, settings(name_of, here), style(i), "-")
                    continue
                panel.plot([], [], "s", color=COLOURS[i % len(COLOURS)], label=f"{name_of}:")
                for r in here:
                    mark = {**style(variants.index(r["label"])), "color": COLOURS[i % len(COLOURS)], "markerfacecolor": "white"}
                    self._line(panel, [r], x, y, None, mark, "")
            for label in variants:
                panel.plot([], [], linestyle="", label=label, **{**style(variants.index(label)), "color": "#444444", "markerfacecolor": "white"})
            self._frame(panel, records, x, y, {**NAMES, **(names or {})})
        for panel in panels.flat[len(axes):]:
            panel.remove()
        handles = {}
        for panel in panels.flat[:len(axes)]:
            for handle, label in zip(*panel.get_legend_handles_labels()):
                handles.setdefault(label, handle)
        # Curves first, in their order, then marks of variants, then what is drawn over and under them.
        order = [settings(s, here) for s, here in series.items()] + [f"{s}:" for s in series] + variants
        labels = sorted(handles, key=lambda label: order.index(label) if label in order else len(order))
        figure.legend([handles[label] for label in labels], labels, loc="center left", bbox_to_anchor=(1.0, 0.5))
        self.save(figure, name, title, caption)

    @staticmethod
    def _line(panel, records, x, y, label, mark, line):
        """Arrows down: at most so much is known of the error."""
        points = sorted((r for r in records if r.get(x, 0) > 0 and error_of(r, y) > 0), key=lambda r: r[x])
        if not points:
            return
        xs, ys = [r[x] for r in points], [error_of(r, y) for r in points]
        error = [min(r.get(f"{y}_se") or 0, 0.9 * py) for r, py in zip(points, ys)]
        at_most = [r[y] < py for r, py in zip(points, ys)]
        panel.errorbar(xs, ys, yerr=error if any(error) else None, uplims=at_most if any(error) else False, linestyle=line, markersize=4.5,
                       linewidth=1, elinewidth=0.8, label=label, **mark)

    @staticmethod
    def _frame(panel, records, x, y, names):
        for axis, kind in ((panel.xaxis, x), (panel.yaxis, y)):
            logarithmic(axis, FORMATS.get(kind, plain))
        panel.set_xlabel(names.get(x, x))
        panel.set_ylabel(names.get(y, y))
        floor = max((r.get(f"{y}_floor", 0) for r in records), default=0)
        if floor > 0:
            panel.axhline(floor, color="#888888", linewidth=2.5, alpha=0.5, zorder=0, label="standard error of the reference")
        front = pareto(records, x, y)
        if front:
            best = [error_of(r, y) for r in front]
            panel.plot([r[x] for r in front], best, "--", color="black", linewidth=0.9, alpha=0.6, zorder=1)
            panel.plot([r[x] for r in front], best, "o", color="black", fillstyle="none", markersize=9,
                       markeredgewidth=0.8, linestyle="none", label="Pareto front", zorder=1)

    def bars(self, name, title, panels):
        """panels: [(title, x name, log x, [(label, value)])], one bar a label."""
        figure, axes = pyplot.subplots(len(panels), 1, figsize=(8, sum(0.9 + 0.3 * len(p[3]) for p in panels)), squeeze=False,
                                       constrained_layout=True)
        for panel, (subtitle, x_name, log_x, values) in zip(axes.flat, panels):
            bars = panel.barh([label for label, _ in values], [value for _, value in values], color=COLOURS[0], height=0.6)
            panel.bar_label(bars, [f"{value:.3g}" for _, value in values], padding=3, fontsize=8)
            panel.invert_yaxis()
            panel.grid(axis="y", visible=False)
            panel.set_title(subtitle, fontsize=9)
            panel.set_xlabel(x_name)
            panel.margins(x=0.12)
            if log_x:
                panel.set_xscale("log")
                panel.xaxis.set_major_formatter(ticker.FuncFormatter(plain))
        self.save(figure, name, title)

    def sweep(self, name, title, caption, panels, columns=None, bounds=(), joined=True):
        """panels: [(title, x name, y name, log x, log y, [(label, xs, ys, errors or None)])]. joined: are they curves, or marks?

        bounds: for each line of a single panel, [(x, bound)], drawn as dashes."""
        panels = [(*p[:5], [line for line in p[5] if len(line[1])]) for p in panels]
        panels = [p for p in panels if p[5]]
        if not panels:
            return
        columns = min(columns or 3, len(panels))
        rows = (len(panels) + columns - 1) // columns
        figure, axes = pyplot.subplots(rows, columns, figsize=(4.6 * columns + 0.6, 3.6 * rows), squeeze=False,
                                       constrained_layout=True)
        for panel, (subtitle, x_name, y_name, log_x, log_y, lines) in zip(axes.flat, panels):
            for i, (label, xs, ys, errors) in enumerate(lines):
                panel.errorbar(xs, ys, yerr=errors, linestyle="-" if joined else "", markersize=4, linewidth=1, elinewidth=0.8, label=label, **style(i))
            for i, bound in enumerate(bounds):
                if bound:
                    panel.plot(*zip(*bound), "--" if len(bound) > 1 else "_", color=COLOURS[i % len(COLOURS)], linewidth=0.8, alpha=0.7)
            panel.set_title(subtitle, fontsize=9)
            panel.set_xlabel(x_name)
            panel.set_ylabel(y_name)
            if log_x:
                logarithmic(panel.xaxis, size if x_name == "memory" else plain)
            if log_y:
                logarithmic(panel.yaxis, percent if y_name in PERCENT else plain)
        handles = {}
        for panel in axes.flat[:len(panels)]:
            for handle, label in zip(*panel.get_legend_handles_labels()):
                handles.setdefault(label, handle)
        if len(handles) > 1:
            figure.legend(handles.values(), handles.keys(), loc="center left", bbox_to_anchor=(1.0, 0.5))
        for panel in axes.flat[len(panels):]:
            panel.remove()
        self.save(figure, name, title, caption)


PERCENT = ("NRMSE", "relative RMSE", "RMS error / mean E")
NAMES = {"time_s": "time, s (bake and picture)", "memory_bytes": "memory that light is read from", "nrmse": "NRMSE",
         "relative_rmse": "relative RMSE", "picture_s": "time of a picture, the bake left out, s", "read_ns": "time of one reading, ns", "floats": "floats a channel",
         "bake_s": "time of the bake, s"}
