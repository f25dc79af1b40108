"""Operators that export and bake."""

import os

import bpy

from . import commands, export, job, settings as kept, world
from .operator import IvoryOperator
from .run import Failure


def prepare_world(operator, context, files):
    """Writes the world's map; its path, None where it does not light the scene."""
    settings = context.scene.ivory
    if not settings.use_world:
        return None
    path, warnings = world.write_world(context.scene, files["world"], settings.world_width, kept.factor(settings))
    operator.warn(warnings)
    return path


def prepare_scene(operator, context, files):
    """Writes the scene's file, and its world's."""
    operator.warn(export.export_scene(context, files["scene"]))
    return prepare_world(operator, context, files)


def _share(value):
    return f"{100 * value:.3g} %"


def _seconds(value):
    return f"{value:.3g} s" if value < 100 else f"{value / 60:.3g} min" if value < 6000 else f"{value / 3600:.3g} h"


def _size(document):
    x, y, z = document["resolution"]
    spacing = " × ".join(format(document["spacing_m"][axis], ".3g") for axis in (0, 2, 1))
    return f"{x} × {z} × {y} vertices, {spacing} m apart"


def _grid_lines(result):
    """About a grid or the plan of one, along Blender's axes."""
    plan = result.get("plan")
    if plan is None:
        lines = [_size(result), f"{result['photons']:,} photons in {_seconds(result['seconds'])}"]
        if "certificate" in result:
            measured = result["certificate"]
            lines.append(f"error {_share(measured['error'])} ({_share(measured['low'])} to {_share(measured['high'])})")
        return lines
    if "resolution" not in plan:
        return [f"{key}: {value}" for key, value in plan.items() if isinstance(value, (int, float, str))]
    lines = [_size(plan), f"{plan['photons']:,} photons"]
    if "error" in plan:
        lines.append(f"error {_share(plan['error']['low'])} to {_share(plan['error']['high'])}")
    if "seconds" in plan:
        lines.append(f"{_seconds(plan['seconds']['low'])} to {_seconds(plan['seconds']['high'])}")
        lines.append(f"{plan['memory_bytes']['high'] / 2**20:.3g} MiB of memory")
    if not plan.get("meets", True):
        lines.append("! the error is not met within these limits")
    return lines


class IVORY_OT_export(IvoryOperator, bpy.types.Operator):
    """Write the scene's .glb file, and its world's environment map, as bakes read them"""
    bl_idname = "ivory.export"
    bl_label = "Export the Scene"

    def steps(self, context):
        files = commands.files(context.scene.ivory)
        path = prepare_scene(self, context, files)
        self.say(files["scene"], *([path] if path else []))
        yield from ()


class IVORY_OT_bake_grid(IvoryOperator, bpy.types.Operator):
    """Bake the scene's light into a grid of irradiance vectors. A bake that was stopped goes on where it was"""
    bl_idname = "ivory.bake_grid"
    bl_label = "Bake Grid"

    dry_run: bpy.props.BoolProperty(name="Plan only", options={"SKIP_SAVE"},
                                    description="Say what would be baked and what it would cost")

    def steps(self, context):
        files = commands.files(context.scene.ivory)
        path = prepare_scene(self, context, files)
        child = yield ("planning" if self.dry_run else "baking a grid",
                       commands.bake_grid(context, files["scene"], path, files["grid"], self.dry_run))
        result = child.result()
        self.warn(result.get("warnings", []))
        self.say(*_grid_lines(result))
        if not self.dry_run:
            self.say(files["grid"])


class IVORY_OT_bake_sh9(IvoryOperator, bpy.types.Operator):
    """Bake the world's light into nine coefficients"""
    bl_idname = "ivory.bake_sh9"
    bl_label = "Bake SH9"

    def steps(self, context):
        settings = context.scene.ivory
        files = commands.files(settings)
        path, warnings = world.write_world(context.scene, files["world"], settings.world_width, kept.factor(settings))
        self.warn(warnings)
        if path is None:
            raise Failure("the scene has no world, or a black one: there is no light to bake")
        child = yield "baking SH9", commands.bake_sh9(context, path, files["sh9"])
        result = child.result()
        self.warn(result.get("warnings", []))
        self.say(files["sh9"])


class IVORY_OT_bake_lightmap(IvoryOperator, bpy.types.Operator):
    """Bake E into a texture by the baked grid. Every mesh needs a second UV map, without overlaps"""
    bl_idname = "ivory.bake_lightmap"
    bl_label = "Bake Lightmap"

    def steps(self, context):
        files = commands.files(context.scene.ivory)
        if not os.path.exists(files["grid"]):
            raise Failure(f"{files['grid']}: is not there; bake the grid first")
        path = prepare_scene(self, context, files)
        child = yield ("baking a lightmap",
                       commands.bake_lightmap(context, files["scene"], path, files["grid"], files["lightmap"]))
        self.warn(child.result().get("warnings", []))
        self.say(files["lightmap"])


class IVORY_OT_write_job(IvoryOperator, bpy.types.Operator):
    """Write a job file that bakes all of this by "ivory batch", and the files that it reads"""
    bl_idname = "ivory.write_job"
    bl_label = "Write Batch Job"

    def steps(self, context):
        settings = context.scene.ivory
        files = commands.files(settings)
        if os.path.exists(files["job"]) and not settings.overwrite:
            raise Failure(f"{files['job']}: already exists; allow to overwrite, or give another name")
        path = prepare_scene(self, context, files)
        with open(files["job"], "w", encoding="utf-8") as file:
            file.write(job.text(context, files, path))
        child = yield "checking the job", commands.batch_list(files["job"])
        self.say(*child.stdout().splitlines(), files["job"])


_classes = (IVORY_OT_export, IVORY_OT_bake_grid, IVORY_OT_bake_sh9, IVORY_OT_bake_lightmap, IVORY_OT_write_job)


def register():
    for each in _classes:
        bpy.utils.register_class(each)


def unregister():
    for each in reversed(_classes):
        bpy.utils.unregister_class(each)
