#!/usr/bin/env python3
"""Writes ivory's bundled scenes, the same bytes every time.

usage: make_scenes.py [FOLDER]      FOLDER defaults to the one this script lies in

README.md beside it says what each scene is for. All lengths in metres, light in candela and nits.
"""
import math
import pathlib
import random
import sys

from writer import cornell_spectra, shapes
from writer.files import write_file
from writer.gltf import Gltf
from writer.shapes import Blocks, Piece

PROBE_OFFSET_M = 0.001  # probe points float this far in front of their wall


def rotation_about_y(degrees):
    """glTF quaternion, and the same rotation as a function of a point."""
    half, angle = math.radians(degrees) / 2, math.radians(degrees)
    c, s = math.cos(angle), math.sin(angle)
    return ([0.0, round(math.sin(half), 9), 0.0, round(math.cos(half), 9)],
            lambda p: (c * p[0] + s * p[2], p[1], c * p[2] - s * p[0]))


def write_points(path, points, turn):
    """points: (position on a surface, its normal)."""
    lines = ["x,y,z,nx,ny,nz"]
    for p, n in points:
        offset = tuple(a + PROBE_OFFSET_M * b for a, b in zip(p, n))
        lines.append(",".join(f"{x + 0.0:.7g}" for x in (round(v, 7) for v in (*turn(offset), *turn(n)))))
    write_file(path, "\n".join(lines) + "\n")


def sample_surface(pieces, count, keep):
    """`count` points, uniform by area over the triangles whose centre and normal `keep` accepts."""
    triangles, areas = [], []
    for piece in pieces.values():
        for indices in piece.triangles:
            a, b, c = (piece.positions[i] for i in indices)
            n = shapes.cross(shapes.sub(b, a), shapes.sub(c, a))
            if keep(tuple((x + y + z) / 3 for x, y, z in zip(a, b, c))):
                triangles.append((a, b, c, shapes.unit(n)))
                areas.append(math.sqrt(shapes.dot(n, n)) / 2)
    rng, points, before, k = random.Random(1), [], 0.0, 0
    for i in range(count):  # stratified along the running sum of areas
        target = (i + rng.random()) / count * sum(areas)
        while before + areas[k] < target and k + 1 < len(areas):
            before += areas[k]
            k += 1
        a, b, c, n = triangles[k]
        root, v = math.sqrt(rng.random()), rng.random()
        weights = (1 - root, root * (1 - v), root * v)
        points.append((tuple(sum(w * q[axis] for w, q in zip(weights, (a, b, c))) for axis in range(3)), n))
    return points


def cornell_box(folder):
    """Published in millimetres, +Y up, camera along +Z, red to the left: right-handed as it is."""
    def mm(*p):
        return tuple(x / 1000 for x in p)

    inside = mm(278, 274, 280)
    pieces = {"white": Piece(), "green": Piece(), "red": Piece(), "lamp": Piece()}
    white = pieces["white"]
    floor = [mm(552.8, 0, 0), mm(0, 0, 0), mm(0, 0, 559.2), mm(549.6, 0, 559.2)]
    ceiling = [mm(556, 548.8, 0), mm(556, 548.8, 559.2), mm(0, 548.8, 559.2), mm(0, 548.8, 0)]
    lamp = [mm(343, 548.8, 227), mm(343, 548.8, 332), mm(213, 548.8, 332), mm(213, 548.8, 227)]
    white.quad_facing(floor, inside)
    for i in range(4):  # the ceiling around its hole, which the lamp fills
        j = (i + 1) % 4
        white.quad_facing([ceiling[i], ceiling[j], lamp[j], lamp[i]], inside)
    white.quad_facing([mm(549.6, 0, 559.2), mm(0, 0, 559.2), mm(0, 548.8, 559.2), mm(556, 548.8, 559.2)], inside)
    pieces["green"].quad_facing([mm(0, 0, 559.2), mm(0, 0, 0), mm(0, 548.8, 0), mm(0, 548.8, 559.2)], inside)
    pieces["red"].quad_facing([mm(552.8, 0, 0), mm(549.6, 0, 559.2), mm(556, 548.8, 559.2), mm(556, 548.8, 0)], inside)
    pieces["lamp"].quad_facing(lamp, inside)
    for height, base in ((165, ((130, 65), (82, 225), (240, 272), (290, 114))),
                         (330, ((423, 247), (265, 296), (314, 456), (472, 406)))):
        low, high = [mm(x, 0, z) for x, z in base], [mm(x, height, z) for x, z in base]
        middle = tuple(sum(c) / 8 for c in zip(*low, *high))
        white.quad_facing(high, middle, away=True)
        for i in range(4):
            j = (i + 1) % 4
            white.quad_facing([low[i], low[j], high[j], high[i]], middle, away=True)

    gltf = Gltf("Cornell box data: Cornell University Program of Computer Graphics")
    materials = {name: gltf.material(name, cornell_spectra.paint(table))
                 for name, table in (("white", cornell_spectra.WHITE), ("green", cornell_spectra.GREEN),
                                     ("red", cornell_spectra.RED))}
    materials["lamp"] = gltf.material("lamp", [cornell_spectra.LIGHT_REFLECTANCE] * 3, cornell_spectra.lamp())
    gltf.node("cornell box", mesh=gltf.mesh("cornell box", pieces, materials))
    # Film of 25 mm behind a lens of 35 mm focal length.
    eye = mm(278, 273, -800)
    gltf.camera("published", eye, (eye[0], eye[1], 0.0), 2 * math.atan(0.0125 / 0.035))
    gltf.save(folder / "cornell_box.gltf")


