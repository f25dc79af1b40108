"""What the tests in Blender share: the add-on from its zip, small scenes, and ivory itself for the numbers to hold it to."""

import csv
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import bpy
import numpy as np

IVORY = os.environ["IVORY"]
ADDON = os.environ["ADDON"]
ROOT = pathlib.Path(__file__).resolve().parents[2]


def install():
    bpy.ops.preferences.addon_install(filepath=ADDON)
    bpy.ops.preferences.addon_enable(module="ivory_blender")


def ivory(*arguments):
    """What the command prints, as JSON."""
    result = subprocess.run([IVORY, *map(str, arguments), "--json"], capture_output=True, text=True, check=False)
    assert result.returncode == 0, f"{arguments}: {result.stderr}"
    return json.loads(result.stdout)


def probe(source, points, normals, *options):
    """E (n x 3) at rows of Blender's coordinates, by ivory's own command. The axes are turned here, not by the add-on:
    Blender's z is glTF's y, its y glTF's -z."""
    turned = [[x, z, -y, nx, nz, -ny] for (x, y, z), (nx, ny, nz) in zip(points, normals)]
    with tempfile.TemporaryDirectory() as folder:
        table, answers = f"{folder}/p.csv", f"{folder}/e.csv"
        np.savetxt(table, turned, fmt="%.17g", delimiter=",", header="x,y,z,nx,ny,nz", comments="")
        ivory("probe", source, "--points", table, "-o", answers, *options)
        with open(answers, newline="", encoding="utf-8") as file:
            return np.array([[float(row[c]) for c in "rgb"] for row in csv.DictReader(file)])


def material(name, colour, emission=None):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    surface = made.node_tree.nodes["Principled BSDF"]
    surface.inputs["Base Color"].default_value = (*colour, 1)
    surface.inputs["Roughness"].default_value = 1
    surface.inputs["Specular"].default_value = 0
    if emission is not None:
        surface.inputs["Emission"].default_value = (1, 1, 1, 1)
        surface.inputs["Emission Strength"].default_value = emission
    return made


def mesh(name, vertices, faces, surface):
    data = bpy.data.meshes.new(name)
    data.from_pydata(vertices, [], faces)
    data.materials.append(surface)
    made = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(made)
    return made


def box(name, low, high, surface, inward=False):
    vertices = [(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return mesh(name, vertices, [face[::-1] if inward else face for face in faces], surface)


def lamp(kind, place, **values):
    data = bpy.data.lights.new(kind, kind)
    for key, value in values.items():
        setattr(data, key, value)
    made = bpy.data.objects.new(kind, data)
    made.location = place
    bpy.context.scene.collection.objects.link(made)
    return made


def room():
    """4 x 3 x 2.5 m, off the origin, no two axes alike, a red wall and a box in it."""
    box("Room", (1, -2, 0), (5, 1, 2.5), material("wall", (0.7, 0.6, 0.5)), inward=True)
    crate = box("Crate", (-0.4, -0.3, 0), (0.4, 0.3, 1), material("crate", (0.8, 0.2, 0.2)))
    crate.location = (4, -1.2, 0.002)
    crate.rotation_euler = (0, 0, 0.4)
    crate.scale = (1, 1.5, -0.9)
    crate.location.z = 0.95
    lamp("POINT", (2, -0.5, 2), energy=100)
    bpy.context.view_layer.update()


class BlenderTest(unittest.TestCase):
    """Each test has an empty scene and a folder."""

    def setUp(self):
        for data in (bpy.data.objects, bpy.data.meshes, bpy.data.lights, bpy.data.materials, bpy.data.worlds,
                     bpy.data.volumes, bpy.data.images, bpy.data.cameras):
            for each in list(data):
                data.remove(each)
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.scene = bpy.context.scene
        for key in list(self.scene.keys()):
            if key == "ivory":
                del self.scene[key]
        self.settings = self.scene.ivory
        self.settings.folder = self.folder
        self.settings.name = "level"

    def file(self, extension):
        return f"{self.folder}/level{extension}"

    def bytes_of(self, extension):
        return pathlib.Path(self.file(extension)).read_bytes()


def main():
    """To be called last by a script."""
    result = unittest.TextTestRunner(verbosity=2).run(unittest.defaultTestLoader.loadTestsFromModule(sys.modules["__main__"]))
    sys.stdout.flush()
    if not result.wasSuccessful():
        raise SystemExit(1)
