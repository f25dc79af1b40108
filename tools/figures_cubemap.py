#!/usr/bin/env python3
"""Measures localized cube maps and draws them, with the ivory binary alone.

    tools/figures_cubemap.py wall | points   [--ivory PATH] [--work FOLDER] [--quick]

wall: a ball on its way from the middle of a coloured box to its wall, at five places; Markdown rows of NRMSE and worst
pixel over the ball's pixels against path tracing, by how the map is read, and a picture (ball_at_the_wall_*.png).

points: E at random points with random normals in whole rooms, by texels, by how the map is read and by how its shell is
placed; RMS error over mean E, then the worst over mean E.

The references' own noise is left out as in tools/figures.py.
"""
import argparse
import csv
import math
import os
import pathlib
import random
import struct
import subprocess
import sys

import numpy

import figures

sys.path.insert(0, os.path.join(figures.ROOT, "scenes"))
import shapes  # noqa: E402
from gltf_writer import Gltf  # noqa: E402

RADIUS_M = 0.25
PLACES_M = (0.0, 0.25, 0.45, 0.6, 0.74)  # along -x from the middle; the wall is at 1
BESIDE = (0.22, -0.38)  # y and z of the way: a texel of the 4x4 map has its centre beside it, on the camera's side
LOOKUPS = ("convolved", "point", "polygon_paper", "polygon")
SIZE = 96


def ball():
    """A smooth sphere with its normals."""
    piece = shapes.inward_sphere(4)
    unit = [shapes.unit(p) for p in piece.positions]
    piece.positions = [tuple(RADIUS_M * x for x in n) for n in unit]
    piece.normals = unit
    piece.triangles = [(a, c, b) for a, b, c in piece.triangles]
    return piece


def write_scenes(folder):
    """The box, lit by a point light and by a lamp, with a camera for each place of the ball, and the ball."""
    walls = {"red": ((0, 4, 6, 2), (0.75, 0.1, 0.1)), "green": ((1, 3, 7, 5), (0.1, 0.65, 0.15)),
             "blue": ((0, 2, 3, 1), (0.15, 0.2, 0.7)), "yellow": ((4, 5, 7, 6), (0.7, 0.6, 0.1)),
             "floor": ((0, 1, 5, 4), (0.7, 0.7, 0.7)), "ceiling": ((2, 6, 7, 3), (0.7, 0.7, 0.7))}
    corner = [(-1.0 + 2 * (i & 1), -1.0 + (i & 2), -1.0 + (i & 4) / 2) for i in range(8)]
    for light in ("point", "lamp"):
        gltf, pieces, materials = Gltf(), {}, {}
        for name, (corners, albedo) in walls.items():
            pieces[name] = shapes.Piece()
            pieces[name].quad_facing([corner[i] for i in corners], (0.0, 0.0, 0.0))
            materials[name] = gltf.material(name, albedo)
        if light == "lamp":
            pieces["lamp"] = shapes.Piece()
            pieces["lamp"].quad_facing([(-0.3, 0.999, -0.3), (0.3, 0.999, -0.3), (0.3, 0.999, 0.3), (-0.3, 0.999, 0.3)],
                                       (0.0, 0.0, 0.0))
            materials["lamp"] = gltf.material("lamp", (0.0, 0.0, 0.0), (10.0, 10.0, 10.0))
        gltf.node("box", mesh=gltf.mesh("box", pieces, materials))
        if light == "point":
            gltf.point_light("point", (0.3, 0.7, 0.2), 3.0)
        for i, x in enumerate(PLACES_M):
            gltf.camera(f"{i}", (-1.16 * x, BESIDE[0], 0.95), (-x, *BESIDE), 2 * math.atan(1.15 * RADIUS_M / 1.1))
        gltf.save(folder / f"box_{light}.gltf")
    gltf = Gltf()
    gltf.node("ball", mesh=gltf.mesh("ball", {"white": ball()}, {"white": gltf.material("white", (0.8, 0.8, 0.8))}))
    gltf.save(folder / "ball.glb")


def pixels(path):
    """height x width x RGB. Uncompressed, an OpenEXR file ends in its rows: number, size, then B, G and R."""
    plain = path + ".plain.exr"
    subprocess.run(["oiiotool", path, "--ch", "R,G,B", "-d", "float", "--compression", "none", "-o", plain], check=True)
    data = pathlib.Path(plain).read_bytes()
    os.remove(plain)
    rows = []
    row = 8 + 12 * SIZE
    for y in range(SIZE):
        start = len(data) - (SIZE - y) * row
        assert struct.unpack_from("<ii", data, start) == (y, 12 * SIZE)
        rows.append(numpy.frombuffer(data, "<f4", 3 * SIZE, start + 8).reshape(3, SIZE)[::-1].T)
    return numpy.array(rows, dtype=float)


