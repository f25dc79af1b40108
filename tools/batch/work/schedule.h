// In which order tasks run, which side by side, and what a failure stops: decisions alone, without threads.
#pragma once

#include <optional>
#include <vector>

namespace ivory {

struct ScheduleTask {
  std::vector<int> needs;  // tasks that must be done before; no rings
  double seconds = 1;      // that it takes, about
  double memory_bytes = 0;
};

enum class TaskState { waiting, running, done, failed, skipped };

class Schedule {
 public:
  // At most `most_running` tasks at a time that together take at most `memory_bytes`; one alone may take more.
  Schedule(std::vector<ScheduleTask> tasks, int most_running, double memory_bytes);

  // The task to start now, which counts as running from here on: of those whose needs are done and that fit, the one
  // with the longest way to the end after it. Nothing while all have to wait.
  std::optional<int> start();
  // A running task has ended. Returns the tasks that can never run because they need it, which are skipped now.
  std::vector<int> finish(int task, bool well);

  TaskState state(int task) const { return states_[std::size_t(task)]; }
  bool over() const;  // nothing waits or runs

 private:
  std::vector<ScheduleTask> tasks_;
  std::vector<double> way_;  // [task] seconds of it and of the longest chain that waits for it
  std::vector<TaskState> states_;
  int most_running_;
  double memory_bytes_;
  int running_ = 0;
  double running_bytes_ = 0;
};

}  // namespace ivory
