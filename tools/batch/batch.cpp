// ivory batch: all assets of a job, each when what it depends on has changed.
#include <chrono>
#include <filesystem>
#include <memory>

#include <fcntl.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/file.h>
#include <unistd.h>

#include "grid/base/error.h"
#include "tools/batch/init.h"
#include "tools/batch/report.h"
#include "tools/batch/work/forecast.h"
#include "tools/cli/commands.h"
#include "tools/cli/common.h"
#include "tools/cli/streams.h"

namespace ivory {

namespace fs = std::filesystem;

namespace {

struct BatchOptions {
  std::string job;
  std::vector<std::string> only;
  std::vector<std::string> set;
  std::string init;
  std::string explain;
  std::string log;
  std::uint64_t memory_bytes = 0;
  int jobs = 0;
  bool list = false;
  bool dry_run = false;
  bool keep_going = false;
};

// Keeps a second batch of the same job away, until the process ends.
class JobLock {
 public:
  JobLock(const std::string& path, const std::string& job)
      : file_(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644)) {
    if (file_ < 0) throw Error(path, "cannot be written", "check its folder");
    if (::flock(file_, LOCK_EX | LOCK_NB) != 0)
      throw Error(job, "is being baked by another batch", "wait for it, or give each a job file and output of its own");
  }
  ~JobLock() { ::close(file_); }
  JobLock(const JobLock&) = delete;
  JobLock& operator=(const JobLock&) = delete;

 private:
  int file_;
};

// Moves the process to a folder, and back in the end.
class InFolder {
 public:
  explicit InFolder(const fs::path& folder) : before_(fs::current_path()) {
    if (!folder.empty()) fs::current_path(folder);
  }
  ~InFolder() {
    std::error_code error;
    fs::current_path(before_, error);
  }
  InFolder(const InFolder&) = delete;
  InFolder& operator=(const InFolder&) = delete;

 private:
  fs::path before_;
};

// A job as it was read, with what is known of it. The process moves to the job's folder, which all its paths are
// relative to: a level that is moved as a whole stays fresh.
struct Loaded {
  std::unique_ptr<InFolder> in_folder;
  Job job;
  BatchRecord record;
  std::string record_path;
  std::unique_ptr<Sources> sources;
  std::vector<bool> chosen;
};

Loaded load(const BatchOptions& options) {
  Loaded loaded;
  const std::string origin = fs::current_path().string();
  const JobTree tree = read_job_tree(options.job, options.set, section_kinds());
  loaded.in_folder = std::make_unique<InFolder>(fs::path(options.job).parent_path());
  // The record lies where the assets go, which the job says.
  const std::string output = output_folder(options.job, origin, tree);
  loaded.record_path = (fs::path(output) / (fs::path(options.job).stem().string() + ".batch.json")).string();
  loaded.record = read_record(loaded.record_path);
  loaded.sources = std::make_unique<Sources>(loaded.record.scenes);
  const NodeReader nodes = [&](const std::string& path, const LoadParams& params) {
    return loaded.sources->scene(path, params).nodes;
  };
  loaded.job = make_job(options.job, origin, tree, nodes, /*check_files=*/!options.keep_going);
  std::vector<std::string> only = options.only;
  if (!options.explain.empty()) only = {options.explain};
  loaded.chosen = choose_assets(loaded.job, only);
  return loaded;
}

void list(const BatchOptions& options, const CommonOptions& common) {
  const Loaded loaded = load(options);
  for (const int asset : in_order(loaded.job)) {
    if (loaded.chosen[std::size_t(asset)]) print_stdout(list_line(loaded.job, asset, common.json) + "\n");
  }
}

std::vector<AssetPlan> plan(const Loaded& loaded, const CommonOptions& common) {
  return plan_assets(loaded.job, loaded.chosen, loaded.record, *loaded.sources, common.force);
}

void dry_run(const BatchOptions& options, const CommonOptions& common) {
  const Loaded loaded = load(options);
  const std::vector<AssetPlan> plans = plan(loaded, common);
  const std::vector<nlohmann::ordered_json> forecasts = forecast(loaded.job, plans, loaded.record, common);
  double seconds = 0;
  for (const int asset : in_order(loaded.job)) {
    const auto index = std::size_t(asset);
    if (!plans[index].chosen) continue;
    if (forecasts[index].contains("seconds")) seconds += forecasts[index]["seconds"]["expected"].get<double>();
    print_stdout(plan_line(loaded.job, asset, plans[index], forecasts[index], common.json) + "\n");
  }
  if (seconds > 0) print_note(common, fmt::format("about {:.3g} s in all, one after the other", seconds));
}

void explain(const BatchOptions& options, const CommonOptions& common) {
  const Loaded loaded = load(options);
  const std::vector<AssetPlan> plans = plan(loaded, common);
  for (const int asset : in_order(loaded.job)) {
    const JobAsset& a = loaded.job.assets[std::size_t(asset)];
    if (!is_named(a, options.explain)) continue;
    print_stdout(
        explanation(loaded.job, asset, plans[std::size_t(asset)], find_record(loaded.record, a.name), common.json) +
        "\n");
  }
}

// What is known to fail before anything is baked.
void check_plans(const Job& job, const std::vector<AssetPlan>& plans) {
  for (std::size_t i = 0; i < plans.size(); ++i) {
    if (!plans[i].error.empty())
      throw Error(job.assets[i].name, plans[i].error, "nothing is baked; --keep-going bakes what does not need it");
  }
}

void run(const BatchOptions& options, const CommonOptions& common) {
  const auto start = std::chrono::steady_clock::now();
  const std::string log_path = options.log.empty() ? "" : fs::absolute(options.log).string();
  Loaded loaded = load(options);
  const std::vector<AssetPlan> plans = plan(loaded, common);
  if (!options.keep_going) check_plans(loaded.job, plans);
  std::error_code error;  // then the lock says it
  if (const fs::path folder = fs::path(loaded.record_path).parent_path(); !folder.empty())
    fs::create_directories(folder, error);
  const JobLock lock(loaded.record_path + ".lock", options.job);
  fs::path beside(loaded.record_path);
  BatchLog log(log_path.empty() ? beside.replace_extension(".log").string() : log_path);
  const auto count = std::count(loaded.chosen.begin(), loaded.chosen.end(), true);
  log.write(fmt::format("ivory {} batch {}: {} assets", IVORY_VERSION, options.job, count));

  RunSettings settings;
  settings.side_by_side = options.jobs;
  settings.memory_bytes = double(options.memory_bytes);
  settings.record = loaded.record_path;
  const auto ended = [&](int asset, const AssetOutcome& outcome) {
    const std::string human = outcome_line(loaded.job, asset, outcome, /*json=*/false);
    log.write(human);
    if (common.json) return outcome_line(loaded.job, asset, outcome, /*json=*/true);
    return common.quiet ? std::string() : human;
  };
  const std::vector<AssetOutcome> outcomes =
      run_assets(loaded.job, plans, loaded.record, *loaded.sources, settings, common, log, ended);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const std::string words = summary(plans, outcomes, seconds);
  log.write(words);
  std::vector<std::string> failed;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    if (plans[i].chosen && outcomes[i].state == AssetState::failed) failed.push_back(loaded.job.assets[i].name);
  }
  if (!failed.empty()) {
    constexpr std::size_t most = 5;
    const std::size_t shown = std::min(most, failed.size());
    throw Error(
        options.job,
        fmt::format("{}; failed: {}{}", words, fmt::join(failed.begin(), failed.begin() + std::ptrdiff_t(shown), ", "),
                    failed.size() > shown ? " ..." : ""),
        "see " + log.path());
  }
  if (!common.json && !common.quiet) print_stdout(words + "\n");
}

}  // namespace