def two_rooms(folder):
    """After the two-room scene of RR-6983, figure 5: lit in the far room only."""
    blocks = Blocks()
    blocks.paint((-2.7, -0.2, -10.2), (2.7, 3.2, 5.2), "white")
    blocks.paint((-1.7, 0.0, -4.8), (-1.5, 2.7, -0.2), "red")
    blocks.paint((1.5, 0.0, -4.8), (1.7, 2.7, -0.2), "blue")
    blocks.paint((-2.5, 0.0, -10.2), (2.5, 3.0, -10.0), "orange")
    blocks.paint((-1.0, 3.0, -8.0), (1.0, 3.1, -6.0), "lamp")  # not through the roof
    blocks.paint((-2.5, 0.0, 0.0), (2.5, 3.0, 5.0), None)
    blocks.paint((-1.5, 0.0, -5.0), (1.5, 2.7, 0.0), None)
    blocks.paint((-2.5, 0.0, -10.0), (2.5, 3.0, -5.0), None)
    pieces = blocks.pieces()
    for z in (-0.9, -2.5, -4.1):
        for x in (-0.85, 0.85):  # the ends reach 1 cm into floor and ceiling
            shapes.cylinder(pieces["white"], x, z, 0.2, -0.01, 2.71, 32)

    gltf = Gltf()
    materials = {"white": gltf.material("white", (0.75, 0.75, 0.75)),
                 "red": gltf.material("red", (0.65, 0.12, 0.10)),
                 "blue": gltf.material("blue", (0.12, 0.20, 0.65)),
                 "orange": gltf.material("orange", (0.75, 0.45, 0.15)),
                 "lamp": gltf.material("lamp", (0.75, 0.75, 0.75), (60.0, 60.0, 60.0))}
    gltf.node("two rooms", mesh=gltf.mesh("two rooms", pieces, materials))
    gltf.camera("dark room", (1.5, 1.6, 4.4), (-0.2, 1.25, -1.5), 0.95)
    gltf.camera("lit room", (-2.1, 1.7, -9.6), (0.6, 1.1, -3.0), 0.9)
    gltf.save(folder / "two_rooms.gltf")


def lambert_room(path, blocks, degrees, light, cameras):
    """A scene of Blocks, all of albedo 0.7, under one point light, turned about Y as a whole."""
    gltf = Gltf()
    turned = gltf.node("turned", rotation=rotation_about_y(degrees)[0]) if degrees else None
    materials = {"grey": gltf.material("grey", (0.7, 0.7, 0.7))}
    gltf.node("room", turned, mesh=gltf.mesh("room", blocks.pieces(), materials))
    gltf.point_light("lamp", light[0], light[1], turned)
    for name, eye, target in cameras:
        gltf.camera(name, eye, target, 1.0, turned)
    gltf.save(path)


def leak_rooms(folder, name, degrees):
    """Two closed rooms of 4 x 3 x 3 m that share a wall of 2 cm; light in one of them."""
    t = 0.02
    blocks = Blocks()
    lit, dark = ((-4.0, 0.0, 0.0), (0.0, 3.0, 3.0)), ((t, 0.0, 0.0), (4.0 + t, 3.0, 3.0))
    blocks.paint((-4.0 - t, -t, -t), (4.0 + 2 * t, 3.0 + t, 3.0 + t), "grey")
    blocks.paint(*lit, None)
    blocks.paint(*dark, None)
    lambert_room(folder / f"{name}.gltf", blocks, degrees, ((-1.5, 2.0, 1.2), 5.0),
                 (("lit room", (-3.7, 1.6, 2.7), (-0.5, 1.3, 0.8)), ("dark room", (3.7, 1.6, 2.7), (0.5, 1.3, 0.8))))

    turn = rotation_about_y(degrees)[1]
    wall = [((t, 3.0 * (j + 0.5) / 16, 3.0 * (k + 0.5) / 16), (1.0, 0.0, 0.0)) for j in range(16) for k in range(16)]
    write_points(folder / f"{name}_dark_points.csv", wall, turn)
    write_points(folder / f"{name}_lit_points.csv",
                 sample_surface(blocks.pieces(), 256,
                                lambda c: all(l <= x <= h for l, x, h in zip(lit[0], c, lit[1]))), turn)


