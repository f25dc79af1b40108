"""The panels: 3D View > Sidebar > ivory."""

import textwrap

import bpy

from . import settings as kept


class _Panel:
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "ivory"

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        self.fill(layout.column(), context.scene.ivory)

    @staticmethod
    def lines(column, text, **options):
        """A text in as many lines as the sidebar's width needs."""
        width = max(20, int(bpy.context.region.width / (7 * bpy.context.preferences.system.ui_scale)))
        icon = " " * 4 if options.get("icon", "NONE") != "NONE" else ""  # takes room, too
        for line in textwrap.wrap(text, width, initial_indent=icon):
            column.label(text=line.strip(), **options)
            options = {}


class IVORY_PT_scene(_Panel, bpy.types.Panel):
    bl_label = "ivory"

    def fill(self, column, settings):
        shown = bpy.context.window_manager.ivory
        if shown.running:
            work, _, rate = shown.text.partition(", ")
            self.lines(column, work)
            self.lines(column, rate)
            column.prop(shown, "fraction", slider=True)
            column.operator("ivory.stop", icon="CANCEL", text="Stopping" if shown.stopping else "Stop")
        for line in shown.said.splitlines() if not shown.running else []:
            self.lines(column, line.removeprefix("! "), icon="ERROR" if line.startswith(("! ", "ivory: ")) else "NONE")
        column.prop(settings, "folder")
        if kept.is_temporary(settings):
            self.lines(column, "Save the .blend first, or files go when Blender quits", icon="INFO")
        column.prop(settings, "name")
        column.prop(settings, "overwrite")
        column.prop(settings, "units")
        column.prop(settings, "use_world")
        if settings.use_world:
            column.prop(settings, "world_width")
        column.operator("ivory.export", icon="EXPORT")


class IVORY_PT_grid(_Panel, bpy.types.Panel):
    bl_label = "Grid"

    def fill(self, column, settings):
        column.prop(settings, "grid_by")
        if settings.grid_by == "ERROR":
            column.prop(settings, "target_error")
        else:
            column.prop(settings, "resolution" if settings.grid_by == "RESOLUTION" else "spacing")
            column.prop(settings, "photons")
        column.prop(settings, "bounds")
        column.prop(settings, "direct")
        row = column.row(align=True)
        row.operator("ivory.bake_grid", icon="RENDER_STILL").dry_run = False
        row.operator("ivory.bake_grid", text="Plan").dry_run = True


class IVORY_PT_others(_Panel, bpy.types.Panel):
    bl_label = "World and Lightmap"
    bl_options = {"DEFAULT_CLOSED"}

    def fill(self, column, settings):
        column.operator("ivory.bake_sh9", icon="WORLD")
        column.separator()
        column.prop(settings, "lightmap_size")
        column.prop(settings, "lightmap_samples")
        column.prop(settings, "lightmap_gather")
        column.prop(settings, "lightmap_indirect")
        column.operator("ivory.bake_lightmap", icon="TEXTURE")


class IVORY_PT_look(_Panel, bpy.types.Panel):
    bl_label = "Look"

    def fill(self, column, settings):
        column.operator("ivory.import_grid", icon="VOLUME_DATA")
        column.separator()
        column.prop(settings, "source")
        if settings.source == "PATHS":
            column.prop(settings, "path_samples")
        column.prop(settings, "domain")
        column.operator("ivory.light_on_objects", icon="LIGHT")
        column.operator("ivory.show_lightmap", icon="TEXTURE")
        column.operator("ivory.hide_light", icon="MATERIAL")


class IVORY_PT_batch(_Panel, bpy.types.Panel):
    bl_label = "Batch"
    bl_options = {"DEFAULT_CLOSED"}

    def fill(self, column, settings):
        column.operator("ivory.write_job", icon="FILE_TEXT")


_classes = (IVORY_PT_scene, IVORY_PT_grid, IVORY_PT_others, IVORY_PT_look, IVORY_PT_batch)


def register():
    for each in _classes:
        bpy.utils.register_class(each)


def unregister():
    for each in reversed(_classes):
        bpy.utils.unregister_class(each)
