"""What the panel holds, kept with the scene; and how far a bake is, which is not kept."""

import os
import re

import bpy
from bpy.props import (BoolProperty, EnumProperty, FloatProperty, IntProperty, IntVectorProperty, PointerProperty,
                       StringProperty)

from . import run

LUMENS_A_WATT = 683  # of Blender's glTF exporter


class IvorySettings(bpy.types.PropertyGroup):
    folder: StringProperty(
        name="Folder", subtype="DIR_PATH", default="//ivory",
        description="Where the scene's file and what is baked go; temporary while the .blend is not saved")
    name: StringProperty(name="Name", description="Of the files; that of the .blend where it is empty")
    overwrite: BoolProperty(name="Overwrite", default=True, description="Bake over what was baked before")
    units: EnumProperty(
        name="Light", default="LUX",
        items=[("LUX", "Lux (683 lm/W)", "E in lux: as Blender's exporter has it by default, a watt is 683 lumens. "
                "Emission and the world, which it leaves alone, take the same factor"),
               ("WATT", "Blender's watts", "E in W/m², with the numbers that Cycles computes with")])
    use_world: BoolProperty(name="World", default=True, description="The world lights the scene")
    world_width: IntProperty(
        name="Width", default=1024, min=64, max=16384,
        description="Of the world's environment map, in texels; half as many high")

    grid_by: EnumProperty(
        name="By", default="ERROR",
        items=[("ERROR", "Error", "Spacing and photons are chosen to reach an error, which is measured in the end"),
               ("RESOLUTION", "Resolution", "A number of vertices along x, y and z (up)"),
               ("SPACING", "Spacing", "A distance between vertices")])
    target_error: FloatProperty(
        name="Error", default=5, min=0.1, max=100, subtype="PERCENTAGE",
        description="RMS error of E over what is lit, in per cent of the mean; half of it costs about ten times as much")
    resolution: IntVectorProperty(
        name="Vertices", size=3, default=(32, 32, 16), min=2, max=4096, description="Along Blender's x, y and z")
    spacing: FloatProperty(name="Spacing", default=0.25, min=0.001, subtype="DISTANCE", unit="LENGTH",
                           description="Between vertices")
    photons: StringProperty(
        name="Photons", default="", description="Of the whole bake; 8m is 8 million. Empty: 256 a vertex")
    bounds: PointerProperty(
        name="Bounds", type=bpy.types.Object, poll=lambda _self, box: box.type in {"EMPTY", "MESH"},
        description="An empty or a box that the grid fills, the whole scene without; it is itself no part of the scene")
    direct: BoolProperty(name="Direct light too", default=False,
                         description="Store light straight from its sources as well; without, bounced light alone")

    lightmap_size: IntProperty(name="Texels", default=1024, min=16, max=16384, description="Width and height")
    lightmap_samples: IntProperty(name="Samples", default=16, min=1, max=65536, description="Places in a texel")
    lightmap_gather: IntProperty(name="Rays", default=32, min=0, max=65536,
                                 description="Gather rays a place; 0 reads the grid at the texel itself")
    lightmap_indirect: BoolProperty(name="Bounced light alone", default=False,
                                    description="For engines that draw the lamps themselves")

    source: EnumProperty(
        name="From", default="GRID",
        items=[("GRID", "Grid", "What the baked grid says"),
               ("PATHS", "Path tracing", "The truth, direct light and all: slower, and with noise")])
    path_samples: IntProperty(name="Paths", default=256, min=1, max=1 << 24, description="A point")
    domain: EnumProperty(
        name="At", default="POINT",
        items=[("POINT", "Vertices", "One value a vertex, for its smooth normal"),
               ("CORNER", "Face corners", "One a corner of a face, for that face's normal: right for hard edges")])


class IvoryProgress(bpy.types.PropertyGroup):
    # Asked of the processes themselves: a .blend that is saved while one runs must not keep it.
    running: BoolProperty(get=lambda _self: run.busy())
    stopping: BoolProperty(options={"SKIP_SAVE"})
    text: StringProperty(options={"SKIP_SAVE"})
    fraction: FloatProperty(name="", min=0, max=100, subtype="PERCENTAGE", options={"SKIP_SAVE"})
    said: StringProperty(options={"SKIP_SAVE"})  # lines about what was done last


def factor(settings):
    """Of what Blender calls a watt, and emission of 1."""
    return LUMENS_A_WATT if settings.units == "LUX" else 1


def is_temporary(settings):
    return settings.folder.startswith("//") and not bpy.data.filepath


def folder(settings):
    """Of the files, made where it is missing."""
    path = os.path.join(bpy.app.tempdir, "ivory") if is_temporary(settings) else bpy.path.abspath(settings.folder)
    path = os.path.normpath(path)
    os.makedirs(path, exist_ok=True)
    return path


def stem(settings):
    """Of the files' names."""
    name = settings.name or os.path.splitext(os.path.basename(bpy.data.filepath))[0] or "scene"
    return re.sub(r"[^\w.-]", "_", name)


def path(settings, extension):
    """"/level/ivory/level.vdb" for ".vdb"."""
    return os.path.join(folder(settings), stem(settings) + extension)


_classes = (IvorySettings, IvoryProgress)


def register():
    for each in _classes:
        bpy.utils.register_class(each)
    bpy.types.Scene.ivory = PointerProperty(type=IvorySettings)
    bpy.types.WindowManager.ivory = PointerProperty(type=IvoryProgress)


def unregister():
    del bpy.types.WindowManager.ivory
    del bpy.types.Scene.ivory
    for each in reversed(_classes):
        bpy.utils.unregister_class(each)