def room_boxes(folder, name, degrees):
    """A closed furnished room of 5 x 2.8 x 4 m."""
    t = 0.02
    low, high = (-2.5, 0.0, -2.0), (2.5, 2.8, 2.0)
    blocks = Blocks()
    blocks.paint(tuple(x - t for x in low), tuple(x + t for x in high), "grey")
    blocks.paint(low, high, None)
    blocks.paint((-1.7, 0.0, -1.3), (-1.0, 1.8, -0.6), "grey")
    blocks.paint((0.9, 0.0, 0.5), (1.7, 0.6, 1.3), "grey")
    blocks.paint((-0.2, 0.70, -1.4), (1.3, 0.75, -0.6), "grey")
    for x in (-0.2, 1.24):
        for z in (-1.4, -0.66):
            blocks.paint((x, 0.0, z), (x + 0.06, 0.70, z + 0.06), "grey")
    lambert_room(folder / f"{name}.gltf", blocks, degrees, ((0.2, 2.3, 0.1), 6.0),
                 (("corner", (-2.3, 1.7, 1.8), (0.3, 0.8, -0.6)),))
    write_points(folder / f"{name}_points.csv",
                 sample_surface(blocks.pieces(), 1200,
                                lambda c: all(l <= x <= h for l, x, h in zip(low, c, high))),
                 rotation_about_y(degrees)[1])


def integrating_sphere(folder):
    gltf = Gltf()
    pieces = {"wall": shapes.inward_sphere(4)}
    gltf.node("sphere", mesh=gltf.mesh("sphere", pieces, {"wall": gltf.material("wall", (0.5, 0.5, 0.5))}))
    gltf.point_light("lamp", (0.0, 0.0, 0.0), 1.0)
    gltf.camera("inside", (0.0, 0.0, 0.5), (0.0, 0.0, -1.0), 1.0)
    gltf.save(folder / "integrating_sphere.glb")


def furnace_box(folder):
    gltf = Gltf()
    wall = Piece()
    shapes.inward_box(wall, (-1.0, -1.0, -1.0), (1.0, 1.0, 1.0))
    materials = {"wall": gltf.material("wall", (0.5, 0.5, 0.5), (1.0, 1.0, 1.0))}
    gltf.node("furnace", mesh=gltf.mesh("furnace", {"wall": wall}, materials))
    gltf.camera("inside", (0.2, 0.1, 0.8), (-0.1, 0.0, -1.0), 1.0)
    gltf.save(folder / "furnace_box.gltf")


def detail(folder, name, along, around, relief):
    """A closed room with an embossed knot on a pedestal; the two files differ in the knot alone."""
    blocks = Blocks()
    blocks.paint((-2.2, -0.2, -2.2), (2.2, 3.2, 2.2), "white")
    blocks.paint((-2.2, 0.0, -2.0), (-2.0, 3.0, 2.0), "red")
    blocks.paint((2.0, 0.0, -2.0), (2.2, 3.0, 2.0), "green")
    blocks.paint((-0.2, 3.0, -0.5), (0.8, 3.1, 0.5), "lamp")
    blocks.paint((-2.0, 0.0, -2.0), (2.0, 3.0, 2.0), None)
    blocks.paint((-0.8, 0.0, -0.8), (0.8, 0.5, 0.8), "white")
    knot = {"white": shapes.torus_knot(along, around, relief)}

    gltf = Gltf()
    materials = {"white": gltf.material("white", (0.75, 0.75, 0.75)),
                 "red": gltf.material("red", (0.60, 0.15, 0.12)),
                 "green": gltf.material("green", (0.15, 0.50, 0.18)),
                 "lamp": gltf.material("lamp", (0.75, 0.75, 0.75), (20.0, 20.0, 20.0))}
    gltf.node("room", mesh=gltf.mesh("room", blocks.pieces(), materials))
    gltf.node("knot", mesh=gltf.mesh("knot", knot, materials, quantize_scale=1.0), translation=[0.0, 0.95, 0.0])
    gltf.camera("front", (0.5, 1.9, 1.9), (0.0, 0.85, 0.0), 0.9)
    gltf.save(folder / f"{name}.glb")


