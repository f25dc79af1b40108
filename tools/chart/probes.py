"""Points for `ivory probe`, and errors of what it reads there."""
import csv
import math
import random

from writer.files import write_file


def rows(path):
    """[(E rgb, standard error rgb)]; errors that are not known, where no light was met, are taken for 0."""
    with open(path, newline="", encoding="ascii") as file:
        return [([float(r[c]) for c in "rgb"], [float(r[c + "_se"] or 0) for c in "rgb"]) for r in csv.DictReader(file)]


def errors(estimates, truths, by_mean=False):
    """NRMSE (by_mean: RMSE over mean truth), relative RMSE, their standard errors over points, the truth's floors.

    The truth's own variance, known from its standard errors, is taken off."""
    values = [t for e, _ in truths for t in e]
    mean = sum(values) / len(values)
    span = mean if by_mean else max(values) - min(values)
    least = 0.01 * mean
    squares, relatives, noise, relative_noise = [], [], [], []
    for (e, _), (t, se) in zip(estimates, truths):
        weight = [x * x + least * least for x in t]
        squares.append(sum((a - b) ** 2 - s * s for a, b, s in zip(e, t, se)) / 3)
        relatives.append(sum(((a - b) ** 2 - s * s) / w for a, b, s, w in zip(e, t, se, weight)) / 3)
        noise.append(sum(s * s for s in se) / 3)
        relative_noise.append(sum(s * s / w for s, w in zip(se, weight)) / 3)
    nrmse, nrmse_se = _root(squares)
    relative, relative_se = _root(relatives)
    return {"nrmse": nrmse / span, "nrmse_se": nrmse_se / span, "relative_rmse": relative, "relative_rmse_se": relative_se,
            "nrmse_floor": math.sqrt(sum(noise) / len(noise)) / span,
            "relative_rmse_floor": math.sqrt(sum(relative_noise) / len(relative_noise)),
            "worst": max(abs(a - b) for (e, _), (t, _) in zip(estimates, truths) for a, b in zip(e, t)) / span}


def _root(squares):
    n = len(squares)
    mean = sum(squares) / n
    se = math.sqrt(sum((s - mean) ** 2 for s in squares) / (n * (n - 1))) if n > 1 else 0.0
    root = math.sqrt(max(0.0, mean))
    return root, (se / (2 * math.sqrt(max(mean, se / 4))) if se > 0 else 0.0)


def direction(rng):
    while True:
        v = [rng.uniform(-1, 1) for _ in range(3)]
        length = math.sqrt(sum(x * x for x in v))
        if 0.1 < length <= 1:
            return [x / length for x in v]


def write(path, points):
    """points: (place, normal). The same bytes every time."""
    write_file(path, "x,y,z,nx,ny,nz\n" + "".join(",".join(f"{x + 0.0:.7g}" for x in (*p, *n)) + "\n" for p, n in points))
    return path


def normals(path, count, place=(0.0, 0.0, 0.0)):
    """Random normals at one place."""
    rng = random.Random(1)
    return write(path, [(place, direction(rng)) for _ in range(count)])
