"""Rates beside their bounds, and what a frame of the OpenGL runtime costs."""
import os

import tables
from steps import File, Point, Step

TITLE = "How near the limits"
ABOUT = """What each inner loop could do at best, and the share of it that is reached: Embree's own rate on the very same rays, the
memory's for adding pixels up, one occlusion ray a sample and light for occluder tables. Frames of the runtime fill 640×480 pixels; constant
ambient light, textures and all, is the unit. Measured side by side within one process, in turn."""


def points(suite, inputs, runner):
    full = suite == "full"
    environment = inputs.environments(suite).get("drachenfels_cellar", File(inputs.bundled("sky.hdr")))
    benches = {
        "photons": Step(("bench", "tracer", File(inputs.bundled("cornell_box.gltf")), *(() if full else ("--photons", "200k")))),
        "look-ups": Step(("bench", "lookup", File(inputs.bundled("room_boxes_rotated.gltf")))),
        "SH9": Step(("bench", "sh9")),
        "occluder tables": Step(("bench", "fiv", File(inputs.occluder()), "--env", environment, "--samples",
                                 "64,33,30" if full else "32,17,15", *(("--times",) if full else ()))),
        "frames": Step(("bench", "runtime", File(inputs.bundled("knot.glb")), "--env", File(inputs.bundled("sky.hdr")), "--rounds",
                        5 if full else 3)),
    }
    for name, step in benches.items():
        def measure(run, step=step):
            return {"result": run.result(step)}

        yield Point("rates", name, "bench", "all", [step], measure)


def rates(records):
    """(what, figure, its bound, share of the bound or None) of all benches."""
    rows = []
    for r in records:
        result = r["result"]
        if r["panel"] == "photons":
            for s in result["scenes"]:
                rows.append((f"photon segments traced and deposited, {os.path.basename(s['scene'])}, {s['triangles']:,} triangles",
                             f"{s['segments_per_s'] / 1e6:.2f} M/s", f"Embree's closest hits on the same rays: "
                             f"{s['embree_rays_per_s'] / 1e6:.2f} M/s", s["embree_ratio"]))
        elif r["panel"] == "look-ups":
            for guard, name in (("off", "no guard"), ("planes", "stored planes"), ("rays", "rays")):
                for way, key in (("by itself", "lookup"), ("of many at once", "batched")):
                    rows.append((f"one look-up {way}, {name}", f"{result[f'{key}_{guard}_ns']:.0f} ns",
                                 f"one short occlusion ray: {result['occlusion_ray_ns']:.0f} ns", None))
        elif r["panel"] == "SH9":
            rows.append((f"SH9 of {result['width']}×{result['height']} pixels", f"{result['projection_gb_per_s']:.1f} GB/s",
                         f"adding the pixels up: {result['sum_gb_per_s']:.1f} GB/s", 1 / result["ratio"]))
        elif r["panel"] == "occluder tables":
            rows.append(("one occluder at one receiver", f"{result['read_six_ns']:.0f} ns",
                         f"one occlusion ray: {result['occlusion_ray_ns']:.0f} ns", None))
            if "rays_s" in result:
                rows.append(("occluder table, 128×65×30 samples, 6×32×32 lights", f"{result['bake_s']:.1f} s",
                             f"one occlusion ray a sample and light: {result['rays_s']:.1f} s ({result['rays_s'] / result['bake_s']:.0f} "
                             "times as long)", None))
    return rows


def draw(records, figures):
    shares = [(what, 100 * share) for what, _, _, share in rates(records) if share is not None]
    if shares:
        figures.bars("rates_bounds", "Share of the bound that is reached", [("", "%", False, shares)])
    for r in records:
        if r["panel"] == "frames":
            figures.bars("rates_frames", f"Frames of the OpenGL runtime: {r['result']['opengl']}",
                         [("", "time of a frame ÷ constant ambient light", True,
                           [(m["method"], m["over_constant"]) for m in r["result"]["methods"]])])


def page_tables(records):
    found = [("Rates", ("what", "measured", "bound", "share"), [(a, b, c, "–" if d is None else f"{d:.2f}") for a, b, c, d in rates(records)], ())]
    for r in records:
        if r["panel"] == "frames":
            result = r["result"]
            found.append(("Frames", ("method", "ms", "÷ constant"), [(m["method"], tables.number(m["frame_ms"]), tables.number(m["over_constant"]))
                                                                    for m in (*result["methods"], *result["sizes"])], ()))
            found.append(("Loading", ("asset", "ms", "GPU memory"), [(a["asset"], tables.number(a["load_ms"]), tables.size(a["gpu_bytes"]))
                                                                     for a in result["loading"]], ()))
    return found


def markdown_tables(records):
    found = {}
    if any(r["panel"] != "frames" for r in records):
        found["rates"] = tables.markdown(("what", "measured", "bound"), [row[:3] for row in rates(records)])
    for r in records:
        if r["panel"] == "frames":
            result = r["result"]
            found["frames"] = tables.markdown(("ambient light from", "ms a frame", "÷ constant"), [
                (m["method"], tables.number(m["frame_ms"], 2), tables.number(m["over_constant"], 2)) for m in result["methods"]])
            found["loading"] = tables.markdown(("asset", "loaded in", "GPU memory"), [
                (a["asset"], tables.seconds(a["load_ms"] / 1000), tables.size(a["gpu_bytes"])) for a in result["loading"]])
    return found
