"""Operators that show what was baked."""

import os

import bpy
import numpy as np

from . import commands, results, shown
from .bake_operators import prepare_scene
from .operator import IvoryOperator
from .run import Failure


def _meshes(context):
    """The chosen objects that light can be written on."""
    return [each for each in context.selected_objects if each.type == "MESH" and each != context.scene.ivory.bounds]


def _baked(path, what):
    if not os.path.exists(path):
        raise Failure(f"{path}: is not there; bake the {what} first")
    return path


class IVORY_OT_import_grid(IvoryOperator, bpy.types.Operator):
    """Show the baked grid as a volume, where it lies in the scene"""
    bl_idname = "ivory.import_grid"
    bl_label = "Grid as a Volume"
    bl_options = {"REGISTER", "UNDO"}

    def steps(self, context):
        path = _baked(commands.files(context.scene.ivory)["grid"], "grid")
        volume = results.import_grid(context, path)
        if not volume.data.materials:
            self.warn([f"{path}: has another basis than vectors, for which there is no material"])
        self.say(f"{len(volume.data.grids)} grids of {path}")
        yield from ()


class IVORY_OT_light_on_objects(IvoryOperator, bpy.types.Operator):
    """Write E at each vertex of the selected meshes into their colour attribute ivory_E, and show it"""
    bl_idname = "ivory.light_on_objects"
    bl_label = "Light on Selected"
    bl_options = {"REGISTER", "UNDO"}

    show: bpy.props.BoolProperty(name="Show", default=True, description="Put ivory's material over the objects' own")

    def steps(self, context):
        settings = context.scene.ivory
        files = commands.files(settings)
        domain = settings.domain
        meshes = _meshes(context)
        if not meshes:
            raise Failure("select meshes that the light is to be written on")
        for each in meshes:
            if each.data.users > 1 or each.data.library is not None:
                raise Failure(f"mesh '{each.data.name}' of object '{each.name}' is shared or linked, and can hold the light of one "
                              "place alone: make it a single user (Object > Relations)")
        source = files["scene"] if settings.source == "PATHS" else _baked(files["grid"], "grid")
        world = prepare_scene(self, context, files)
        depsgraph = context.evaluated_depsgraph_get()
        found = [(each.name, *results.points_of(each, domain, depsgraph)) for each in meshes]
        self.warn([f"object '{name}': its modifiers change its vertices; light is taken at those of the mesh without them"
                   for name, _, _, same in found if not same])
        table, answers = files["scene"] + ".points.csv", files["scene"] + ".light.csv"
        rows, count = results.write_points(table, np.concatenate([points for _, points, _, _ in found]),
                                           np.concatenate([normals for _, _, normals, _ in found]))
        if count == 0:
            raise Failure("the selected meshes have no vertices with a normal")
        try:
            child = yield "asking for light", commands.probe(context, source, files["scene"], world, table, answers)
            light = results.read_light(answers)
        finally:
            for path in (table, answers):
                if os.path.exists(path):
                    os.remove(path)
        self.warn(child.result().get("warnings", []))
        # The last row is that of points that have none.
        per_point = np.concatenate([light, np.zeros((1, 3), np.float32)])[rows]
        if (rows < 0).any():
            self.warn([f"{int((rows < 0).sum())} loose vertices have no normal: 0"])
        begin = 0
        for name, points, _, _ in found:
            each = bpy.data.objects.get(name)  # undo may have made another of it
            if each is not None and each.type == "MESH":
                own = per_point[begin:begin + len(points)]
                length = len(each.data.loops) if domain == "CORNER" else len(each.data.vertices)
                if length != len(own):
                    raise Failure(f"object '{name}' was changed meanwhile")
                results.keep_light(each.data, domain, own)
                if self.show:
                    shown.show(each, shown.attribute_material(context.scene))
            begin += len(points)
        self.say(f"E at {len(rows):,} points of {len(found)} objects, {light.min():.4g} to {light.max():.4g} "
                 + ("lux" if settings.units == "LUX" else "W/m²"))


class IVORY_OT_show_lightmap(IvoryOperator, bpy.types.Operator):
    """Show the baked lightmap on the selected meshes"""
    bl_idname = "ivory.show_lightmap"
    bl_label = "Lightmap on Selected"
    bl_options = {"REGISTER", "UNDO"}

    def steps(self, context):
        path = _baked(commands.files(context.scene.ivory)["lightmap"], "lightmap")
        meshes = _meshes(context)
        if not meshes:
            raise Failure("select meshes that the lightmap is to be shown on")
        for each in meshes:
            if len(each.data.uv_layers) < 2:
                raise Failure(f"object '{each.name}' has no second UV map, and so no place in the lightmap")
        image = bpy.data.images.load(path, check_existing=True)
        image.reload()
        image.colorspace_settings.name = "Linear"
        for each in meshes:
            shown.show(each, shown.lightmap_material(context.scene, image, each.data.uv_layers[1].name))
        self.say(f"{image.size[0]} × {image.size[1]} texels of {path}")
        yield from ()


class IVORY_OT_hide_light(bpy.types.Operator):
    """Give all objects their own materials back"""
    bl_idname = "ivory.hide_light"
    bl_label = "Own Materials"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return any(shown.is_shown(each) for each in context.scene.objects)

    def execute(self, context):
        for each in context.scene.objects:
            shown.hide(each)
        return {"FINISHED"}


_classes = (IVORY_OT_import_grid, IVORY_OT_light_on_objects, IVORY_OT_show_lightmap, IVORY_OT_hide_light)


def register():
    for each in _classes:
        bpy.utils.register_class(each)


def unregister():
    for each in reversed(_classes):
        bpy.utils.unregister_class(each)
