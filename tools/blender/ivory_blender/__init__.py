"""ivory in Blender: export the scene, bake its light, look at it. docs/blender.md says how."""

bl_info = {
    "name": "ivory light baker",
    "author": "the ivory authors",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "3D View > Sidebar > ivory",
    "description": "Bakes irradiance grids, SH9 and lightmaps by the program ivory, and shows them",
    "category": "Lighting",
}

# pylint: disable=wrong-import-position
from . import bake_operators, operator, preferences, result_operators, settings, ui

_modules = (preferences, settings, operator, bake_operators, result_operators, ui)


def register():
    for module in _modules:
        module.register()


def unregister():
    for module in reversed(_modules):
        module.unregister()
