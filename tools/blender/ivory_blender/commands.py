"""Command lines of ivory, from what the panel says."""

from . import axes, preferences, settings as kept


def _numbers(values):
    return ",".join(format(float(value), ".9g") for value in values)


def box_options(box):
    """--bounds and --rotate-y of an object."""
    low, high, degrees = axes.grid_box(box)
    turn = ["--rotate-y", format(degrees, ".9g")] if degrees != 0 else []
    return [f"--bounds={_numbers(low)}:{_numbers(high)}"] + turn


def _bake(kind, context, source, output):
    settings = context.scene.ivory
    command = [preferences.program(), "bake", kind, source, "-o", output] + preferences.common_options()
    return command + (["--force"] if settings.overwrite else [])


def grid_size(settings):
    """Options that say how fine a grid is, as (option, value); a batch takes the same."""
    if settings.grid_by == "ERROR":
        return [("target_error", f"{settings.target_error:.6g}%")]
    x, y, z = settings.resolution
    size = [("resolution", [x, z, y])] if settings.grid_by == "RESOLUTION" else [("voxel_size", float(f"{settings.spacing:.6g}"))]
    return size + ([("photons", settings.photons)] if settings.photons else [])


def bake_grid(context, scene, world, output, dry_run):
    settings = context.scene.ivory
    command = _bake("grid", context, scene, output)
    for option, value in grid_size(settings):
        text = ",".join(map(str, value)) if isinstance(value, list) else str(value)
        command += ["--" + option.replace("_", "-"), text]
    if settings.bounds is not None:
        command += box_options(settings.bounds)
    if world:
        command += ["--env", world, "--layout", "latlong"]
    if settings.direct:
        command.append("--direct")
    if dry_run:
        command.append("--dry-run")
    return command


def bake_sh9(context, world, output):
    return _bake("sh9", context, world, output) + ["--layout", "latlong"]


def bake_lightmap(context, scene, world, grid, output):
    settings = context.scene.ivory
    command = _bake("lightmap", context, scene, output)
    command += ["--grid", grid, "--size", f"{settings.lightmap_size}x{settings.lightmap_size}",
                "--samples", str(settings.lightmap_samples), "--gather", str(settings.lightmap_gather)]
    if settings.lightmap_indirect:
        command.append("--indirect-only")
    return command + (["--env", world, "--layout", "latlong"] if world else [])


def probe(context, source, scene, world, points, output):
    """E at points: of a grid, with the scene for its guard, or path-traced where the source is the scene."""
    command = [preferences.program(), "probe", source, "--points", points, "-o", output, "--force"]
    command += preferences.common_options()
    if source != scene:
        return command + ["--scene", scene]
    command += ["--samples", str(context.scene.ivory.path_samples)]
    return command + (["--env", world, "--layout", "latlong"] if world else [])


def batch_list(job):
    return [preferences.program(), "batch", job, "--list"]


def files(settings):
    """Where everything goes."""
    names = {"scene": ".glb", "world": ".world.exr", "grid": ".vdb", "sh9": ".sh9.json", "lightmap": ".lightmap.exr",
             "job": ".toml"}
    return {kind: kept.path(settings, extension) for kind, extension in names.items()}