def within(mask):
    """Pixels whose neighbours belong to the mask too: a silhouette's pixels differ by their samples' places."""
    padded = numpy.pad(mask, 1)
    height, width = mask.shape
    return numpy.logical_and.reduce([padded[y:y + height, x:x + width] for y in range(3) for x in range(3)])


def wall(ivory, quick):
    folder = pathlib.Path(ivory.work)
    write_scenes(folder)
    samples = 64 if quick else 512
    for light in ("point", "lamp"):
        scene = str(folder / f"box_{light}.gltf")
        print(f"\nLit by a {light}:\n\n| texels | distance to the wall | " + " | ".join(LOOKUPS) + " |\n|---|---|" + "---|" * len(LOOKUPS))
        maps = {}
        for texels in (2, 4, 8):
            maps[texels] = ivory.path(f"{light}_{texels}.exr")
            ivory.run("bake", "cubemap", scene, "--at", "0,0,0", "--size", texels, "-o", maps[texels], "--force",
                      *(["--capture", 64] if quick else []))
        truths, masks = [], []

        def render(i, name, *options):
            image = ivory.path(f"{name}.exr")
            ivory.run("render", scene, "-o", image, "--force", "--camera", i, "--size", f"{SIZE}x{SIZE}", "--object",
                      f"{folder / 'ball.glb'}@{-PLACES_M[i]},{BESIDE[0]},{BESIDE[1]}", *options)
            return pixels(image)

        for i in range(len(PLACES_M)):
            truths.append([render(i, "truth", "--method", "path", "--samples", samples, "--seed", s) for s in (101, 102)])
            # Everything else is drawn from the same random numbers, whatever lights the ball.
            black = render(i, "mask", "--method", "cubemap", "--cubemap", maps[2], "--samples", 1)
            other = render(i, "mask", "--method", "cubemap", "--cubemap", maps[8], "--samples", 1)
            masks.append(within((black != other).any(axis=2)))
        strips = {}
        for texels in (2, 4, 8):
            for i, x in enumerate(PLACES_M):
                a, b = (t[masks[i]] for t in truths[i])
                mean, between = (a + b) / 2, numpy.mean((a - b) ** 2)
                cells = []
                for lookup in LOOKUPS:
                    image = render(i, "image", "--method", "cubemap", "--cubemap", maps[texels], "--lookup", lookup,
                                   "--samples", 16)
                    strips.setdefault((texels, lookup), []).append(image)
                    own = image[masks[i]]
                    mse = (numpy.mean((own - a) ** 2) + numpy.mean((own - b) ** 2) - between) / 2
                    nrmse = math.sqrt(max(0.0, mse)) / (mean.max() - mean.min())
                    worst = numpy.abs(own - mean).max() / mean.max()
                    cells.append(f"{nrmse:.3f}, worst {worst:.2f}, max {own.max() / mean.max():.2f}")
                print(f"| {texels} | {1 - x - RADIUS_M:.2f} m | {' | '.join(cells)} |", flush=True)
        draw(folder / f"ball_at_the_wall_{light}.png", strips, [t[0] for t in truths])


def draw(path, strips, truths):
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    rows = [(f"{lookup}, {texels}x{texels}", strips[texels, lookup])
            for texels, lookup in ((4, "convolved"), (4, "point"), (4, "polygon"))]
    rows.append(("path traced", truths))
    figure, axes = pyplot.subplots(len(rows), len(PLACES_M), figsize=(2 * len(PLACES_M), 2 * len(rows)))
    scale = 0.8 / numpy.percentile(numpy.array(truths), 99)
    for (name, images), line in zip(rows, axes):
        for x, image, panel in zip(PLACES_M, images, line):
            panel.imshow(numpy.clip(image * scale, 0, 1) ** (1 / 2.2), interpolation="nearest")
            panel.set_xticks([])
            panel.set_yticks([])
            if name == rows[0][0]:
                panel.set_title(f"{1 - x - RADIUS_M:.2f} m", fontsize=9)
        line[0].set_ylabel(name, fontsize=9)
    figure.tight_layout(pad=0.3)
    figure.savefig(path, dpi=110)
    pyplot.close(figure)
    print(f"wrote {path}", file=sys.stderr)


