"""Baked light shown on objects: a material of ivory's in place of their own, which stay in the mesh."""

import contextlib
import math

import bpy
import numpy as np

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


def _values(mesh):
    values = np.empty(4 * len(mesh.color_attributes[ATTRIBUTE].data), np.float32)
    mesh.color_attributes[ATTRIBUTE].data.foreach_get("color", values)
    return values


def keep(mesh, domain, values):
    """Writes the light, four floats a vertex or corner, into the mesh's colour attribute."""
    old = mesh.color_attributes.get(ATTRIBUTE)
    if old is not None:
        mesh.color_attributes.remove(old)
    attribute = mesh.color_attributes.new(ATTRIBUTE, "FLOAT_COLOR", domain)
    attribute.data.foreach_set("color", values)
    mesh.color_attributes.active_color = mesh.color_attributes[ATTRIBUTE]
    mesh.update()


@contextlib.contextmanager
def hidden(scene):
    """While it lasts, objects have their own materials, and no light of ours in place of vertex colours: a mesh's only
    colour attribute is exported as those."""
    covered = [(each, each.material_slots[0].material) for each in scene.objects if is_shown(each)]
    for each, _ in covered:
        hide(each)
    only = {each.data for each in scene.objects if each.type == "MESH" and
            [colours.name for colours in each.data.color_attributes] == [ATTRIBUTE]}
    stored = [(mesh, mesh.color_attributes[0].domain, _values(mesh)) for mesh in only]
    for mesh in only:
        mesh.color_attributes.remove(mesh.color_attributes[0])
    try:
        yield
    finally:
        for mesh, domain, values in stored:
            keep(mesh, domain, values)
        for each, material in covered:
            show(each, material)
