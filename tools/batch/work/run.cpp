#include "tools/batch/work/run.h"

#include <algorithm>
#include <condition_variable>
#include <filesystem>
#include <set>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "grid/base/error.h"
#include "grid/base/memory.h"
#include "tools/batch/state/freshness.h"
#include "tools/batch/work/asset_host.h"
#include "tools/batch/work/predict.h"
#include "tools/batch/work/schedule.h"
#include "tools/batch/work/stop.h"
#include "tools/cli/interrupt.h"
#include "tools/cli/program.h"
#include "tools/cli/streams.h"
#include "tools/input/shared.h"

namespace ivory {

namespace fs = std::filesystem;

namespace {

using Clock = std::chrono::steady_clock;

const std::string stopped = "stopped; the same command goes on from there, grids from their checkpoints";
// What was asked to stop is waited for as long as what is never asked (tools/cli/interrupt.h).
constexpr std::chrono::milliseconds patience{1800};

class Runner {
 public:
  Runner(const Job& job, const std::vector<AssetPlan>& plans, BatchRecord& record, Sources& sources,
         const RunSettings& settings, const CommonOptions& common, BatchLog& log, const OutcomeListener& ended)
      : job_(job),
        record_(record),
        sources_(sources),
        settings_(settings),
        common_(common),
        log_(log),
        ended_(ended),
        outcomes_(job.assets.size()),
        done_(job.assets.size(), false),
        plans_(plans),
        board_(common, seconds(plans)),
        schedule_(tasks(plans), side_by_side(), limit_bytes()) {
    for (std::size_t i = 0; i < plans.size(); ++i) done_[i] = !plans[i].chosen;
  }

  std::vector<AssetOutcome> run() {
    std::vector<std::thread> threads;
    for (int i = 0; i < side_by_side(); ++i) threads.emplace_back([this] { work(); });
    for (std::thread& thread : threads) thread.join();
    if (broken_) std::rethrow_exception(broken_);
    return std::move(outcomes_);
  }

 private:
  int side_by_side() const {
    return settings_.side_by_side > 0 ? settings_.side_by_side : 2 + thread_count(common_) / 8;
  }
  double limit_bytes() const {
    return settings_.memory_bytes > 0 ? settings_.memory_bytes : 0.75 * available_memory_bytes();
  }

  AssetCost cost(std::size_t asset) const {
    return cost_of(job_.assets[asset], find_record(record_, job_.assets[asset].name), thread_count(common_),
                   limit_bytes());
  }

  // What is fresh takes no time; below 0 for what is not chosen.
  std::vector<double> seconds(const std::vector<AssetPlan>& plans) const {
    std::vector<double> all;
    for (std::size_t i = 0; i < plans.size(); ++i)
      all.push_back(!plans[i].chosen ? -1 : plans[i].stale ? cost(i).seconds : 0);
    return all;
  }

  std::vector<ScheduleTask> tasks(const std::vector<AssetPlan>& plans) const {
    const std::vector<double> times = seconds(plans);
    std::vector<ScheduleTask> tasks;
    for (std::size_t i = 0; i < plans.size(); ++i) {
      ScheduleTask task;
      // What is not chosen is there to keep the numbers: it ends at once, and nothing that is chosen needs it.
      if (plans[i].chosen) task = {job_.assets[i].needs, times[i], cost(i).memory_bytes};
      tasks.push_back(std::move(task));
    }
    return tasks;
  }

  // One of the threads that make assets.
  void work() {
    std::unique_lock lock(mutex_);
    while (!schedule_.over() && !broken_) {
      if (stop_.asked()) leave(lock);
      const std::optional<int> task = schedule_.start();
      if (!task) {
        changed_.wait(lock);
        continue;
      }
      try {
        const bool well = make(*task, lock);
        close(*task, well);
      } catch (...) {
        broken_ = std::current_exception();  // the record, or standard output, cannot be written
      }
      changed_.notify_all();
    }
  }

