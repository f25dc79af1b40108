"""A job file for "ivory batch": what the panel would bake."""

import json
import os

from . import axes, commands


def _value(value):
    """In TOML, whose texts, numbers and lists JSON's are too."""
    return json.dumps(value, ensure_ascii=False)


def _section(name, values):
    return f"\n[{name}]\n" + "".join(f"{key} = {_value(value)}\n" for key, value in values)


def _has_charts(context):
    meshes = [each for each in context.scene.objects if each.type == "MESH" and not each.hide_render and
              each != context.scene.ivory.bounds]
    return bool(meshes) and all(len(each.data.uv_layers) > 1 for each in meshes)


def text(context, files, world):
    """Of the job; `world`: its environment map, or None."""
    settings = context.scene.ivory
    names = {kind: os.path.basename(path) for kind, path in files.items()}
    out = "# What the Blender add-on bakes of this scene: ivory batch, in this folder. docs/batch.md says what else may stand here.\n"
    out += _section("job", [("output", ".")])
    out += _section("scene.level", [("file", names["scene"])])
    light = [("env", "world")] if world else []
    if world:
        out += _section("environment.world", [("file", names["world"]), ("layout", "latlong")])
    grid = [("scene", "level"), ("output", names["grid"])] + commands.grid_size(settings) + light
    if settings.bounds is not None:
        low, high, degrees = axes.grid_box(settings.bounds)
        grid.append(("bounds", [[float(f"{x:.9g}") for x in corner] for corner in (low, high)]))
        if degrees != 0:
            grid.append(("rotate_y", float(f"{degrees:.9g}")))
    if settings.direct:
        grid.append(("direct", True))
    out += _section("grid.level", grid)
    if world:
        out += _section("sh9.world", [("environment", "world"), ("output", names["sh9"])])
    if _has_charts(context):
        size = [settings.lightmap_size, settings.lightmap_size]
        out += _section("lightmap.level", [
            ("scene", "level"), ("grid", "grid.level"), ("output", names["lightmap"]), ("size", "x".join(map(str, size))),
            ("samples", settings.lightmap_samples), ("gather", settings.lightmap_gather)] + light +
            ([("indirect_only", True)] if settings.lightmap_indirect else []))
    return out
