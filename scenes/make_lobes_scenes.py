#!/usr/bin/env python3
"""Writes what `ivory chart` measures cosine lobes on: the Stanford bunny under a spherical light.

usage: make_lobes_scenes.py FOLDER [--bunny OBJ]

FOLDER gets bunny.glb (the mesh alone, for `ivory bake spheres`) and, with the same bunny standing on a plane,
bunny_plane.glb (matt plane) and bunny_gloss.glb (glossy plane). There the bunny is black, so that only the plane's light is
measured. The mesh comes from Debian's package glmark2-data and is not part of ivory.
"""
import argparse
import pathlib
import sys

import make_bunny_room
from writer.gltf import Gltf
from writer.shapes import Piece

LIGHT = {"center": (1.4, 3.2, 1.0), "radius": 0.45, "radiance": (20.0, 20.0, 20.0)}
PLANE_M = 3.0  # half side


def plane():
    piece = Piece()
    s = PLANE_M
    piece.quad((-s, 0.0, s), (s, 0.0, s), (s, 0.0, -s), (-s, 0.0, -s))
    return piece


def scene(path, animal, plane_material):
    gltf = Gltf("Bunny: Stanford University Computer Graphics Laboratory")
    materials = {"plane": gltf.material("plane", (0.7, 0.7, 0.7)), "bunny": gltf.material("bunny", (0.0, 0.0, 0.0))}
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
    scene(options.folder / "bunny_plane.glb", animal, {})
    # Dark and glossy: without KHR_materials_specular highlights have their full strength.
    scene(options.folder / "bunny_gloss.glb", animal,
          {"pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.5, 1.0], "metallicFactor": 0.6,
                                    "roughnessFactor": 0.35}, "extensions": {}})


if __name__ == "__main__":
    main()