def plaza(folder):
    """A floor under the open sky, for objects that move on it."""
    floor = Piece()
    floor.positions = [(-4.0, 0.0, -4.0), (-4.0, 0.0, 4.0), (4.0, 0.0, 4.0), (4.0, 0.0, -4.0)]
    floor.triangles = [(0, 1, 2), (0, 2, 3)]
    gltf = Gltf()
    gltf.node("floor", mesh=gltf.mesh("floor", {"stone": floor}, {"stone": gltf.material("stone", (0.6, 0.58, 0.55))}))
    gltf.camera("visitor", (1.2, 2.6, 5.2), (0.0, 0.35, 0.0), 0.75)
    gltf.save(folder / "plaza.gltf")


def knot(folder):
    """The embossed torus knot alone, standing on the ground."""
    gltf = Gltf()
    pieces = {"clay": shapes.torus_knot(200, 24, True)}
    gltf.node("knot", mesh=gltf.mesh("knot", pieces, {"clay": gltf.material("clay", (0.7, 0.55, 0.45))}, quantize_scale=1.0),
              translation=[0.0, 0.45, 0.0])
    gltf.save(folder / "knot.glb")


def crowd(folder):
    """Forty knots on a wide floor, of three sizes, every fifth in the air: shadows of many upon each other."""
    floor = Piece()
    floor.positions = [(-12.0, 0.0, -12.0), (-12.0, 0.0, 12.0), (12.0, 0.0, 12.0), (12.0, 0.0, -12.0)]
    floor.triangles = [(0, 1, 2), (0, 2, 3)]
    gltf = Gltf()
    gltf.node("floor", mesh=gltf.mesh("floor", {"stone": floor}, {"stone": gltf.material("stone", (0.6, 0.58, 0.55))}))
    clay = {"clay": gltf.material("clay", (0.7, 0.55, 0.45))}
    mesh = gltf.mesh("knot", {"clay": shapes.torus_knot(200, 24, True)}, clay, quantize_scale=1.0)
    for i in range(40):
        # Vogel's spiral: every knot has the same room.
        angle = 2.399963 * i
        reach = 0.98 * math.sqrt(i + 0.5)
        size = (0.75, 0.6, 0.9)[i % 3]
        height = 0.45 * size + (0.7 if i % 5 == 4 else 0.0)
        place = [reach * math.cos(angle), height, reach * math.sin(angle)]
        gltf.node(f"knot_{i + 1}", mesh=mesh, translation=[round(x, 4) for x in place], scale=[size] * 3,
                  extras={"ivory_occluder": "knot.exr"})
    gltf.camera("visitor", (1.6, 7.6, 12.0), (0.1, 0.0, 0.4), 0.75)
    gltf.save(folder / "crowd.glb")


def sky(folder):
    """Lat-long map, 128 x 64: blue above, a low warm sun of 6 degrees radius, grey ground. Radiance in nits as RGBE."""
    width, height = 128, 64
    sun = (-0.62, 0.6, 0.5)
    sun = [x / math.sqrt(sum(y * y for y in sun)) for x in sun]
    data = bytearray()
    for row in range(height):
        theta = math.pi * (row + 0.5) / height
        for column in range(width):
            phi = 2 * math.pi * ((column + 0.5) / width - 0.5)
            w = (-math.sin(theta) * math.sin(phi), math.cos(theta), math.sin(theta) * math.cos(phi))
            up = max(w[1], 0.0)
            color = [a + (b - a) * up for a, b in zip((0.9, 0.95, 1.0), (0.3, 0.45, 0.8))] if w[1] > 0 else [0.2, 0.18, 0.16]
            angle = math.degrees(math.acos(min(1.0, sum(a * b for a, b in zip(w, sun)))))
            share = min(1.0, max(0.0, (7.0 - angle) / 2.0))
            color = [c + share * s for c, s in zip(color, (70.0, 60.0, 45.0))]
            exponent = math.frexp(max(color))[1]
            data += bytes(int(c * 2.0 ** (8 - exponent)) for c in color) + bytes([exponent + 128])
    write_file(folder / "sky.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n" % (height, width) + bytes(data))


def main(arguments):
    if len(arguments) > 2 or (len(arguments) == 2 and arguments[1].startswith("-")):
        sys.exit(__doc__)
    folder = pathlib.Path(arguments[1] if len(arguments) == 2 else __file__)
    folder = folder if len(arguments) == 2 else folder.resolve().parent
    folder.mkdir(parents=True, exist_ok=True)
    cornell_box(folder)
    two_rooms(folder)
    leak_rooms(folder, "leak_axis", 0)
    leak_rooms(folder, "leak_rotated", 30)
    room_boxes(folder, "room_boxes", 0)
    room_boxes(folder, "room_boxes_rotated", 30)
    integrating_sphere(folder)
    furnace_box(folder)
    detail(folder, "detail_low", 100, 15, relief=False)
    detail(folder, "detail_high", 500, 50, relief=True)
    plaza(folder)
    knot(folder)
    crowd(folder)
    sky(folder)


if __name__ == "__main__":
    main(sys.argv)
