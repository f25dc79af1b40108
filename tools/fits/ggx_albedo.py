#!/usr/bin/python3
"""Fits what tracer/bsdf/microfacet_albedo.cpp and shaders/renderer/bsdf.glsl know of GGX's directional albedo, and prints the constants.

    E(mu, alpha) = f0 G + (f90 - f0) B,   G = int D V cos dwi,   B = int p D V cos dwi,   p = (1 - h.wo)^5

by quadrature over visible normals; bounds from above, so that what is left for the diffuse lobe never makes a surface reflect more than
arrives: linear programmes for the least mean slack (over cos-weighted mu, and roughness) among polynomials that stay above everywhere and
below one. Needs Debian's python3-scipy."""
import numpy as np
from scipy.optimize import linprog

COS_FLOOR = 0.05  # of the weight, so that grazing angles count for something
WORST = 0.1       # weight of the largest slack beside the mean one
MARGIN = 2e-4     # for what lies between the nodes, and rounding to the printed digits
G_POWERS, B_POWERS = (5, 5), (5, 4)  # of 1 - mu; of roughness, of t = 1/(1 + 8 alpha) from the first power on


def albedo(mus, alphas, radial=96, around=96):
    """G and B, alphas x mus. Visible normals as sample_visible_normal() in bsdf.cpp makes them."""
    u, weight = np.polynomial.legendre.leggauss(radial)
    u, weight = (u + 1) / 2, weight[:, None] / 2 / around
    phi = (np.arange(around) + 0.5) / around * np.pi  # even in the azimuth
    g_out, b_out = np.zeros((len(alphas), len(mus))), np.zeros((len(alphas), len(mus)))
    for i, alpha in enumerate(alphas):
        for j, mu in enumerate(np.maximum(mus, 1e-4)):
            sine = np.sqrt(1 - mu * mu)
            standard = np.array([sine * alpha, 0, mu]) / np.hypot(sine * alpha, mu)
            z = (1 - u)[:, None] * (1 + standard[2]) - standard[2]
            ring = np.sqrt(np.maximum(0, 1 - z * z))
            h = np.array([(ring * np.cos(phi) + standard[0]) * alpha, ring * np.sin(phi) * alpha,
                          np.maximum(z + standard[2], 0) * np.ones_like(phi)])
            h /= np.maximum(np.sqrt((h * h).sum(0)), 1e-30)
            cosine = sine * h[0] + mu * h[2]
            wi_z = 2 * cosine * h[2] - mu
            smith = lambda c: 0.5 * (np.sqrt(1 + alpha * alpha * (1 - np.minimum(c, 1) ** 2) / c ** 2) - 1)
            own = smith(mu)
            seen = np.where(wi_z > 0, (1 + own) / (1 + own + smith(np.maximum(wi_z, 1e-9))), 0) * weight
            p = (1 - np.clip(cosine, 0, 1)) ** 5
            g_out[i, j], b_out[i, j] = seen.sum(), (seen * p).sum()
    return g_out, b_out


def columns(x, roughness):
    t = 1 / (1 + 8 * roughness ** 2)
    g = [x ** i * roughness ** j for i in range(G_POWERS[0] + 1) for j in range(G_POWERS[1] + 1)]
    b = [x ** i * t ** j for i in range(B_POWERS[0] + 1) for j in range(1, B_POWERS[1] + 1)]
    return [np.array([c.ravel() for c in columns]).T for columns in (g, b)]


def bound(values, columns, weight):
    """Coefficients of the columns' least combination above the values and below one."""
    count, t = columns.shape[1], values.ravel() + MARGIN
    cost = np.append((columns * weight[:, None]).mean(0), WORST)
    zero, one = np.zeros((len(t), 1)), (1 / np.sqrt(weight))[:, None]
    sides = np.vstack([np.hstack([-columns, zero]), np.hstack([columns, -one]), np.hstack([columns, zero])])
    limits = np.concatenate([-t, t, np.full(len(t), 1 + 3 * MARGIN)])
    solved = linprog(cost, A_ub=sides, b_ub=limits, bounds=[(None, None)] * count + [(0, None)], method="highs")
    assert solved.success, solved.message
    return np.array([float(f"{v:.7g}") for v in solved.x[:count]])


def fit(mus, roughnesses):
    g, b = albedo(mus, roughnesses ** 2)
    x, r = np.meshgrid(1 - mus, roughnesses)
    weight = (1 - x).ravel() + COS_FLOOR
    weight /= weight.mean()
    return [bound(values, c, weight) for values, c in zip((g, b), columns(x, r))]


def report(found, mus, roughnesses):
    x, r = np.meshgrid(1 - mus, roughnesses)
    slacks = []
    for name, values, c, f in zip("GB", albedo(mus, roughnesses ** 2), columns(x, r), found):
        slacks.append((name, (c @ f).reshape(values.shape) - values))
        print(f"// {name} at most {(c @ f).max():.5f}")
    slacks.append(("dielectric of f0 = 0.04", 0.04 * slacks[0][1] + 0.96 * slacks[1][1]))
    for name, slack in slacks:
        print(f"// {name}: above by {slack.min():.6f} to {slack.max():.4f} (mu > 0.2: {slack[:, mus > 0.2].max():.4f}), "
              f"mean over diffuse light {(slack * (1 - x)).sum() / (1 - x).sum():.4f}")


if __name__ == "__main__":
    bounds = fit(np.unique(np.concatenate([np.linspace(0, 1, 41), [0.003, 0.006, 0.012, 0.018, 0.035, 0.06]])), np.linspace(0.0316, 1, 33))
    report(bounds, np.unique(np.concatenate([np.linspace(0, 1, 30), np.geomspace(1e-3, 0.1, 8)])), np.linspace(0.0316, 1, 23))
    for name, part, powers in zip("GB", bounds, (G_POWERS[1] + 1, B_POWERS[1])):
        for k, row in enumerate(part.reshape(-1, powers)):
            print(f"{name}, (1 - mu)^{k}: " + ", ".join(f"{v:.7g}" for v in row))
