"""The scene as a .glb file, by Blender's own exporter, with what that leaves out put right."""

import contextlib
import os

import bpy

from . import glb, lamps, settings as kept, shown
from .run import Failure


def _uses_vertex_colours(materials):
    trees = [material.node_tree for material in materials if material.use_nodes and material.node_tree]
    return any(node.type == "VERTEX_COLOR" or
               (node.type == "ATTRIBUTE" and node.attribute_type == "GEOMETRY") for tree in trees for node in tree.nodes)


@contextlib.contextmanager
def _without(box):
    """The box that only says what the grid fills is no part of the scene."""
    was = box.hide_render if box is not None else None
    if box is not None:
        box.hide_render = True
    try:
        yield
    finally:
        if box is not None:
            box.hide_render = was


@contextlib.contextmanager
def _emitters(context, warnings):
    emitters, said = lamps.add_emitters(context.scene, context.evaluated_depsgraph_get())
    warnings.extend(said)
    try:
        yield
    finally:
        lamps.remove_emitters(emitters)


def _doubts(scene):
    if abs(scene.unit_settings.scale_length - 1) > 1e-6:
        yield (f"the scene's unit scale of {scene.unit_settings.scale_length:g} is ignored, as Blender's exporter and Cycles "
               "ignore it: a unit is a metre")
    for lamp_object in scene.objects:
        lamp = lamp_object.data if lamp_object.type == "LIGHT" and not lamp_object.hide_render else None
        if lamp is None:
            continue
        if min(lamp.color) < 0 or lamp.energy < 0:
            yield f"lamp '{lamp_object.name}' has light below zero"
        if lamp.use_nodes:
            yield f"lamp '{lamp_object.name}' has nodes, of which Blender's exporter takes emission's colour and strength alone"


def export_scene(context, path):
    """Writes `path`, and returns warnings: what is renderable of the active scene, at its current frame, with modifiers
    applied. The same scene gives the same bytes. Failure where Blender's exporter fails."""
    if not hasattr(bpy.types, "EXPORT_SCENE_OT_gltf"):
        raise Failure("scenes are exported by Blender's add-on 'Import-Export: glTF 2.0 format': enable it")
    if context.mode != "OBJECT":
        raise Failure("leave edit mode first: what is being edited is not yet in the mesh")
    settings = context.scene.ivory
    warnings = list(_doubts(context.scene))
    unfinished = path + ".part.glb"
    with _without(settings.bounds), shown.hidden(context.scene), _emitters(context, warnings):
        materials = {slot.material for each in context.scene.objects for slot in each.material_slots if slot.material}
        try:
            bpy.ops.export_scene.gltf(
                filepath=unfinished, check_existing=False, export_format="GLB", use_active_scene=True, use_renderable=True,
                convert_lighting_mode="SPEC" if settings.units == "LUX" else "COMPAT", export_lights=True,
                export_cameras=True, export_apply=True, export_extras=True, export_yup=True, export_animations=False,
                export_current_frame=True, export_colors=_uses_vertex_colours(materials), will_save_settings=False)
        except RuntimeError as error:
            raise Failure(f"{path}: Blender's exporter failed: {str(error).strip().splitlines()[-1]}") from error
    document, rest = glb.read(unfinished)
    glb.drop_extras(document)
    if kept.factor(settings) != 1:
        glb.scale_emission(document, kept.factor(settings))
    glb.write(unfinished, document, rest)
    os.replace(unfinished, path)
    return warnings
