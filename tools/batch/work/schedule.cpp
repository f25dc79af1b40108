#include "tools/batch/work/schedule.h"

#include <algorithm>
#include <functional>
#include <utility>

namespace ivory {

Schedule::Schedule(std::vector<ScheduleTask> tasks, int most_running, double memory_bytes)
    : tasks_(std::move(tasks)),
      way_(tasks_.size(), -1),
      states_(tasks_.size(), TaskState::waiting),
      most_running_(std::max(1, most_running)),
      memory_bytes_(memory_bytes) {
  std::vector<std::vector<int>> followers(tasks_.size());
  for (std::size_t i = 0; i < tasks_.size(); ++i) {
    for (const int need : tasks_[i].needs) followers[std::size_t(need)].push_back(int(i));
  }
  const std::function<double(int)> way = [&](int task) {
    double& known = way_[std::size_t(task)];
    if (known >= 0) return known;
    double longest = 0;
    for (const int follower : followers[std::size_t(task)]) longest = std::max(longest, way(follower));
    known = tasks_[std::size_t(task)].seconds + longest;
    return known;
  };
  for (std::size_t i = 0; i < tasks_.size(); ++i) way(int(i));
}

std::optional<int> Schedule::start() {
  if (running_ >= most_running_) return std::nullopt;
  std::optional<int> best;
  for (std::size_t i = 0; i < tasks_.size(); ++i) {
    const ScheduleTask& task = tasks_[i];
    if (states_[i] != TaskState::waiting) continue;
    const bool ready = std::all_of(task.needs.begin(), task.needs.end(),
                                   [&](int need) { return states_[std::size_t(need)] == TaskState::done; });
    const bool fits = running_ == 0 || running_bytes_ + task.memory_bytes <= memory_bytes_;
    if (ready && fits && (!best || way_[i] > way_[std::size_t(*best)])) best = int(i);
  }
  if (!best) return best;
  states_[std::size_t(*best)] = TaskState::running;
  ++running_;
  running_bytes_ += tasks_[std::size_t(*best)].memory_bytes;
  return best;
}

std::vector<int> Schedule::finish(int task, bool well) {
  states_[std::size_t(task)] = well ? TaskState::done : TaskState::failed;
  --running_;
  running_bytes_ -= tasks_[std::size_t(task)].memory_bytes;
  std::vector<int> skipped;
  // Until nothing more is found: tasks stand in no order.
  for (bool found = !well; found;) {
    found = false;
    for (std::size_t i = 0; i < tasks_.size(); ++i) {
      if (states_[i] != TaskState::waiting) continue;
      for (const int need : tasks_[i].needs) {
        const TaskState state = states_[std::size_t(need)];
        if (state != TaskState::failed && state != TaskState::skipped) continue;
        states_[i] = TaskState::skipped;
        skipped.push_back(int(i));
        found = true;
        break;
      }
    }
  }
  return skipped;
}

bool Schedule::over() const {
  return std::none_of(states_.begin(), states_.end(),
                      [](TaskState state) { return state == TaskState::waiting || state == TaskState::running; });
}

}  // namespace ivory
