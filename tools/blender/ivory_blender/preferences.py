"""Where ivory's program is."""

import os
import shutil

import bpy

from .run import Failure

PACKAGE = __package__


class IvoryPreferences(bpy.types.AddonPreferences):
    bl_idname = PACKAGE

    program: bpy.props.StringProperty(
        name="Program", subtype="FILE_PATH",
        description="The ivory program; where this is empty, the first one on the PATH")
    threads: bpy.props.IntProperty(
        name="Threads", min=0, max=1024, default=0, description="That a bake may take; 0: one a core")

    def draw(self, _context):
        column = self.layout.column()
        column.prop(self, "program")
        column.prop(self, "threads")
        try:
            column.label(text=f"Found: {program()}", icon="CHECKMARK")
        except Failure as failure:
            column.label(text=str(failure), icon="ERROR")


def _preferences():
    return bpy.context.preferences.addons[PACKAGE].preferences


def program():
    """The path of ivory's program; Failure where there is none."""
    chosen = bpy.path.abspath(_preferences().program)
    if chosen:
        if not os.access(chosen, os.X_OK) or os.path.isdir(chosen):
            raise Failure(f"{chosen}: is no program; choose ivory's in the add-on's preferences")
        return chosen
    found = shutil.which("ivory")
    if found is None:
        raise Failure("no program ivory on the PATH; choose it in the add-on's preferences")
    return found


def common_options():
    """Options of every command."""
    threads = _preferences().threads
    return ["--json"] + (["--threads", str(threads)] if threads > 0 else [])


def register():
    bpy.utils.register_class(IvoryPreferences)


def unregister():
    bpy.utils.unregister_class(IvoryPreferences)
