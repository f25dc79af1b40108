"""Baked assets in Blender: a grid as a volume, E as a colour attribute."""

import csv

import bpy
import numpy as np
from mathutils import Matrix

from . import axes, settings as kept, shown
from .run import Failure

_OF = "ivory_file"  # of a volume's object: the grid's path
_DIRECTIONS = [("px", (1, 0, 0)), ("mx", (-1, 0, 0)), ("py", (0, 1, 0)), ("my", (0, -1, 0)), ("pz", (0, 0, 1)),
               ("mz", (0, 0, -1))]


def _mean_light_material(scene):
    """Glows by the mean of E over a vertex's six directions: E(d) is I_d in d."""
    material = bpy.data.materials.get("ivory grid") or bpy.data.materials.new("ivory grid")
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    channels = tree.nodes.new("ShaderNodeCombineColor")
    for channel, letter in enumerate("rgb"):
        total = None
        for row, (name, direction) in enumerate(_DIRECTIONS):
            stored = tree.nodes.new("ShaderNodeAttribute")
            stored.attribute_name = f"I_{name}_{letter}"
            stored.location = (-800, -700 * channel - 110 * row)
            dot = tree.nodes.new("ShaderNodeVectorMath")
            dot.operation = "DOT_PRODUCT"
            dot.inputs[1].default_value = direction
            dot.location = (-600, -700 * channel - 110 * row)
            tree.links.new(stored.outputs["Vector"], dot.inputs[0])
            value = dot.outputs["Value"]
            if total is not None:
                add = tree.nodes.new("ShaderNodeMath")
                add.location = (-400, -700 * channel - 110 * row)
                tree.links.new(total, add.inputs[0])
                tree.links.new(value, add.inputs[1])
                value = add.outputs[0]
            total = value
        tree.links.new(total, channels.inputs[channel])
    emission = tree.nodes.new("ShaderNodeEmission")
    emission.inputs["Strength"].default_value = 1 / (6 * np.pi * kept.factor(scene.ivory))
    emission.location = (200, 0)
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    output.location = (400, 0)
    tree.links.new(channels.outputs[0], emission.inputs["Color"])
    tree.links.new(emission.outputs[0], output.inputs["Volume"])
    return material


def _half_a_voxel_back(voxels):
    """OpenVDB has a voxel's value at its index, where ivory's vertices are; Blender draws it half a voxel farther."""
    return Matrix.Translation(-(voxels.col[0] + voxels.col[1] + voxels.col[2]).to_3d() / 2)


def import_grid(context, path):
    """The grid as a volume object where it lies in the scene, in place of what was imported from that file before. It is
    not rendered unless asked to."""
    for each in [each for each in bpy.data.objects if each.get(_OF) == path]:
        volume = each.data
        bpy.data.objects.remove(each)
        if volume.users == 0:
            bpy.data.volumes.remove(volume)
    context.view_layer.update()  # who evaluates the scene lets go of the file, too, which may hold another grid now
    volume = bpy.data.volumes.new("ivory grid")
    volume.filepath = path
    if not volume.grids.load():
        message = volume.grids.error_message
        bpy.data.volumes.remove(volume)
        raise Failure(f"{path}: Blender cannot read it: {message}")
    if "I_px_r" in volume.grids:
        volume.materials.append(_mean_light_material(context.scene))
    placed = bpy.data.objects.new("ivory grid", volume)
    placed.matrix_world = axes.TO_BLENDER @ _half_a_voxel_back(volume.grids[0].matrix_object)
    placed[_OF] = path
    placed.hide_render = True
    context.scene.collection.objects.link(placed)
    return placed


# A point on an edge between walls lies in the plane of both, and nothing sees it: corners are asked for this much of
# the way towards their face's middle.
_INWARD = 0.01


def _corners(mesh):
    """(places, normals) of face corners, for their faces' normals."""
    at = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", at)
    mesh.calc_normals_split()
    normals = np.empty((len(mesh.loops), 3), np.float32)
    mesh.loops.foreach_get("normal", normals.ravel())
    mesh.free_normals_split()
    places = np.empty((len(mesh.vertices), 3), np.float32)
    mesh.vertices.foreach_get("co", places.ravel())
    sizes = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("loop_total", sizes)
    first = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("loop_start", first)
    middles = np.empty((len(mesh.polygons), 3), np.float32)
    mesh.polygons.foreach_get("center", middles.ravel())
    face = np.empty(len(mesh.loops), np.int64)
    for polygon, (start, size) in enumerate(zip(first, sizes)):
        face[start:start + size] = polygon
    corners = places[at].astype(np.float64)
    return corners + _INWARD * (middles[face] - corners), normals


def _surface(each, depsgraph):
    """The mesh to take positions and normals from: as modifiers deform it, where they keep its corners; else as it is."""
    deformed = each.evaluated_get(depsgraph).data
    own = each.data
    same = len(deformed.vertices) == len(own.vertices) and len(deformed.loops) == len(own.loops)
    return (deformed if same else own), same


def points_of(each, domain, depsgraph):
    """(points, normals, are modifiers in them): in ivory's world, one a vertex or a face corner."""
    mesh, same = _surface(each, depsgraph)
    if domain == "CORNER":
        places, normals = _corners(mesh)
    else:
        places = np.empty((len(mesh.vertices), 3), np.float32)
        mesh.vertices.foreach_get("co", places.ravel())
        normals = np.empty_like(places)
        mesh.vertices.foreach_get("normal", normals.ravel())
    world = np.array(each.evaluated_get(depsgraph).matrix_world, np.float64)
    linear = world[:3, :3]
    if abs(np.linalg.det(linear)) < 1e-30:
        raise Failure(f"object '{each.name}' is scaled to nothing")
    points = places @ linear.T + world[:3, 3]
    normals = normals @ np.linalg.inv(linear)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    normals = np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0)
    return axes.to_gltf(points), axes.to_gltf(normals), same


def write_points(path, points, normals):
    """A table for ivory probe: each different row once. Returns (row of each point or -1, number of rows): points without
    a normal, of loose vertices, have none."""
    rows = np.concatenate([points, normals], axis=1)
    asked = np.abs(normals).sum(axis=1) > 0
    different, inverse = np.unique(rows[asked], axis=0, return_inverse=True)
    np.savetxt(path, different, fmt="%.9g", delimiter=",", header="x,y,z,nx,ny,nz", comments="")
    row = np.full(len(rows), -1)
    row[asked] = inverse.reshape(-1)
    return row, len(different)


def read_light(path):
    """The columns r,g,b of what ivory probe wrote."""
    with open(path, newline="", encoding="utf-8") as file:
        return np.array([[float(row[channel]) for channel in "rgb"] for row in csv.DictReader(file)], np.float32)


def keep_light(mesh, domain, light):
    """Writes E (n x 3) into the mesh's colour attribute; float, so in lux as it is."""
    values = np.ones((len(light), 4), np.float32)
    values[:, :3] = light
    shown.keep(mesh, domain, values.ravel())
