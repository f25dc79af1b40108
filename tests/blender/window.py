# in a window
"""The add-on in Blender's window: a bake does not hold Blender up, shows how far it is, is stopped by its button, and goes
on; the panels are drawn. Driven by a timer of Blender's."""

import os
import pathlib
import sys
import tempfile
import time
import traceback

import bpy

import support

folder = tempfile.TemporaryDirectory()
drawn = []  # labels of the add-on's panels, as often as they were drawn
ticks = []  # (seconds, what the panel shows) while a bake runs
began = time.monotonic()


def window():
    area = next(area for area in bpy.context.window_manager.windows[0].screen.areas if area.type == "VIEW_3D")
    region = next(region for region in area.regions if region.type == "WINDOW")
    return bpy.context.temp_override(window=bpy.context.window_manager.windows[0], area=area, region=region)


def picture(name):
    """Of the window, where someone asked for pictures."""
    if os.environ.get("PICTURES"):
        bpy.ops.screen.screenshot(filepath=f"{os.environ['PICTURES']}/{name}.png")


def open_tab():
    """Clicks on the tabs of the sidebar, from the top, until the add-on's panel is drawn."""
    window_ = bpy.context.window_manager.windows[0]
    area = next(area for area in window_.screen.areas if area.type == "VIEW_3D")
    for _ in range(5):
        yield
    sidebar = next(region for region in area.regions if region.type == "UI")
    x = sidebar.x + sidebar.width - 10
    for y in range(sidebar.y + sidebar.height - 20, sidebar.y, -20):
        window_.event_simulate(type="MOUSEMOVE", value="NOTHING", x=x, y=y)
        window_.event_simulate(type="LEFTMOUSE", value="PRESS", x=x, y=y)
        window_.event_simulate(type="LEFTMOUSE", value="RELEASE", x=x, y=y)
        for _ in range(4):
            yield
        if drawn:
            return
    raise AssertionError("no tab shows the add-on's panel")


def story():
    """Yields until the next tick."""
    shown = bpy.context.window_manager.ivory
    scene = bpy.context.scene
    support.room()
    settings = scene.ivory
    settings.folder, settings.name = folder.name, "level"
    settings.grid_by, settings.resolution, settings.photons = "RESOLUTION", (12, 10, 8), "2m"
    with window():
        area = bpy.context.area
        area.spaces[0].show_region_ui = True
        bpy.ops.view3d.view_all()
    yield from open_tab()
    with window():
        assert bpy.ops.ivory.bake_grid("INVOKE_DEFAULT") == {"RUNNING_MODAL"}
    assert shown.running
    assert not bpy.ops.ivory.bake_grid.poll(), "one at a time"
    while not (shown.text.startswith("baking: ") and shown.fraction > 3):
        assert shown.running, shown.said
        ticks.append((time.monotonic(), shown.text))
        yield
    picture("running")
    # Blender had its turns while ivory worked. How many depends on the machine, which draws without a GPU here.
    assert ticks, "Blender waited for ivory"
    bpy.ops.ivory.stop()
    while shown.running:
        yield
    assert shown.said.startswith("ivory: stopped"), shown.said
    assert pathlib.Path(folder.name, "level.checkpoint.vdb").exists()
    with window():
        bpy.ops.ivory.bake_grid("INVOKE_DEFAULT")
    while shown.running:
        yield
    assert shown.said.splitlines()[0].startswith("12 × 10 × 8 vertices"), shown.said
    assert pathlib.Path(folder.name, "level.vdb").exists()
    assert not pathlib.Path(folder.name, "level.checkpoint.vdb").exists()
    for each in bpy.data.objects:
        each.select_set(each.name in ("Room", "Crate"))
    settings.domain = "CORNER"
    with window():
        bpy.ops.ivory.light_on_objects("INVOKE_DEFAULT")
    while shown.running:
        yield
    assert "E at 48 points of 2 objects" in shown.said, shown.said
    yield
    assert {"ivory", "Grid", "Look"} <= set(drawn), drawn  # the others are closed at first
    picture("done")
    # What goes wrong in a modal operator is said in the panel, too.
    settings.photons = "many"
    with window():
        bpy.ops.ivory.bake_grid("INVOKE_DEFAULT")
    while shown.running:
        yield
    assert "--photons: 'many' is not" in shown.said, shown.said


steps = story()


def end(code):
    folder.cleanup()
    sys.stdout.flush()
    os._exit(code)  # Blender asks whether to save otherwise


def tick():
    try:
        next(steps)
    except StopIteration:
        print(f"ok: {len(ticks)} ticks while a bake ran", flush=True)
        end(0)
    except BaseException:
        traceback.print_exc()
        end(1)
    if time.monotonic() - began > 500:
        print("took too long", bpy.context.window_manager.ivory.text, flush=True)
        end(1)
    return 0.1


for data in (bpy.data.objects, bpy.data.meshes):
    for each in list(data):
        data.remove(each)
bpy.data.worlds.remove(bpy.context.scene.world)
support.install()


def watched(panel, fill):
    def draw(self, column, settings):
        fill(self, column, settings)
        drawn.append(panel.bl_label)
    return draw


from ivory_blender import ui  # pylint: disable=wrong-import-position
for panel in ui._classes:
    panel.fill = watched(panel, panel.fill)
bpy.context.preferences.view.show_splash = False
bpy.app.timers.register(tick, first_interval=0.5)
