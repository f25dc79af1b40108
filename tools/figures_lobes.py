#!/usr/bin/env python3
"""Measures cosine lobes and sphere sets: error against time, beside shadow rays and spherical Gaussians.

    tools/figures_lobes.py products | gaussians | spheres | shadows | rates | options | all   [--ivory PATH] [--work FOLDER] [--quick]

products: the table's errors. gaussians: spherical Gaussians (numpy). spheres: sphere sets of the bunny. shadows: the plane under the bunny, by
mask depth and by shadow rays, against Monte Carlo on the same spheres and on the mesh; draws lobes.svg and lobes.png. options: threshold,
rule and split. All but products and gaussians need the bunny of Debian's package glmark2-data. Prints Markdown rows. Times are the best of
five, pictures of 320x240 with one sample a pixel, one thread, everything counted but reading the scene. The same seed everywhere: pixels are
looked at in the same places. rates: points a second, from pictures of 16 samples a pixel beyond the time of the same without shadows.
"""
import argparse
import json
import math
import os
import subprocess
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
COUNTS = (16, 64, 256)
DEPTHS = (1, 2, 3, 4, 5)


class Ivory:
    def __init__(self, binary, work, quick):
        self.binary, self.work, self.quick = binary, work, quick
        os.makedirs(work, exist_ok=True)

    def path(self, name):
        return os.path.join(self.work, name)

    def run(self, *arguments):
        done = subprocess.run([self.binary, *map(str, arguments), "--json"], capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(done.stderr.strip())
        return json.loads(done.stdout)

    def once(self, name, *arguments):
        """Makes a file unless it is there."""
        if not os.path.exists(self.path(name)):
            self.run(*arguments, "-o", self.path(name))
        return self.path(name)

    def scene(self, name):
        if not os.path.exists(self.path(name)):
            subprocess.run([sys.executable, os.path.join(ROOT, "scenes", "make_lobes_scenes.py"), self.work], check=True)
        return self.path(name)

    def table(self):
        return self.once("lobes.exr", "bake", "lobes")

    def set(self, count):
        return self.once(f"bunny_{count}.json", "bake", "spheres", self.scene("bunny.glb"), "--count", count)

    def render(self, scene, out, *options, repeats=1):
        """Renders; returns the least time of `repeats`."""
        size = "320x240"
        return min(self.run("render", self.scene(scene), "-o", self.path(out), "--force", "--method", "lobes", "--samples", 1,
                            "--size", size, "--threads", 1, "--lobes", self.table(), *options)["seconds"]
                   for _ in range(repeats))

    def seconds_of(self, scene, samples, *options):
        return min(self.run("render", self.scene(scene), "-o", self.path("rate.exr"), "--force", "--method", "lobes", "--size", "320x240",
                            "--threads", 1, "--lobes", self.table(), "--samples", samples, *options)["seconds"] for _ in range(3))

    def nrmse(self, image, reference):
        return self.run("compare", self.path(image), self.path(reference))["nrmse"]


def products(ivory):
    r = ivory.run("bake", "lobes", "-o", ivory.path("products.exr"), "--force", "--error-samples", "1m")
    print("| measure | mean | median | worst | at e1, e2, angle |\n|---|---|---|---|---|")
    for key, name in (("integral_error", "integral, absolute"), ("integral_error_of_largest", "integral / that at angle 0"),
                      ("integral_error_relative", "integral, relative"), ("exponent_error", "exponent + 1, relative"),
                      ("axis_error_widths", "axis, in lobe widths"), ("shape_error", "shape, L2 relative")):
        d, at = r[key], r[key]["worst_at"]
        print(f"| {name} | {d['mean']:.1e} | {d['median']:.1e} | {d['worst']:.1e} | "
              f"{at['e1']:.3g}, {at['e2']:.3g}, {at['angle_deg']:.0f}° |")
    print(f"built in {r['build_seconds']:.2f} s, {r['bytes'] / 1e6:.2f} MB, {r['error_samples']} products")


def gaussians(_ivory):
    """Light of a ball on a matt surface: one spherical Gaussian for the cosine, one for the ball, against this table's closed forms."""
    import numpy as np

    def ball(half, theta):  # irradiance of a cap of radiance 1, cut at the horizon, by quadrature
        n = 400
        c = 1 - (1 - math.cos(half)) * (np.arange(n) + 0.5) / n
        phi = 2 * math.pi * (np.arange(n) + 0.5) / n
        s = np.sqrt(1 - c * c)
        cosine = c[:, None] * math.cos(theta) + s[:, None] * np.cos(phi)[None, :] * math.sin(theta)
        return np.maximum(cosine, 0).mean() * 2 * math.pi * (1 - math.cos(half))

    def sg_product(l1, a1, l2, a2, theta):  # int a1 exp(l1(u.w - 1)) a2 exp(l2(v.w - 1)) dw
        length = math.sqrt(l1 * l1 + l2 * l2 + 2 * l1 * l2 * math.cos(theta))
        return a1 * a2 * 2 * math.pi * (math.exp(length - l1 - l2) - math.exp(-length - l1 - l2)) / length

    def cap_sg(half):  # the cap's solid angle and mean cosine, coth(l) - 1/l = (1 + cos)/2
        target, low, high = (1 + math.cos(half)) / 2, 1e-3, 1e8
        for _ in range(200):
            mid = math.sqrt(low * high)
            value = 1 / math.tanh(mid) - 1 / mid
            low, high = (mid, high) if value < target else (low, mid)
        return low, (1 - math.cos(half)) * low / (1 - math.exp(-2 * low))

    def lobe(half, theta):  # the clamped cosine times the cap's lobe: int max(n.w,0) s max(a.w,0)^e
        c = math.cos(half)
        e, s = 2 * c / (1 - c), 1 + c
        n = 4000
        u = (np.arange(n) + 0.5) / n * (math.pi - theta)
        j = (np.sin(u) ** e * np.sin(math.pi - theta - u)).sum() * (math.pi - theta) / n
        return s * j * math.sqrt(math.pi) * math.exp(math.lgamma((e + 3) / 2) - math.lgamma((e + 4) / 2))

    print("| half-angle of the light | angle from the normal | exact E/L | cosine lobes | spherical Gaussians |\n|---|---|---|---|---|")
    for half in (5, 15, 30, 60):
        for theta in (0, 45, 75, 90):
            h, t = math.radians(half), math.radians(theta)
            exact = ball(h, t)
            sg = sg_product(2.133, 1.17, *cap_sg(h), t)  # the cosine as Hill's widely used Gaussian
            print(f"| {half}° | {theta}° | {exact:.4f} | {100 * (lobe(h, t) / exact - 1):+.1f} % | {100 * (sg / exact - 1):+.1f} % |")


def spheres(ivory):
    print("| spheres | outside the mesh | mesh uncovered | surface > 2 % out | mean distance | farthest out | time |")
    print("|---|---|---|---|---|---|---|")
    for count in COUNTS:
        r = ivory.run("bake", "spheres", ivory.scene("bunny.glb"), "-o", ivory.path(f"bunny_{count}.json"), "--force",
                      "--count", count, "--threads", 2)
        print(f"| {r['count']} | {100 * r['volume_outside']:.1f} % | {100 * r['volume_uncovered']:.1f} % | "
              f"{100 * r['surface_uncovered']:.1f} % | {100 * r['surface_mean']:.2f} % | {100 * r['surface_farthest']:.1f} % | "
              f"{r['seconds']:.1f} s |", flush=True)


def curves(ivory, scene, reference, reference_options, series, prefix):
    """{label: [(setting, seconds, nrmse)]} of a scene against a reference picture."""
    if not os.path.exists(ivory.path(reference)):
        ivory.render(scene, reference, *reference_options)
    result = {}
    for label, settings in series.items():
        for setting, options in settings:
            seconds = ivory.render(scene, "figure.exr", *options, repeats=5)
            error = ivory.nrmse("figure.exr", reference)
            result.setdefault(label, []).append((setting, seconds, error))
            print(f"| {prefix} | {label} | {setting} | {1000 * seconds:.0f} ms | {100 * error:.3f} % |", flush=True)
    return result


def shadows(ivory):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    rays = (1, 4, 16, 64, 256) if ivory.quick else (1, 4, 16, 64, 256, 1024)
    truth = ("--shadow-rays", 1024 if ivory.quick else 4096)
    set64 = ("--spheres", ivory.set(64))
    print("| truth | method | setting | time | NRMSE |\n|---|---|---|---|---|")

    def lobes(count, depths=DEPTHS):
        return [(f"depth {d}", ("--spheres", ivory.set(count), "--mask-depth", d)) for d in depths]

    sphere_rays = [(f"{n} rays", (*set64, "--shadows", "spheres", "--shadow-rays", n)) for n in rays]
    mesh_rays = [(f"{n} rays", ("--shadows", "mesh", "--shadow-rays", n)) for n in rays[:5]]
    panels = [
        ("matt plane, truth: the same 64 spheres", curves(
            ivory, "bunny_plane.glb", "ref_spheres.exr", (*set64, "--shadows", "spheres", *truth),
            {"lobes, 64 spheres": lobes(64), "shadow rays, spheres": sphere_rays}, "matt, spheres")),
        ("glossy plane, truth: the same 64 spheres", curves(
            ivory, "bunny_gloss.glb", "ref_gloss.exr", (*set64, "--shadows", "spheres", *truth),
            {"lobes, 64 spheres": lobes(64), "shadow rays, spheres": sphere_rays}, "glossy, spheres")),
        ("matt plane, truth: the mesh", curves(
            ivory, "bunny_plane.glb", "ref_mesh.exr", ("--shadows", "mesh", *truth),
            {**{f"lobes, {count} spheres": lobes(count) for count in COUNTS}, "shadow rays, mesh": mesh_rays}, "matt, mesh")),
    ]

    figure, axes = plt.subplots(1, 3, figsize=(13, 4.2), constrained_layout=True, sharey=False)
    for axis, (title, data) in zip(axes, panels):
        for label, points in data.items():
            ours = label.startswith("lobes")
            axis.loglog([1000 * p[1] for p in points], [100 * p[2] for p in points], "o-" if ours else "s--", label=label,
                        markersize=4)
            for setting, seconds, error in points:
                axis.annotate(setting.split()[-1] if ours else setting.split()[0], (1000 * seconds, 100 * error),
                              textcoords="offset points", xytext=(4, 3), fontsize=7)
        axis.set_title(title, fontsize=10)
        axis.set_xlabel("time of the picture (320x240, one thread), ms")
        axis.grid(True, which="both", alpha=0.25)
        axis.legend(fontsize=8)
    axes[0].set_ylabel("NRMSE, %")
    for extension in ("svg", "png"):
        figure.savefig(ivory.path("lobes." + extension), dpi=110)


def rates(ivory):
    print("| scene | shadows | points a second |\n|---|---|---|")
    for scene in ("bunny_plane.glb", "bunny_gloss.glb"):
        bare = ivory.seconds_of(scene, 16, "--shadows", "none")
        print(f"| {scene} | none, eye rays included | {320 * 240 * 16 / bare / 1e6:.2f} M |")
        for label, samples, options in (
                *((f"lobes, {count} spheres, depth {d}", 16, ("--spheres", ivory.set(count), "--mask-depth", d))
                  for count in COUNTS for d in (3, 4, 5)),
                ("16 rays, 64 spheres", 4, ("--spheres", ivory.set(64), "--shadows", "spheres", "--shadow-rays", 16)),
                ("16 rays, mesh", 4, ("--shadows", "mesh", "--shadow-rays", 16))):
            seconds = ivory.seconds_of(scene, samples, *options) - bare * samples / 16
            print(f"| {scene} | {label} | {320 * 240 * samples / max(seconds, 1e-4) / 1e6:.2f} M |", flush=True)


def options(ivory):
    """Threshold, mask rule and split, against Monte Carlo on the same spheres."""
    set64 = ("--spheres", ivory.set(64))
    truth = (*set64, "--shadows", "spheres", "--shadow-rays", 1024 if ivory.quick else 4096)
    print("| scene | option | time | NRMSE |\n|---|---|---|---|")
    for scene, reference, variants in (
            ("bunny_plane.glb", "ref_spheres.exr", [("--mask", m) for m in ("center", "inside", "touched")]),
            ("bunny_gloss.glb", "ref_gloss.exr", [("--threshold", t) for t in (0, 1e-4, 1e-3, 1e-2, 1e-1)] +
             [("--split", s) for s in (0, 1, 2, 3, 4)])):
        if not os.path.exists(ivory.path(reference)):
            ivory.render(scene, reference, *truth)
        for option, value in variants:
            seconds = ivory.render(scene, "option.exr", *set64, "--mask-depth", 5, option, value, repeats=5)
            print(f"| {scene} | {option} {value} | {1000 * seconds:.0f} ms | {100 * ivory.nrmse('option.exr', reference):.3f} % |",
                  flush=True)


def main():
    figures = {"products": products, "gaussians": gaussians, "spheres": spheres, "shadows": shadows, "rates": rates, "options": options}
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("figure", choices=[*figures, "all"])
    parser.add_argument("--ivory", default=os.path.join(ROOT, "build", "release", "ivory"))
    parser.add_argument("--work", default=os.path.join(ROOT, "out", "figures_lobes"))
    parser.add_argument("--quick", action="store_true", help="smaller pictures, fewer samples, for a look")
    arguments = parser.parse_args()
    ivory = Ivory(arguments.ivory, arguments.work, arguments.quick)
    for name, figure in figures.items():
        if arguments.figure in (name, "all"):
            figure(ivory)


if __name__ == "__main__":
    main()