void add_batch_command(Command app, CommonOptions& common) {
  Command command = app.add_subcommand("batch", "Bake all assets of a job file whose inputs have changed");
  auto options = std::make_shared<BatchOptions>();
  command.add_option("job", options->job, "Job file: what to bake, from what, and how")
      .required()
      .type_name("LEVEL.toml");
  command
      .add_option("--only", options->only,
                  "Only assets whose name matches, and what they need; * is wild; may be repeated")
      .repeated()
      .type_name("PATTERN");
  command.add_flag("--list", options->list, "Print the assets, in order, and what they need");
  command.add_flag("--dry-run", options->dry_run,
                   "Bake nothing: print what would be baked, why, and what time and memory it would take; bakes to\n"
                   "an error make their pilots for that, unless an earlier run has told the time");
  command.add_option("--explain", options->explain, "Print what has changed of an asset's inputs").type_name("ASSET");
  command.add_flag("--keep-going", options->keep_going,
                   "What is found wrong of an asset before anything is baked, a missing file or a broken scene,\n"
                   "stops those that need it instead of all; what fails later never stops more");
  command.add_option("--init", options->init, "Look into a scene and write a first job file for it").type_name("SCENE");
  command.add_option("--set", options->set, "Another value for one of the job's [variables]; may be repeated")
      .repeated()
      .type_name("NAME=VALUE");
  command.add_count("--side-by-side", options->jobs, 0, 1024,
                    "Assets baked at a time, each on all threads; 0: two, and one more for every 8 threads");
  command.add_count("--max-memory", options->memory_bytes,
                    "Bytes that they may take together, k, m, g are allowed; 0: three quarters of the machine's");
  command.add_option("--log", options->log, "Where to add what happened [LEVEL.batch.log beside the assets]")
      .type_name("FILE");
  command.footer(
      "docs/batch.md says what a job file holds. Options of assets are those of their commands, with '_' for '-'.\n"
      "An asset is baked again when content changes that it depends on: options, meshes, materials, lights, its\n"
      "environment, assets it reads; not when cameras, names or comments do. LEVEL.batch.json beside the assets keeps\n"
      "what they were made from.\n"
      "--json: a line an asset, with asset, state (baked, fresh, failed, skipped) and seconds.\n"
      "\nExamples:\n"
      "  ivory batch level.toml --init level.glb\n"
      "  ivory batch level.toml --dry-run\n"
      "  ivory batch level.toml --only 'grid.*'\n"
      "  ivory batch level.toml --explain grid.hall");
  set_action(command, common, Output::file, [options, &common] {
    const int asked =
        int(options->list) + int(options->dry_run) + int(!options->explain.empty()) + int(!options->init.empty());
    if (asked > 1) throw UsageError("--list, --dry-run, --explain and --init do not go together");
    if (!options->init.empty()) return write_first_job(options->init, options->job, common);
    if (options->list) return list(*options, common);
    if (options->dry_run) return dry_run(*options, common);
    if (!options->explain.empty()) return explain(*options, common);
    run(*options, common);
  });
}

}  // namespace ivory
