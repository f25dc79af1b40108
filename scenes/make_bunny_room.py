#!/usr/bin/env python3
"""Writes the room of room_boxes with the Stanford bunny in place of its furniture.

usage: make_bunny_room.py FOLDER [--rotate DEG] [--bunny OBJ]

FOLDER gets bunny_room.glb, bunny_room_points.csv (points on room and bunny, for `ivory probe`) and
bunny_room_bunny_points.csv (on the bunny alone). --rotate turns the whole scene about Y. The mesh
comes from Debian's package glmark2-data and is not part of ivory.
"""
import argparse
import pathlib
import sys

import make_scenes
from writer import shapes
from writer.gltf import Gltf
from writer.shapes import Blocks, Piece

HEIGHT_M = 1.4
SUNK_M = 0.018  # into the floor slab (2 cm), because the base of the mesh is uneven


def read_obj(path):
    """Positions and triangles; normals are averages weighted by area."""
    positions, faces = [], []
    for number, line in enumerate(path.read_text(encoding="ascii").splitlines(), 1):
        words = line.split()
        try:
            if words[:1] == ["v"]:
                positions.append(tuple(float(x) for x in words[1:4]))
            elif words[:1] == ["f"]:
                a, b, c = (int(w.split("/")[0]) - 1 for w in words[1:4])
                faces.append((a, b, c))
        except ValueError:
            sys.exit(f"{path}: line {number} is not a vertex or a triangle; give a triangulated OBJ file")
    if not faces or max(max(f) for f in faces) >= len(positions) or len(positions) > 65535:
        sys.exit(f"{path}: no mesh of at most 65535 vertices; give the bunny of Debian's package glmark2-data")
    return positions, faces


def bunny(path):
    positions, faces = read_obj(path)
    low, high = [min(c) for c in zip(*positions)], [max(c) for c in zip(*positions)]
    scale = HEIGHT_M / (high[1] - low[1])
    middle = ((low[0] + high[0]) / 2, low[1], (low[2] + high[2]) / 2)
    piece = Piece()
    piece.triangles = faces
    piece.positions = [(scale * (p[0] - middle[0]), scale * (p[1] - middle[1]) - SUNK_M, scale * (p[2] - middle[2]))
                       for p in positions]
    sums = [[0.0, 0.0, 0.0] for _ in positions]
    for a, b, c in faces:
        pa = piece.positions[a]
        n = shapes.cross(shapes.sub(piece.positions[b], pa), shapes.sub(piece.positions[c], pa))
        for i in (a, b, c):
            sums[i] = [x + y for x, y in zip(sums[i], n)]
    piece.normals = [shapes.unit(n) for n in sums]
    return piece


def lies_under(piece, p):
    """Is some triangle straight above p?"""
    for a, b, c in ([piece.positions[i] for i in triangle] for triangle in piece.triangles):
        edges = [(v[0] - u[0]) * (p[2] - u[2]) - (v[2] - u[2]) * (p[0] - u[0]) for u, v in ((b, c), (c, a), (a, b))]
        if all(e > 0 for e in edges) or all(e < 0 for e in edges):
            if sum(e * q[1] for e, q in zip(edges, (a, b, c))) / sum(edges) > p[1]:
                return True
    return False


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--rotate", type=float, default=0.0, metavar="DEG")
    parser.add_argument("--bunny", type=pathlib.Path, default=pathlib.Path("/usr/share/glmark2/models/bunny.obj"))
    options = parser.parse_args()
    if not options.bunny.is_file():
        sys.exit(f"{options.bunny}: no such file; install Debian's package glmark2-data, or name an OBJ with --bunny")
    options.folder.mkdir(parents=True, exist_ok=True)

    t, low, high = 0.02, (-2.5, 0.0, -2.0), (2.5, 2.8, 2.0)
    blocks = Blocks()
    blocks.paint(tuple(x - t for x in low), tuple(x + t for x in high), "grey")
    blocks.paint(low, high, None)
    room, animal = blocks.pieces(), {"grey": bunny(options.bunny)}

    gltf = Gltf("Bunny: Stanford University Computer Graphics Laboratory")
    quaternion, turn = make_scenes.rotation_about_y(options.rotate)
    turned = gltf.node("turned", rotation=quaternion)
    materials = {"grey": gltf.material("grey", (0.7, 0.7, 0.7))}
    gltf.node("room", turned, mesh=gltf.mesh("room", room, materials))
    gltf.node("bunny", turned, mesh=gltf.mesh("bunny", animal, materials))
    gltf.point_light("lamp", (0.9, 2.3, 0.8), 6.0, turned)
    gltf.camera("corner", (-1.6, 1.5, 1.8), (0.1, 0.6, 0.0), 1.0, turned)
    gltf.save(options.folder / "bunny_room.glb")

    def inside(center):
        return all(a <= x <= b for a, x, b in zip(low, center, high))

    def open_to_light(point):
        """Leaves out what the bunny stands on, and the hollow under its uneven base."""
        position, normal = point
        p = tuple(a + make_scenes.PROBE_OFFSET_M * b for a, b in zip(position, normal))
        return p[1] > 0.05 or max(abs(p[0]), abs(p[2])) > 1 or not lies_under(animal["grey"], p)

    for name, pieces, count in (("", {"room": room["grey"], "bunny": animal["grey"]}, 1200), ("_bunny", animal, 600)):
        points = make_scenes.sample_surface(pieces, count, inside)
        make_scenes.write_points(options.folder / f"bunny_room{name}_points.csv",
                                 [point for point in points if open_to_light(point)], turn)


if __name__ == "__main__":
    main()
