// The subcommands of ivory, one file each; main.cpp adds them.
#pragma once

namespace ivory {

class Command;
struct CommonOptions;

void add_bake_grid_command(Command bake, CommonOptions& common);  // `bake` is the `ivory bake` command
void add_bake_cubemap_command(Command bake, CommonOptions& common);
void add_bake_lightmap_command(Command bake, CommonOptions& common);
void add_bake_lobes_command(Command bake, CommonOptions& common);
void add_bake_spheres_command(Command bake, CommonOptions& common);
void add_bake_difmap_command(Command bake, CommonOptions& common);
void add_bake_sh9_command(Command bake, CommonOptions& common);
void add_bake_fiv_command(Command bake, CommonOptions& common);
void add_batch_command(Command app, CommonOptions& common);
void add_merge_command(Command app, CommonOptions& common);
void add_mix_command(Command app, CommonOptions& common);
void add_export_command(Command app, CommonOptions& common);
void add_render_command(Command app, CommonOptions& common);
void add_probe_command(Command app, CommonOptions& common);
void add_points_command(Command app, CommonOptions& common);
void add_compare_command(Command app, CommonOptions& common);
void add_view_command(Command app, CommonOptions& common);
void add_info_command(Command app, CommonOptions& common);
void add_bench_command(Command app, CommonOptions& common);
void add_chart_command(Command app, CommonOptions& common);
// `bench` is the `ivory bench` command.
void add_bench_cubemap_command(Command bench, CommonOptions& common);
void add_bench_fiv_command(Command bench, CommonOptions& common);
void add_bench_runtime_command(Command bench, CommonOptions& common);
void add_bench_sh9_command(Command bench, CommonOptions& common);
void add_bench_stability_command(Command bench, CommonOptions& common);
void add_bench_gaussians_command(Command bench, CommonOptions& common);

}  // namespace ivory
