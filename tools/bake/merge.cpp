// ivory merge: partial bakes into one, exactly.
#include <algorithm>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "grid/base/error.h"
#include "tools/bake/grid/result.h"
#include "tools/cli/commands.h"
#include "tools/cli/common.h"
#include "tools/input/vdb/load.h"
#include "tracer/bake/field/grid_checkpoint.h"

namespace ivory {

namespace {

struct MergeOptions {
  std::vector<std::string> parts;
  std::string output;
};

// Where a part's photons begin; 0 where the file does not say, which reading it then refuses.
std::int64_t photon_begin(const std::string& path) { return find_int(load_vdb_info(path), "photon_begin").value_or(0); }

// Checkpoints are parts, too.
GridAccumulator load_part(const std::string& path) {
  GridAccumulator part = load_accumulator_vdb(path);
  std::erase_if(part.metadata, [](const auto& entry) { return entry.first.starts_with(checkpoint_prefix); });
  return part;
}

void run_merge(const MergeOptions& options, const CommonOptions& common) {
  check_output(options.output, ".vdb", common);
  // In order of their photons and one after the other, so that two parts at most are in memory.
  std::vector<std::pair<std::int64_t, std::string>> order;
  for (const std::string& part : options.parts) order.emplace_back(photon_begin(part), part);
  std::stable_sort(order.begin(), order.end(), [](const auto& a, const auto& b) { return a.first < b.first; });

  GridAccumulator total = load_part(order[0].second);
  for (std::size_t i = 1; i < order.size(); ++i) {
    std::vector<GridAccumulator> two;
    two.push_back(std::move(total));
    two.push_back(load_part(order[i].second));
    total = merge(std::move(two), {order[i - 1].second, order[i].second});
  }
  const bool whole = is_whole(total);
  std::string missing;
  const auto photons = std::uint64_t(find_int(total.metadata, "photons").value_or(0));
  if (total.photon_begin > 0) missing = fmt::format("0:{}", total.photon_begin);
  if (total.photon_end < photons)
    missing += fmt::format("{}{}:{}", missing.empty() ? "" : " and ", total.photon_end, photons);
  auto result = write_result(options.output, std::move(total), whole, common);
  result["parts"] = options.parts.size();
  result["complete"] = whole;
  std::string text = result_text(result);
  if (!whole) {
    result["missing"] = missing;
    text += "photons " + missing + " are still missing: merge this file with the other parts to finish the grid\n";
  }
  print_result(common, result, text);
}

}  // namespace

void add_merge_command(Command app, CommonOptions& common) {
  Command command = app.add_subcommand("merge", "Add up partial bakes (bake grid --photon-range) into one file");
  auto options = std::make_shared<MergeOptions>();
  command.add_option("parts", options->parts, "Parts of one bake, in any order").required().type_name("PART.vdb");
  command.add_option("-o,--output", options->output, "File to write, .vdb").required().type_name("OUT.vdb");
  command.footer(
      "Once the parts hold every photon of the bake, the output is the finished grid, to the byte what one\n"
      "machine would have baked; until then it is a larger part.\n"
      "\nExample:\n"
      "  ivory bake grid room.glb -o a.vdb --photons 16m --photon-range 0:8m\n"
      "  ivory bake grid room.glb -o b.vdb --photons 16m --photon-range 8m:16m\n"
      "  ivory merge a.vdb b.vdb -o room.vdb\n"
      "  ivory bake grid room.glb -o part-$I.vdb --photons 1g --shards 64 --shard $I   (I from 0 to 63, anywhere)\n"
      "  ivory merge part-*.vdb -o room.vdb");
  set_action(command, common, Output::file, [options, &common] { run_merge(*options, common); });
}

}  // namespace ivory
