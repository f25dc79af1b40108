#!/usr/bin/env python3
"""Measures the figures that README.md states, with the ivory binary and the bundled scenes alone.

    tools/figures.py leak | rooms | cornell | robustness | time   [--ivory PATH] [--work FOLDER] [--quick]

Each prints Markdown rows. Errors against path-traced references leave the references' own noise out: with two
independent references A and B, (MSE(X,A) + MSE(X,B) - MSE(A,B)) / 2 is the mean square error of X itself.
"""
import argparse
import csv
import json
import math
import os
import subprocess
import sys
import time

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
SCENES = os.path.join(ROOT, "scenes")


class Ivory:
    def __init__(self, binary, work):
        self.binary = binary
        self.work = work
        os.makedirs(work, exist_ok=True)

    def path(self, name):
        return os.path.join(self.work, name)

    def run(self, *arguments):
        """Runs a command; returns its JSON result and the seconds that it took."""
        start = time.monotonic()
        done = subprocess.run([self.binary, *map(str, arguments), "--json"], capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(done.stderr.strip())
        return (json.loads(done.stdout) if done.stdout.strip() else {}), time.monotonic() - start

    def bake(self, scene, long_side, out, *options):
        info, _ = self.run("info", scene)
        extent = max(high - low for low, high in zip(info["bounds_min_m"], info["bounds_max_m"]))
        return self.run("bake", "grid", scene, "-o", out, "--force", "--voxel-size", 1.00001 * extent / long_side,
                        *options)[1]

    def probe(self, source, points, *options):
        out = self.path("probe.csv")
        self.run("probe", source, "--points", points, "-o", out, "--force", *options)
        with open(out, newline="") as file:
            return [(float(row["r"]), float(row["r_se"])) for row in csv.DictReader(file)]

    def mse(self, image, reference):
        result, _ = self.run("compare", image, reference)
        return result["rmse"] ** 2


def scene_path(name):
    for extension in (".gltf", ".glb"):
        path = os.path.join(SCENES, name + extension)
        if os.path.exists(path):
            return path
    sys.exit(f"no scene {name}")


def leak(ivory, quick):
    """Mean E on the dark side of a 2 cm wall over mean E in the lit room."""
    print("| scene | vertices | basis | off | planes | rays |\n|---|---|---|---|---|---|")
    for name in ("leak_axis", "leak_rotated"):
        scene = scene_path(name)
        for long_side in (16, 32):
            for basis in ("vectors", "sh9", "ambient_cube"):
                cells = []
                for guard in ("off", "planes", "rays"):
                    grid = ivory.path("leak.vdb")
                    ivory.bake(scene, long_side, grid, "--photons", "200k" if quick else "2m", "--basis", basis,
                               "--guard", "off" if guard == "off" else "rays")
                    mean = {}
                    for side in ("dark", "lit"):
                        points = os.path.join(SCENES, f"{name}_{side}_points.csv")
                        scene_option = ["--scene", scene] if guard == "rays" else []
                        e = ivory.probe(grid, points, "--guard", guard, *scene_option)
                        mean[side] = sum(v for v, _ in e) / len(e)
                    cells.append(f"{100 * mean['dark'] / mean['lit']:.3f} %")
                print(f"| {name} | {long_side} | {basis} | {' | '.join(cells)} |", flush=True)


def rooms(ivory, quick):
    """NRMSE of indirect E over surface points against path-traced truth."""
    print("| scene | vertices | off | planes | rays |\n|---|---|---|---|---|")
    inputs = [(scene_path(n), os.path.join(SCENES, n + "_points.csv")) for n in ("room_boxes", "room_boxes_rotated")]
    for scene, points in inputs:
        truth = ivory.probe(scene, points, "--indirect-only", "--samples", "1k" if quick else "16k")
        noise = sum(se ** 2 for _, se in truth) / len(truth)
        spread = max(e for e, _ in truth) - min(e for e, _ in truth)
        for long_side, photons in ((16, "2m"), (32, "8m"), (64, "64m")):
            if quick and long_side == 64:
                continue
            cells = []
            for guard in ("off", "planes", "rays"):
                grid = ivory.path("room.vdb")
                if guard != "rays":  # planes and rays read the same file
                    ivory.bake(scene, long_side, grid, "--photons", photons, "--guard",
                               "off" if guard == "off" else "rays")
                scene_option = ["--scene", scene] if guard == "rays" else []
                e = ivory.probe(grid, points, "--guard", guard, *scene_option)
                mse = sum((a - b) ** 2 for (a, _), (b, _) in zip(e, truth)) / len(truth)
                cells.append(f"{math.sqrt(max(0.0, mse - noise)) / spread:.4f}")
            name = os.path.splitext(os.path.basename(scene))[0]
            print(f"| {name} | {long_side} | {' | '.join(cells)} |", flush=True)


def references(ivory, scene, size, samples):
    """Two independent path-traced references of the indirect light."""
    paths = [ivory.path(f"reference_{seed}.exr") for seed in (101, 102)]
    for seed, path in zip((101, 102), paths):
        ivory.run("render", scene, "-o", path, "--force", "--method", "path", "--samples", samples, "--size", size,
                  "--seed", seed, "--indirect-only")
    return paths, ivory.mse(*paths)


def error(ivory, image, refs, between):
    return math.sqrt(max(0.0, (ivory.mse(image, refs[0]) + ivory.mse(image, refs[1]) - between) / 2))


def value_range(ivory, image):
    """max - min of an image, from what compare divides by."""
    result, _ = ivory.run("compare", ivory.path("reference_101.exr"), image)
    return result["rmse"] / result["nrmse"]


def cornell(ivory, quick):
    """Indirect NRMSE of direct and gather against path on the Cornell box, 32^3 vertices, 8 M photons."""
    scene, grid, size = scene_path("cornell_box"), ivory.path("cornell.vdb"), "160x120"
    ivory.run("bake", "grid", scene, "-o", grid, "--force", "--resolution", "32,32,32", "--photons", "8m")
    refs, between = references(ivory, scene, size, "512" if quick else "4k")
    for method, options in (("direct", ["--samples", "64"]), ("gather", ["--samples", "16", "--gather", "256"])):
        image = ivory.path(method + ".exr")
        ivory.run("render", scene, "-o", image, "--force", "--method", method, "--grid", grid, "--size", size,
                  "--indirect-only", *options)
        print(f"| Cornell box, `{method}` | {100 * error(ivory, image, refs, between) / value_range(ivory, image):.2f} % |",
              flush=True)


def robustness(ivory, quick):
    """Baked on the low mesh against baked on the high one, both rendered on the high one."""
    del quick
    for interpolation in ("trilinear", "tricubic"):
        images = []
        for detail in ("low", "high"):
            grid, image = ivory.path(f"{detail}.vdb"), ivory.path(f"{detail}.exr")
            ivory.run("bake", "grid", scene_path(f"detail_{detail}"), "-o", grid, "--force", "--resolution", "20,22,20",
                      "--photons", "8m")
            ivory.run("render", scene_path("detail_high"), "-o", image, "--force", "--method", "direct", "--grid", grid,
                      "--samples", "16", "--size", "320x240", "--interpolation", interpolation)
            images.append(image)
        result, _ = ivory.run("compare", *images)
        spread = result["rmse"] / result["nrmse"]
        print(f"| {interpolation} | max {100 * result['max'] / spread:.2f} % | NRMSE {100 * result['nrmse']:.3f} % |",
              flush=True)


def time_to_error(ivory, quick):
    """Seconds for direct, bake included, over seconds for path to reach the same indirect NRMSE."""
    size = "320x240" if quick else "640x480"
    print("| scene | grid, photons | direct: bake + render | NRMSE | path to the same | ratio |\n|---|---|---|---|---|---|")
    for name in ("cornell_box", "two_rooms"):
        scene = scene_path(name)
        refs, between = references(ivory, scene, size, 128 if quick else 512)
        # A path tracer's error falls with the square root of its time: one measurement tells all.
        path_image = ivory.path("path.exr")
        _, path_s = ivory.run("render", scene, "-o", path_image, "--force", "--method", "path", "--samples", 64,
                              "--size", size, "--seed", 7, "--indirect-only")
        path_error = error(ivory, path_image, refs, between)
        for long_side, photons in ((16, "500k"), (32, "2m"), (32, "8m")):
            grid, image = ivory.path("time.vdb"), ivory.path("time.exr")
            bake_s = ivory.bake(scene, long_side, grid, "--photons", photons)
            _, render_s = ivory.run("render", scene, "-o", image, "--force", "--method", "direct", "--grid", grid,
                                    "--samples", 4, "--size", size, "--indirect-only")
            e = error(ivory, image, refs, between)
            same_s = path_s * (path_error / e) ** 2
            print(f"| {name} | {long_side}, {photons} | {bake_s:.1f} + {render_s:.1f} s | "
                  f"{100 * e / value_range(ivory, image):.2f} % | {same_s:.0f} s | {same_s / (bake_s + render_s):.1f} |",
                  flush=True)


def main():
    figures = {"leak": leak, "rooms": rooms, "cornell": cornell, "robustness": robustness, "time": time_to_error}
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("figure", choices=figures)
    parser.add_argument("--ivory", default=os.path.join(ROOT, "build", "release", "ivory"))
    parser.add_argument("--work", default=os.path.join(ROOT, "out", "figures"))
    parser.add_argument("--quick", action="store_true", help="fewer samples, for a look")
    arguments = parser.parse_args()
    figures[arguments.figure](Ivory(arguments.ivory, arguments.work), arguments.quick)


if __name__ == "__main__":
    main()
