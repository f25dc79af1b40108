"""Blender's axes and glTF's. Blender: +Z up, -Y to the front; glTF and ivory: +Y up, +Z to the front. Both right-handed,
one unit a metre."""

import math

import numpy as np
from mathutils import Matrix, Vector

# From ivory's world to Blender's: (x, y, z) is at (x, -z, y). What was (x, y, z) in Blender is (x, z, -y) in glTF.
TO_BLENDER = Matrix(((1, 0, 0, 0), (0, 0, -1, 0), (0, 1, 0, 0), (0, 0, 0, 1)))


def to_gltf(vectors):
    """Rows (x, y, z) of Blender as ivory has them."""
    vectors = np.asarray(vectors, dtype=np.float64)
    return np.stack([vectors[:, 0], vectors[:, 2], -vectors[:, 1]], axis=1)


def corners(box):
    """The eight corners, in the object's own space, of the box that an object stands for."""
    if box.type == "EMPTY":
        r = box.empty_display_size
        return [Vector((x, y, z)) for x in (-r, r) for y in (-r, r) for z in (-r, r)]
    return [Vector(corner) for corner in box.bound_box]


def grid_box(box):
    """(lowest corner, highest corner, degrees): what --bounds and --rotate-y say of an object's box. A turn about the
    vertical turns the grid; with any other turn, and with shear, its axis-aligned box is taken, of 0 degrees."""
    world = box.matrix_world
    own = corners(box)
    along = [world.to_3x3().col[i].normalized() for i in range(3)]
    upright = abs(abs(along[2].z) - 1) < 1e-6 and abs(along[0].dot(along[1])) < 1e-6 and abs(along[0].z) < 1e-6
    angle = math.atan2(along[0].y, along[0].x) if upright else 0.0
    # A quarter turn is the same box with its sides swapped: the smallest angle that does.
    angle -= round(angle / (math.pi / 2)) * (math.pi / 2)
    if abs(angle) < 1e-7:
        angle = 0.0
    placed = [world @ corner for corner in own]
    middle = sum(placed, Vector()) / 8
    back = Matrix.Rotation(-angle, 3, "Z")
    flat = to_gltf([back @ (corner - middle) + middle for corner in placed])
    return flat.min(axis=0), flat.max(axis=0), math.degrees(angle)
