"""The whole suite in one table: what each method does, and how well."""
import tables
from grid import path_tracing_seconds


OUTDOORS = "sunlit garden"


def span(values, form):
    low, high = form(min(values)), form(max(values))
    return low if low == high else f"{low} to {high}"


def indirect_rows(records):
    grids = [r for r in records if r["curve"] == "grid"]
    found = []
    for method, series, label, text in (
            ("a grid of irradiance vectors, 32 vertices along the longest side, 8 M photons", "grid, 32 vertices", "8m", "bake and picture"),
            ("the same, 16 vertices, 500 k photons", "grid, 16 vertices", "500k", "bake and picture"),
            ("a photon map with precomputed irradiance, 300 k photons", "photon map, 50 neighbours", "300k", "map and picture")):
        here = [r for r in grids if r["series"] == series and r["label"] == label]
        if not here:
            continue
        ratios = {h["panel"]: path_tracing_seconds([r for r in grids if r["panel"] == h["panel"]], h["nrmse"]) / h["time_s"] for h in here}
        indoors = [ratio for panel, ratio in ratios.items() if panel != OUTDOORS]
        longer = f"path tracing to the same error takes {span(indoors, lambda x: tables.number(x, 2))} times as long"
        if OUTDOORS in ratios:
            longer += f" in rooms, {tables.number(ratios[OUTDOORS], 2)} times in the {OUTDOORS}"
        found.append((f"indirect light from {method}, {len(here)} scenes",
                      f"NRMSE {span([r['nrmse'] for r in here], tables.percent)}; {text} of 240×180 in "
                      f"{span([r['time_s'] for r in here], tables.seconds)}; {longer}"))
    return found


def leak_rows(records):
    sweeps = [p for r in records if r["curve"] == "stability" and r["panel"] in ("wall_thickness", "wall_angle") for p in r["points"]]
    if not sweeps:
        return []
    worst = {s: max(p["error"] for p in sweeps if p["series"] == s) for s in ("no guard", "planes", "rays")}
    return [("light leaking through walls of 0.1 mm to 30 cm, at any angle", f"at most {tables.percent(worst['rays'])} with rays, "
             f"{tables.percent(worst['planes'])} with the 16 bytes a vertex stored in the file; {tables.percent(worst['no guard'])} without guard")]


def rate_rows(records):
    found = []
    for r in records:
        if r["curve"] == "rates" and r["panel"] == "photons":
            scenes = r["result"]["scenes"]
            found.append(("photon segments traced and deposited a second, two cores", "; ".join(
                f"{s['segments_per_s'] / 1e6:.1f} M among {s['triangles']:,} triangles, {s['embree_ratio']:.2f} of Embree's bare ray rate"
                for s in scenes)))
    return found


def occluder_rows(records):
    planes = [r for r in records if r["curve"] == "fiv" and "samples" in r]
    here = [r for r in planes if r["panel"].endswith(", floating") and r["series"] == "six hemispheres" and r["samples"] == "64,33,30"
            and r["light"] != "one hard light"]
    if not here:
        return []
    text = f"NRMSE {span([r['nrmse'] for r in here], tables.percent)} over a plane, {len(here)} environments"
    hard = [r for r in planes if r["panel"] == "one hard light, floating" and r["series"] == "six hemispheres" and r["samples"] == "64,33,30"]
    if hard:
        text += f", {tables.percent(hard[0]['nrmse'])} under one hard light"
    bench = next((r["result"] for r in records if r["curve"] == "rates" and r["panel"] == "occluder tables"), {})
    if "rays_s" in bench:
        text += (f"; a table of 128×65×30 samples takes {tables.seconds(bench['bake_s'])} where a ray a sample and light takes "
                 f"{tables.seconds(bench['rays_s'])}")
    return [("shadows of moving objects under an environment map, table of 64×33×30 samples", text)]


def cube_rows(records):
    near = {r["series"]: r["nrmse"] for r in records if r["curve"] == "cubemap" and r["panel"] == "ball at the wall, 4x4" and r["label"] == "0.01 m"}
    if "polygon" not in near:
        return []
    return [("objects 1 cm from a wall, from one 4×4 cube map", f"NRMSE {tables.percent(near['polygon'])} by texels as polygons; "
             f"{tables.percent(near['convolved'])} by an ordinary convolved map, {tables.percent(near['point'])} by texels as points")]


def lobe_rows(records):
    lobes = [r for r in records if r["curve"] == "lobes" and r["panel"] == "matt plane, truth: the same 64 spheres"]
    best = min((r for r in lobes if r["series"] == "lobes, 64 spheres, by mask depth"), key=lambda r: r["nrmse"], default=None)
    rays = max((r for r in lobes if r["series"] == "shadow rays on the spheres"), key=lambda r: int(r["label"]), default=None)
    if not best or not rays:
        return []
    return [("soft shadows of 64 spheres by cosine lobes, without noise", f"NRMSE {tables.percent(best['nrmse'])} in {tables.seconds(best['time_s'])}; "
             f"{rays['label']} shadow rays: {tables.percent(rays['nrmse'])} in {tables.seconds(rays['time_s'])}")]


def distant_rows(records):
    sh9 = [r for r in records if r["curve"] == "sh9"]
    nine = [r["nrmse"] for r in sh9 if r["series"] == "SH" and r["label"] == "order 2"]
    maps = [r["nrmse"] for r in sh9 if r["series"] == "irradiance map" and r["label"] == "64"]
    if not nine or not maps:
        return []
    return [(f"distant light of {len(nine)} environments", f"RMS error over mean E {span(nine, tables.percent)} by nine coefficients, "
             f"{span(maps, tables.percent)} by irradiance maps of 64² faces")]


def stability_rows(records):
    cases = [r for r in records if r["curve"] == "stability"]
    if not cases:
        return []
    within = sum(r["within_bounds"] for r in cases)
    return [("places where methods fail", f"{len(cases)} swept, each a test with its bound; {within} within their bounds")]


def table(records):
    rows = [row for part in (indirect_rows, leak_rows, rate_rows, occluder_rows, cube_rows, lobe_rows, distant_rows, stability_rows)
            for row in part(records)]
    return tables.markdown(("what", "measured"), rows)