  // With the lock, but while the command runs.
  bool make(int index, std::unique_lock<std::mutex>& lock) {
    const JobAsset& asset = job_.assets[std::size_t(index)];
    AssetOutcome& outcome = outcomes_[std::size_t(index)];
    const AssetPlan& plan = plans_[std::size_t(index)];
    if (!plan.chosen) return true;
    if (!plan.error.empty()) {
      outcome = {AssetState::failed, 0, {}, {}, plan.error};
      return false;
    }
    AssetInputs inputs;
    try {
      inputs = inputs_of(asset, sources_, std::vector<bool>(job_.assets.size(), false));
      outcome.reasons = reasons_to_bake(asset, inputs, find_record(record_, asset.name), sources_);
    } catch (const std::exception& error) {
      outcome.state = AssetState::failed;
      outcome.error = error.what();
      return false;
    }
    if (outcome.reasons.empty()) {
      outcome.state = AssetState::fresh;
      return true;
    }
    AssetRecord& known = record_.assets[asset.name];
    known.inputs = std::move(inputs);
    known.outputs.clear();
    known.finished = false;
    save();
    log_.write(fmt::format("{}: begins: {}", asset.name, fmt::join(outcome.reasons, "; ")));
    board_.start(index, asset.name);

    lock.unlock();
    AssetHost host(asset.name, index, board_, log_, stop_, common_.quiet);
    host.inputs = &shared_;
    const Clock::time_point start = Clock::now();
    const ProgramEnd end = run_command(asset, host);
    outcome.seconds = std::chrono::duration<double>(Clock::now() - start).count();
    lock.lock();

    stop_.ended(index);
    if (end.exit_code == interrupted_exit_code() && stop_.asked()) {
      log_.write(asset.name + ": " + end.message);
      leave(lock);
    }
    outcome.warnings = host.warnings();
    if (end.exit_code != 0) {
      outcome.state = AssetState::failed;
      outcome.error = end.message;
      return false;
    }
    outcome.state = AssetState::baked;
    AssetRecord& made = record_.assets[asset.name];
    for (const std::string& output : asset.outputs) {
      sources_.forget(output);
      made.outputs.emplace_back(output, sources_.hash(output));
    }
    made.seconds = outcome.seconds;
    made.memory_bytes = host.planned_memory_bytes();
    made.finished = true;
    save();
    return true;
  }

  // Ends the process once nothing saves that could. What else is being made has nothing to lose but its own begun work:
  // outputs are there whole or not at all, and the record says which are.
  [[noreturn]] void leave(std::unique_lock<std::mutex>& lock) {
    constexpr std::chrono::milliseconds glance{20};
    const Clock::time_point until = Clock::now() + patience;
    while (stop_.any(Stoppable::saving) || (stop_.any(Stoppable::yes) && Clock::now() < until))
      changed_.wait_for(lock, glance);
    log_.write(stopped);
    board_.end();
    print_stderr("ivory: " + stopped + "\n");
    ::_exit(interrupted_exit_code());
  }

  ProgramEnd run_command(const JobAsset& asset, AssetHost& host) const {
    for (const std::string& output : asset.outputs) {
      std::error_code error;  // then the command says it
      if (const fs::path folder = fs::path(output).parent_path(); !folder.empty())
        fs::create_directories(folder, error);
    }
    std::vector<std::string> arguments = arguments_of(asset);
    arguments.push_back("--force");  // plan_assets() has asked whose the file is
    if (common_.threads > 0) arguments.push_back(fmt::format("--threads={}", common_.threads));
    return run_hosted(arguments, host);
  }

  void save() {
    for (auto& [key, facts] : sources_.facts()) record_.scenes[key] = facts;
    write_record(settings_.record, record_);
  }

  void close(int index, bool well) {
    const std::vector<int> skipped = schedule_.finish(index, well);
    end(index);
    for (const int other : skipped) {
      AssetOutcome& outcome = outcomes_[std::size_t(other)];
      outcome.state = AssetState::skipped;
      for (const int need : job_.assets[std::size_t(other)].needs) {
        const TaskState state = schedule_.state(need);
        if (state == TaskState::failed || state == TaskState::skipped)
          outcome.error = fmt::format("it needs {}, which was not baked", job_.assets[std::size_t(need)].name);
      }
      end(other);
    }
    // What nobody needs any more is given up.
    std::set<std::string> needed;
    for (std::size_t i = 0; i < done_.size(); ++i) {
      if (done_[i]) continue;
      for (const JobInput& input : job_.assets[i].inputs) needed.insert(input.path);
    }
    shared_.keep_only(needed);
  }

  void end(int index) {
    done_[std::size_t(index)] = true;
    board_.finish(index);
    if (!plans_[std::size_t(index)].chosen) return;
    const std::string line = ended_(index, outcomes_[std::size_t(index)]);
    if (!line.empty()) board_.say(line, /*on_stdout=*/true);
  }

  const Job& job_;
  BatchRecord& record_;
  Sources& sources_;
  const RunSettings& settings_;
  const CommonOptions& common_;
  BatchLog& log_;
  const OutcomeListener& ended_;
  std::vector<AssetOutcome> outcomes_;
  std::vector<bool> done_;
  const std::vector<AssetPlan>& plans_;
  Board board_;
  Schedule schedule_;
  SharedInputs shared_;
  BatchStop stop_{"ivory: " + stopped};
  std::mutex mutex_;
  std::condition_variable changed_;
  std::exception_ptr broken_;
};

}  // namespace

std::vector<AssetOutcome> run_assets(const Job& job, const std::vector<AssetPlan>& plans, BatchRecord& record,
                                     Sources& sources, const RunSettings& settings, const CommonOptions& common,
                                     BatchLog& log, const OutcomeListener& ended) {
  return Runner(job, plans, record, sources, settings, common, log, ended).run();
}

}  // namespace ivory
