"""What charts and tables alike ask of points; without matplotlib, which takes half a second to load."""
import math
import re


def error_of(record, y):
    """The error to plot and to compare: where it is less than its own standard error (the references' noise taken off, it can even
    come out as 0), only "at most that" is known."""
    return max(record.get(y) or 0, record.get(f"{y}_se") or 0)


def pareto(records, x, y):
    """Those that are better than all that is cheaper, by more than their standard error; by cost."""
    best, front = math.inf, []
    for r in sorted((r for r in records if r.get(x, 0) > 0 and error_of(r, y) > 0), key=lambda r: (r[x], error_of(r, y))):
        if error_of(r, y) + (r.get(f"{y}_se") or 0) < best:
            best = error_of(r, y)
            front.append(r)
    return front


def slug(*words):
    """A file's name of words for people: "grid", "bunny's room" -> grid_bunnys_room."""
    return re.sub("[^a-z0-9]+", "_", "_".join(words).lower().replace("'", "")).strip("_")