def write_clutter(path):
    """A room full of small boxes, but for the middle."""
    rng = random.Random(3)
    gltf, room, boxes = Gltf(), shapes.Piece(), shapes.Piece()
    shapes.inward_box(room, (-2.5, 0.0, -2.0), (2.5, 2.8, 2.0))
    for _ in range(250):
        center = [rng.uniform(-2.4, 2.4), rng.uniform(0.1, 2.7), rng.uniform(-1.9, 1.9)]
        half = [rng.choice((0.01, 0.05, 0.15)) for _ in range(3)]
        low, high = [c - h for c, h in zip(center, half)], [c + h for c, h in zip(center, half)]
        if all(a - 0.35 < x < b + 0.35 for a, x, b in zip(low, (0.1, 1.3, 0.2), high)):
            continue
        corner = [(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
        for side in ((0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5)):
            boxes.quad_facing([corner[i] for i in side], center, away=True)
    materials = {"room": gltf.material("room", (0.6, 0.6, 0.6)), "boxes": gltf.material("boxes", (0.6, 0.3, 0.2))}
    gltf.node("clutter", mesh=gltf.mesh("clutter", {"room": room, "boxes": boxes}, materials))
    gltf.point_light("point", (-1.0, 2.5, 0.5), 5.0)
    gltf.save(path)


def write_points(path, low, high, count):
    rng = random.Random(1)
    with open(path, "w", encoding="ascii") as file:
        file.write("x,y,z,nx,ny,nz\n")
        for _ in range(count):
            row = [rng.uniform(a, b) for a, b in zip(low, high)] + [rng.gauss(0, 1) for _ in range(3)]
            file.write(",".join(f"{x:.6g}" for x in row) + "\n")


def points(ivory, quick):
    folder = pathlib.Path(ivory.work)
    write_scenes(folder)
    write_clutter(folder / "clutter.gltf")
    # A scene, the reference point, a box free of surfaces, and whether punctual lights, which no map holds, light it.
    cases = ((folder / "box_point.gltf", "0.25,-0.1,0.3", ((-0.98,) * 3, (0.98,) * 3), True),
             (figures.scene_path("room_boxes"), "0.1,1.6,0.2", ((-2.4, 1.85, -1.9), (2.4, 2.7, 1.9)), True),
             (figures.scene_path("two_rooms"), "0.3,1.5,-7.5", ((-2.4, 0.1, -9.9), (2.4, 2.9, -5.1)), False),
             (figures.scene_path("cornell_box"), "0.28,0.40,0.28", ((0.02, 0.36, 0.02), (0.53, 0.5, 0.53)), False),
             (folder / "clutter.gltf", "0.1,1.3,0.2", ((-0.25, 0.95, -0.15), (0.45, 1.65, 0.55)), True))
    columns = [("fitted", lookup) for lookup in LOOKUPS] + [("corners", "polygon"), ("averaged", "polygon")]
    print("| scene | texels | " + " | ".join(f"{lookup}, {shell}" for shell, lookup in columns) + " |\n|---|---|" +
          "---|" * len(columns))

    def read(name):
        with open(name, newline="", encoding="ascii") as file:
            rows = list(csv.DictReader(file))
        return [numpy.array([[float(row[c + end]) for c in "rgb"] for row in rows]) for end in ("", "_se")]

    for scene, at, box, punctual in cases:
        table, out, cube = (ivory.path(name) for name in ("points.csv", "e.csv", "points.exr"))
        write_points(table, *box, 100 if quick else 400)
        ivory.run("probe", scene, "--points", table, "-o", out, "--force", "--samples", "1k" if quick else "8k",
                  *(["--indirect-only"] if punctual else []))
        truth, noise = read(out)
        for texels in (2, 4, 8):
            cells, baked = [], None
            for shell, lookup in columns:
                if shell != baked:
                    ivory.run("bake", "cubemap", scene, "--at", at, "--size", texels, "--shell", shell, "--capture", 64,
                              "--samples", 16 if quick else 64, "-o", cube, "--force")
                    baked = shell
                ivory.run("probe", cube, "--points", table, "-o", out, "--force", "--lookup", lookup)
                e, _ = read(out)
                rms = math.sqrt(max(0.0, numpy.mean((e - truth) ** 2) - numpy.mean(noise ** 2)))
                cells.append(f"{rms / truth.mean():.3f}, {numpy.abs(e - truth).max() / truth.mean():.1f}")
            print(f"| {pathlib.Path(scene).stem} | {texels} | {' | '.join(cells)} |", flush=True)


def main():
    choices = {"wall": wall, "points": points}
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("figure", choices=choices)
    parser.add_argument("--ivory", default=os.path.join(figures.ROOT, "build", "release", "ivory"))
    parser.add_argument("--work", default=os.path.join(figures.ROOT, "out", "figures"))
    parser.add_argument("--quick", action="store_true", help="fewer samples, for a look")
    arguments = parser.parse_args()
    choices[arguments.figure](figures.Ivory(arguments.ivory, arguments.work), arguments.quick)


if __name__ == "__main__":
    main()
