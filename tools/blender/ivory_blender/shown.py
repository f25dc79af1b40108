"""Baked light shown on objects: a material of ivory's in place of their own, which stay in the mesh."""

import contextlib
import math

import bpy

from . import settings as kept

ATTRIBUTE = "ivory_E"
_MARK = "ivory_slots"  # of an object: what its slots were before, as letters
_ALBEDO = 0.8          # of the clay that the light is shown on


def _material(name, scene, colour_node):
    """Emits clay's radiosity, albedo E / pi, in Blender's units: as bright as Cycles draws it. `colour_node` adds the node
    that gives E, and returns its socket."""
    material = bpy.data.materials.get(name) or bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    scaled = tree.nodes.new("ShaderNodeVectorMath")
    scaled.operation = "SCALE"
    scaled.label = "albedo / pi"
    scaled.inputs["Scale"].default_value = _ALBEDO / (math.pi * kept.factor(scene.ivory))
    emission = tree.nodes.new("ShaderNodeEmission")
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    for place, node in enumerate((scaled, emission, output)):
        node.location = (200 * place, 0)
    tree.links.new(colour_node(tree), scaled.inputs[0])
    tree.links.new(scaled.outputs[0], emission.inputs["Color"])
    tree.links.new(emission.outputs[0], output.inputs["Surface"])
    return material


def attribute_material(scene):
    def node(tree):
        attribute = tree.nodes.new("ShaderNodeAttribute")
        attribute.attribute_name = ATTRIBUTE
        attribute.location = (-200, 0)
        return attribute.outputs["Color"]
    return _material("ivory light", scene, node)


def lightmap_material(scene, image, charts):
    """`charts`: the name of the UV map that the lightmap goes by."""
    def node(tree):
        uv = tree.nodes.new("ShaderNodeUVMap")
        uv.uv_map = charts
        uv.location = (-600, 0)
        texture = tree.nodes.new("ShaderNodeTexImage")
        texture.image = image
        texture.location = (-400, 0)
        tree.links.new(uv.outputs[0], texture.inputs[0])
        return texture.outputs["Color"]
    return _material(f"ivory lightmap ({charts})", scene, node)


def show(each, material):
    """Puts the material over all slots of an object."""
    hide(each)
    slots = each.material_slots
    each[_MARK] = "".join("O" if slot.link == "OBJECT" else "D" for slot in slots) or "+"
    if not slots:
        each.data.materials.append(None)
    for index, slot in enumerate(each.material_slots):
        if slot.link == "OBJECT" and slot.material is not None:
            each[f"ivory_slot_{index}"] = slot.material
        slot.link = "OBJECT"
        slot.material = material


def hide(each):
    """Gives an object its own materials back."""
    was = each.get(_MARK)
    if was is None:
        return
    for index, slot in enumerate(each.material_slots):
        slot.material = each.pop(f"ivory_slot_{index}", None)
        slot.link = "OBJECT" if was[index:index + 1] == "O" else "DATA"
    if was == "+" and len(each.data.materials) == 1 and each.data.materials[0] is None:
        each.data.materials.pop()
    del each[_MARK]


def is_shown(each):
    return _MARK in each


@contextlib.contextmanager
def hidden(scene):
    """While it lasts, objects have their own materials and no light of ours for vertex colours."""
    covered = [(each, each.material_slots[0].material) for each in scene.objects if is_shown(each)]
    for each, _ in covered:
        hide(each)
    drawn = []
    for mesh in {each.data for each in scene.objects if each.type == "MESH"}:
        colours = mesh.color_attributes
        index = colours.render_color_index
        if 0 <= index < len(colours) and colours[index].name == ATTRIBUTE:
            drawn.append((mesh, index))
            colours.render_color_index = -1
    try:
        yield
    finally:
        for mesh, index in drawn:
            mesh.color_attributes.render_color_index = index
        for each, material in covered:
            show(each, material)
