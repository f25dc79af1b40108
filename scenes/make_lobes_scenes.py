#!/usr/bin/env python3
"""Writes what `tools/figures_lobes.py` measures cosine lobes on: the Stanford bunny under a ball of light.

usage: make_lobes_scenes.py FOLDER [--bunny OBJ]

FOLDER gets bunny.glb (the mesh alone, for `ivory bake spheres`) and, with the same bunny standing on a plane,
bunny_plane.glb (matt plane, black bunny: only the plane's light is measured), bunny_gloss.glb (glossy plane) and
bunny_matt.glb (all matt, for self-shadows). The mesh comes from Debian's package glmark2-data and is no part of ivory.
"""
import argparse
import pathlib
import sys

import make_bunny_room
from gltf_writer import Gltf
from shapes import Piece

LIGHT = {"center": (1.4, 3.2, 1.0), "radius": 0.45, "radiance": (20.0, 20.0, 20.0)}
PLANE_M = 3.0  # half side


def plane():
    piece = Piece()
    s = PLANE_M
    piece.quad((-s, 0.0, s), (s, 0.0, s), (s, 0.0, -s), (-s, 0.0, -s))
    return piece


def scene(path, animal, plane_material, bunny_albedo):
    gltf = Gltf("Bunny: Stanford University Computer Graphics Laboratory")
    materials = {"plane": gltf.material("plane", (0.7, 0.7, 0.7)), "bunny": gltf.material("bunny", bunny_albedo)}
    gltf.root["materials"][materials["plane"]].update(plane_material)
    gltf.node("plane", mesh=gltf.mesh("plane", {"plane": plane()}, materials))
    gltf.node("bunny", mesh=gltf.mesh("bunny", {"bunny": animal}, materials))
    gltf.node("light", translation=list(LIGHT["center"]),
              extras={"ivory_sphere_light": {"radius": LIGHT["radius"], "radiance": list(LIGHT["radiance"])}})
    gltf.camera("high", (-1.6, 2.9, 2.6), (-0.35, 0.1, -0.25), 0.75)
    gltf.save(path)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--bunny", type=pathlib.Path, default=pathlib.Path("/usr/share/glmark2/models/bunny.obj"))
    options = parser.parse_args()
    if not options.bunny.is_file():
        sys.exit(f"{options.bunny}: no such file; install Debian's package glmark2-data, or name an OBJ with --bunny")
    options.folder.mkdir(parents=True, exist_ok=True)
    animal = make_bunny_room.bunny(options.bunny)

    gltf = Gltf("Bunny: Stanford University Computer Graphics Laboratory")
    gltf.node("bunny", mesh=gltf.mesh("bunny", {"grey": animal}, {"grey": gltf.material("grey", (0.7, 0.7, 0.7))}))
    gltf.save(options.folder / "bunny.glb")
    scene(options.folder / "bunny_plane.glb", animal, {}, (0.0, 0.0, 0.0))
    scene(options.folder / "bunny_matt.glb", animal, {}, (0.7, 0.7, 0.7))
    # Dark and glossy: KHR_materials_specular at full strength, metallic 0.5.
    scene(options.folder / "bunny_gloss.glb", animal,
          {"pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.5, 1.0], "metallicFactor": 0.6,
                                    "roughnessFactor": 0.35}, "extensions": {}}, (0.0, 0.0, 0.0))


if __name__ == "__main__":
    main()
