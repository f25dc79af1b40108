"""The world as an environment map, whatever its nodes are: Cycles draws it, all around."""

import math
import os

import bpy
import numpy as np

from .run import Failure

_SAMPLES = 16  # a texel


def _depends_on_path(world):
    trees = [world.node_tree] if world.use_nodes and world.node_tree else []
    return any(node.type == "LIGHT_PATH" for tree in trees for node in tree.nodes)


def write_world(scene, path, width, factor):
    """(path, warnings): an .exr of width x width/2 texels of `factor` times the world's radiance, in ivory's layout.
    The path is None, and no file there, where the scene has no world or a black one."""
    if os.path.exists(path):
        os.remove(path)
    world = scene.world
    if world is None:
        return None, []
    if "cycles" not in bpy.context.preferences.addons:
        raise Failure("the world is drawn by Cycles: enable that add-on, or leave the world out")
    warnings = []
    if _depends_on_path(world):
        warnings.append(f"world '{world.name}' differs by light path: what the camera sees of it is baked")
    drawn = path + ".drawn.exr"
    around = bpy.data.scenes.new("ivory world")
    camera = bpy.data.cameras.new("ivory world")
    eye = bpy.data.objects.new("ivory world", camera)
    try:
        around.world = world
        _set_up(around, camera, eye, width)
        around.render.filepath = drawn
        bpy.ops.render.render(scene=around.name, write_still=True)
    finally:
        bpy.data.objects.remove(eye)
        bpy.data.cameras.remove(camera)
        bpy.data.scenes.remove(around)
    if not os.path.exists(drawn):
        raise Failure(f"{drawn}: Blender did not write it; is the folder writable?")
    try:
        return (path if _keep(drawn, path, factor) else None), warnings
    finally:
        os.remove(drawn)


def _keep(drawn, path, factor):
    """Writes `factor` times the picture without what Cycles says in the file, times among it: the same world, the same
    bytes. False and no file where all of it is black."""
    image = bpy.data.images.load(drawn)
    image.colorspace_settings.name = "Non-Color"
    width, height = image.size
    texels = np.empty(width * height * image.channels, np.float32)
    image.pixels.foreach_get(texels)
    channels = image.channels
    bpy.data.images.remove(image)
    texels = texels.reshape(-1, channels)[:, :3]
    if not texels.any():
        return False
    kept = bpy.data.images.new("ivory world", width, height, alpha=False, float_buffer=True)
    try:
        kept.colorspace_settings.name = "Non-Color"
        kept.pixels.foreach_set(np.concatenate([texels * factor, np.ones((len(texels), 1))], axis=1).astype(np.float32).ravel())
        kept.filepath_raw, kept.file_format = path, "OPEN_EXR"
        kept.save()
    finally:
        bpy.data.images.remove(kept)
    return True


def _set_up(around, camera, eye, width):
    around.collection.objects.link(eye)
    around.camera = eye
    camera.type = "PANO"
    camera.cycles.panorama_type = "EQUIRECTANGULAR"
    # glTF's +Z, Blender's -Y, is in the middle; its +X, Blender's too, to the left.
    eye.rotation_euler = (math.pi / 2, 0, math.pi)
    render = around.render
    render.engine = "CYCLES"
    render.resolution_x, render.resolution_y, render.resolution_percentage = width, width // 2, 100
    image = render.image_settings
    image.file_format, image.color_mode, image.color_depth, image.exr_codec = "OPEN_EXR", "RGB", "32", "NONE"
    cycles = around.cycles
    cycles.device = "CPU"
    cycles.samples, cycles.seed = _SAMPLES, 0
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 1
    render.film_transparent = False
