#!/usr/bin/env python3
"""Writes a level of a game as large as one: 200 x 200 x 30 m, 20 buildings of 3 rooms each, streets and towers.

usage: make_level.py OUT.glb [--rooms N]

60 furnished rooms (doors, windows, columns, a lamp panel in each ceiling), streets with columns along them, props,
solid towers up to 30 m, and a sun. A third of the buildings stand askew. The same bytes every time; --rooms makes a
smaller level of the same kind (a multiple of 3; streets shrink with it).
`ivory bake grid level.glb --voxel-size 0.25 --levels 4` is what it is for.
"""
import argparse
import math
import pathlib
import random

from writer.gltf import Gltf
from writer.shapes import Blocks, Piece, cylinder

SIDE_M = 200.0
LOT_M = 40.0  # streets included
WALL_M = 0.3


def building(rng):
    """Three rooms in a row along x, 21.6 x 8.6 m outside, about the origin, on y = 0."""
    blocks = Blocks()
    rooms, depth, height = (6.0, 8.4, 6.0), 8.0, 3.6
    length = sum(rooms) + 4 * WALL_M
    x0, z0 = -length / 2, -(depth / 2 + WALL_M)
    blocks.paint((x0, -0.2, z0), (x0 + length, height + WALL_M, -z0), "plaster")
    blocks.paint((x0 - 0.5, height + WALL_M, z0 - 0.5), (x0 + length + 0.5, height + WALL_M + 0.25, 0.5 - z0), "roof")
    x = x0 + WALL_M
    for i, width in enumerate(rooms):
        blocks.paint((x, 0.0, -depth / 2), (x + width, height, depth / 2), None)
        # The lamp is flush in the ceiling, the window looks to +z, the door opens to the next room or the street.
        blocks.paint((x + width / 2 - 0.6, height, -0.3), (x + width / 2 + 0.6, height + 0.1, 0.3), "lamp")
        blocks.paint((x + width / 2 - 1.2, 0.9, depth / 2), (x + width / 2 + 1.2, 2.3, depth / 2 + WALL_M), None)
        if i < 2:
            door = round(rng.uniform(-2.5, 1.5), 2)
            blocks.paint((x + width, 0.0, door), (x + width + WALL_M, 2.1, door + 1.0), None)
        if i != 1:
            blocks.paint((x + width / 2 - 0.5, 0.0, -depth / 2 - WALL_M), (x + width / 2 + 0.5, 2.1, -depth / 2), None)
        low = round(rng.uniform(0.4, width - 2.2), 2)
        blocks.paint((x + low, 0.0, depth / 2 - 0.6), (x + low + 1.5, 0.75, depth / 2), "wood")  # a bench
        low = round(rng.uniform(0.2, width - 1.2), 2)
        blocks.paint((x + low, 0.0, -1.0), (x + low + 1.0, round(rng.uniform(0.6, 1.9), 2), 0.1), rng.choice(("wood", "red")))
        x += width + WALL_M
    pieces = blocks.pieces()
    for z in (-2.0, 2.0):  # the middle room's columns, 1 cm into floor and ceiling
        for dx in (-2.5, 2.5):
            cylinder(pieces["plaster"], dx, z, 0.22, -0.01, height + 0.01, 20)
    return pieces


def crate(side):
    blocks = Blocks()
    blocks.paint((-side / 2, -0.05, -side / 2), (side / 2, side, side / 2), "wood")
    return blocks.pieces()


def tower(width, height):
    blocks = Blocks()
    blocks.paint((-width / 2, -0.2, -width / 2), (width / 2, height, width / 2), "plaster")
    return blocks.pieces()


def column():
    piece = Piece()
    cylinder(piece, 0.0, 0.0, 0.3, -0.05, 5.0, 20)
    return {"plaster": piece}


def turned(degrees):
    half = math.radians(degrees) / 2
    return [0.0, round(math.sin(half), 9), 0.0, round(math.cos(half), 9)]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("output", type=pathlib.Path)
    parser.add_argument("--rooms", type=int, default=60)
    arguments = parser.parse_args()
    rng = random.Random(7)
    lots = max(1, arguments.rooms // 3)
    across = math.ceil(math.sqrt(lots + 5)) if lots > 1 else 1
    side = min(SIDE_M, across * LOT_M)

    gltf = Gltf()
    materials = {"plaster": gltf.material("plaster", (0.7, 0.68, 0.62)), "roof": gltf.material("roof", (0.45, 0.2, 0.15)),
                 "wood": gltf.material("wood", (0.45, 0.3, 0.18)), "red": gltf.material("red", (0.6, 0.12, 0.1)),
                 "ground": gltf.material("ground", (0.35, 0.34, 0.32)),
                 "lamp": gltf.material("lamp", (0.75, 0.75, 0.75), (4000.0, 3800.0, 3400.0))}
    ground = Piece()
    h = side / 2
    ground.quad((-h, 0.0, h), (h, 0.0, h), (h, 0.0, -h), (-h, 0.0, -h))
    gltf.node("ground", mesh=gltf.mesh("ground", {"ground": ground}, materials))
    kinds = [gltf.mesh(f"building {i}", building(rng), materials) for i in range(4)]
    crates = [gltf.mesh(f"crate {i}", crate(0.6 + 0.3 * i), materials) for i in range(4)]
    pillar = gltf.mesh("column", column(), materials)

    places = [(i, j) for j in range(across) for i in range(across)]
    towers = set(places[3::5][: max(0, len(places) - lots)])
    built = 0
    for i, j in places:
        x, z = (i + 0.5) * side / across - h, (j + 0.5) * side / across - h
        if (i, j) in towers or built == lots:
            width, height = rng.choice((10.0, 13.0, 16.0)), rng.choice((12.0, 18.0, 24.0, 29.5))
            gltf.node(f"tower {i} {j}", mesh=gltf.mesh(f"tower {i} {j}", tower(width, height), materials),
                      translation=[round(x, 3), 0.0, round(z, 3)])
            continue
        askew = rng.choice((0, 0, 90, 17, 31))
        gltf.node(f"building {built}", mesh=kinds[built % 4], translation=[round(x, 3), 0.0, round(z, 3)],
                  rotation=turned(askew))
        built += 1
        for k in range(6):  # along the street before it
            gltf.node(f"column {i} {j} {k}", mesh=pillar,
                      translation=[round(x - 12.5 + 5.0 * k, 3), 0.0, round(z + 14.5, 3)])
        for k in range(8):
            gltf.node(f"crate {i} {j} {k}", mesh=rng.choice(crates), rotation=turned(rng.uniform(0, 90)),
                      translation=[round(x + rng.uniform(-16, 16), 3), 0.0, round(z - rng.uniform(13.5, 18), 3)])
    gltf.sun("sun", (-0.45, -0.8, -0.35), 60000.0)
    gltf.camera("street", (-h + 4.0, 2.2, h - 4.0), (0.0, 3.0, 0.0), 0.9)
    gltf.camera("room", (-9.6, 1.7, 3.4), (-6.0, 1.2, -2.0), 1.1)
    gltf.save(arguments.output)


if __name__ == "__main__":
    main()
