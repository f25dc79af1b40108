// The subcommands of ivory, one file each; main.cpp adds them.
#pragma once

namespace CLI {
class App;
}

namespace ivory {

struct CommonOptions;

void add_bake_grid_command(CLI::App& bake, CommonOptions& common);  // `bake` is the `ivory bake` command
void add_bake_cubemap_command(CLI::App& bake, CommonOptions& common);
void add_bake_lobes_command(CLI::App& bake, CommonOptions& common);
void add_bake_spheres_command(CLI::App& bake, CommonOptions& common);
void add_bake_difmap_command(CLI::App& bake, CommonOptions& common);
void add_bake_sh9_command(CLI::App& bake, CommonOptions& common);
void add_bake_fiv_command(CLI::App& bake, CommonOptions& common);
void add_merge_command(CLI::App& app, CommonOptions& common);
void add_render_command(CLI::App& app, CommonOptions& common);
void add_probe_command(CLI::App& app, CommonOptions& common);
void add_compare_command(CLI::App& app, CommonOptions& common);
void add_view_command(CLI::App& app, CommonOptions& common);
void add_info_command(CLI::App& app, CommonOptions& common);
void add_bench_command(CLI::App& app, CommonOptions& common);
void add_chart_command(CLI::App& app, CommonOptions& common);
// `bench` is the `ivory bench` command.
void add_bench_cubemap_command(CLI::App& bench, CommonOptions& common);
void add_bench_fiv_command(CLI::App& bench, CommonOptions& common);
void add_bench_runtime_command(CLI::App& bench, CommonOptions& common);
void add_bench_sh9_command(CLI::App& bench, CommonOptions& common);
void add_bench_stability_command(CLI::App& bench, CommonOptions& common);
void add_bench_gaussians_command(CLI::App& bench, CommonOptions& common);

}  // namespace ivory
