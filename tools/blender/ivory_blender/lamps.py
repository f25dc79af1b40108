"""Area lamps, which Blender's exporter leaves out, as faces that emit the same light."""

import math

import bpy
from mathutils import Matrix

_ROUND = 48  # corners of a disc; its area is that of the circle


def _outline(lamp):
    """Corners in the lamp's plane, counter-clockwise as seen from where it shines to, -Z."""
    wide, high = lamp.size, lamp.size_y if lamp.shape in {"RECTANGLE", "ELLIPSE"} else lamp.size
    if lamp.shape in {"SQUARE", "RECTANGLE"}:
        return [(wide * x / 2, high * y / 2, 0) for x, y in ((-1, -1), (-1, 1), (1, 1), (1, -1))]
    step = 2 * math.pi / _ROUND
    radius = math.sqrt(step / math.sin(step)) / 2  # of the polygon with the circle's area
    return [(wide * radius * math.cos(-i * step), high * radius * math.sin(-i * step), 0) for i in range(_ROUND)]


def _radiance(lamp, scaling):
    """Of an area lamp of `energy` watts, as Cycles has it: P / (4 A), in Blender's units of emission."""
    corners = [scaling @ Matrix.Translation(corner).to_translation() for corner in _outline(lamp)]
    area = abs(sum(a.x * b.y - b.x * a.y for a, b in zip(corners, corners[1:] + corners[:1]))) / 2
    return lamp.energy / (4 * area) if area > 0 else 0.0


def _emitting(name, colour, radiance):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    material.use_backface_culling = True  # one-sided
    nodes = material.node_tree.nodes
    surface = next(node for node in nodes if node.type == "BSDF_PRINCIPLED")
    surface.inputs["Base Color"].default_value = (0, 0, 0, 1)
    surface.inputs["Specular"].default_value = 0
    surface.inputs["Emission"].default_value = (*colour, 1)
    surface.inputs["Emission Strength"].default_value = radiance
    return material


def add_emitters(scene, depsgraph):
    """(objects to be removed with remove_emitters(), warnings): one for each area lamp that is rendered."""
    objects, warnings = [], []
    for lamp_object in scene.objects:
        if lamp_object.type != "LIGHT" or lamp_object.hide_render:
            continue
        lamp = lamp_object.data
        if lamp.type != "AREA":
            continue
        if all(collection.hide_render for collection in lamp_object.users_collection):
            continue
        if lamp.spread < math.pi - 1e-4:
            warnings.append(f"area lamp '{lamp_object.name}' has a spread, which is ignored: it shines to all sides before it")
        world = lamp_object.evaluated_get(depsgraph).matrix_world
        # Cycles takes the lamp's size times its scale.
        across = Matrix.Diagonal((world.to_3x3().col[0].length, world.to_3x3().col[1].length, 1))
        radiance = _radiance(lamp, across)
        if radiance <= 0:
            continue
        name = f"{lamp_object.name} (area lamp)"
        mesh = bpy.data.meshes.new(name)
        corners = _outline(lamp)
        mesh.from_pydata(corners, [], [tuple(range(len(corners)))])
        mesh.materials.append(_emitting(name, lamp.color, radiance))
        emitter = bpy.data.objects.new(name, mesh)
        emitter.matrix_world = world
        for key, value in lamp_object.items():  # ivory_group, and what else is said of it
            if key.startswith("ivory_"):
                emitter[key] = value
        scene.collection.objects.link(emitter)
        objects.append(emitter)
    return objects, warnings


def remove_emitters(objects):
    for emitter in objects:
        mesh = emitter.data
        material = mesh.materials[0]
        bpy.data.objects.remove(emitter)
        bpy.data.meshes.remove(mesh)
        bpy.data.materials.remove(material)
