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
    for method, series, label in (("a grid, 32 vertices along the longest side, 8 M photons", "grid, 32 vertices", "8m"),
                                  ("a grid, 16 vertices, 500 k photons", "grid, 16 vertices", "500k"),
                                  ("a photon map, 300 k photons (to compare with)", "photon map, 50 neighbours", "300k")):
        here = [r for r in grids if r["series"] == series and r["label"] == label]
        if not here:
            continue
        ratios = {h["panel"]: path_tracing_seconds([r for r in grids if r["panel"] == h["panel"]], h["nrmse"]) / h["time_s"] for h in here}
        indoors = [ratio for panel, ratio in ratios.items() if panel != OUTDOORS]
        longer = f"path tracing to that error takes {span(indoors, lambda x: tables.number(x, 2))} times as long in rooms"
        if OUTDOORS in ratios:
            longer += f", {tables.number(ratios[OUTDOORS], 2)} times in the {OUTDOORS}"
        found.append((f"indirect light of {len(here)} scenes from {method}", span([r["nrmse"] for r in here], tables.percent),
                      f"{span([r['time_s'] for r in here], tables.seconds)} for bake and picture of 240×180; {longer}"))
    return found


def leak_rows(records):
    sweeps = [p for r in records if r["curve"] == "stability" and r["panel"] in ("wall_thickness", "wall_angle") for p in r["points"]]
    if not sweeps:
        return []
    worst = {s: tables.percent(max(p["error"] for p in sweeps if p["series"] == s)) for s in ("no guard", "planes", "rays")}
    return [("light that leaks through walls of 0.1 mm to 30 cm, at any angle", f"at most {worst['rays']} by rays, {worst['planes']} by "
             f"planes; {worst['no guard']} without guard", "planes: 16 bytes a vertex; rays: the scene at hand")]


def rate_rows(records):
    return [("photon segments traced and deposited a second", "", "; ".join(
        f"{s['segments_per_s'] / 1e6:.1f} M among {s['triangles']:,} triangles, {s['embree_ratio']:.2f} of Embree's bare ray rate"
        for s in r["result"]["scenes"])) for r in records if r["curve"] == "rates" and r["panel"] == "photons"]


def occluder_rows(records):
    planes = [r for r in records if r["curve"] == "fiv" and r.get("samples") == "64,33,30" and r["series"] == "six hemispheres"
              and r["panel"].endswith(", floating")]
    soft = [r["nrmse"] for r in planes if r["light"] != "one hard light"]
    hard = [r["nrmse"] for r in planes if r["light"] == "one hard light"]
    if not soft:
        return []
    error = span(soft, tables.percent) + (f"; {tables.percent(hard[0])} under one hard light" if hard else "")
    bench = next((r["result"] for r in records if r["curve"] == "rates" and r["panel"] == "occluder tables"), {})
    cost = (f"{tables.seconds(bench['bake_s'])} for a table of 128×65×30 samples, {tables.seconds(bench['rays_s'])} by a ray a sample and light"
            if "rays_s" in bench else "")
    return [(f"shadows of moving objects under {len(soft)} environments, FIV table of 64×33×30 samples", error, cost)]


def cube_rows(records):
    near = {r["series"]: tables.percent(r["nrmse"]) for r in records
            if r["curve"] == "cubemap" and r["panel"] == "ball at the wall, 4x4" and r["label"] == "0.01 m"}
    if "polygon" not in near:
        return []
    return [("an object 1 cm from a wall, one 4×4 cube map", f"{near['polygon']} by texels as polygons; {near['convolved']} by a convolved "
             f"map, {near['point']} by texels as points", "")]


def lobe_rows(records):
    lobes = [r for r in records if r["curve"] == "lobes" and r["panel"] == "matt plane, truth: the same 64 spheres"]
    best = min((r for r in lobes if r["series"] == "lobes, 64 spheres, by mask depth"), key=lambda r: r["nrmse"], default=None)
    rays = max((r for r in lobes if r["series"] == "shadow rays on the spheres"), key=lambda r: int(r["label"]), default=None)
    if not best or not rays:
        return []
    return [("soft shadows of 64 spheres by cosine lobes", f"{tables.percent(best['nrmse'])}, no noise; {rays['label']} shadow rays: "
             f"{tables.percent(rays['nrmse'])}", f"{tables.seconds(best['time_s'])}; {rays['label']} shadow rays: {tables.seconds(rays['time_s'])}")]


def distant_rows(records):
    sh9 = [r for r in records if r["curve"] == "sh9"]
    nine = [r["nrmse"] for r in sh9 if r["series"] == "SH" and r["label"] == "order 2"]
    maps = [r["nrmse"] for r in sh9 if r["series"] == "irradiance map" and r["label"] == "64"]
    if not nine or not maps:
        return []
    return [(f"distant light of {len(nine)} environments (RMS error over mean E)", f"{span(nine, tables.percent)} by nine coefficients, "
             f"{span(maps, tables.percent)} by irradiance maps of 64² faces", "")]


def stability_rows(records):
    cases = [r for r in records if r["curve"] == "stability"]
    if not cases:
        return []
    within = sum(r["within_bounds"] for r in cases)
    return [("places where methods fail", f"{len(cases)} swept, {within} within their bounds", "")]


def table(records):
    rows = [row for part in (indirect_rows, leak_rows, rate_rows, occluder_rows, cube_rows, lobe_rows, distant_rows, stability_rows)
            for row in part(records)]
    return tables.markdown(("what", "error", "cost"), rows)
