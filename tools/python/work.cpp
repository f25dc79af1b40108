#include "tools/python/work.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <thread>

#include <tbb/global_control.h>

#include "grid/base/error.h"
#include "grid/base/memory.h"

namespace ivory::python {

namespace py = pybind11;

namespace {

// Ends work that nobody wants any more; not an std::exception, so that no library takes it for a failure of its own.
struct Cancelled {};

PyObject* warning_class = nullptr;

}  // namespace

void Job::update(const std::string& stage, double fraction) {
  const std::lock_guard lock(mutex_);
  if (cancelled_) throw Cancelled{};
  if (state_.stage != stage) state_.stage = stage;
  state_.fraction = std::clamp(fraction, 0.0, 1.0);
}

std::function<void(std::uint64_t, std::uint64_t)> Job::counts(const std::string& stage) {
  return [this, stage](std::uint64_t done, std::uint64_t total) {
    update(stage, total > 0 ? double(done) / double(total) : 0);
  };
}

std::function<void(double)> Job::fractions(const std::string& stage) {
  return [this, stage](double fraction) { update(stage, fraction); };
}

std::function<void(const std::string&)> Job::notes() {
  return [this](const std::string& line) { update(line, 0); };
}

void run_job(const std::function<void(Job&)>& work, const py::object& progress, int threads) {
  if (threads < 0 || threads > 1024) throw ParameterError("threads", "it must be from 1 to 1024, or 0 for one a core");
  constexpr std::chrono::milliseconds between_looks{50};
  Job job;
  std::mutex mutex;
  std::condition_variable changed;
  bool done = false;
  std::exception_ptr failure;
  std::exception_ptr raised;  // by Python
  std::thread worker([&] {
    try {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                      std::size_t(threads > 0 ? threads : available_processors()));
      work(job);
    } catch (...) {
      failure = std::current_exception();
    }
    const std::lock_guard lock(mutex);
    done = true;
    changed.notify_one();
  });
  // With the GIL; whatever Python raises ends the work. Progress is told when it is made, and now and then without.
  constexpr std::chrono::seconds longest_silence{1};
  Job::State told;
  auto told_at = std::chrono::steady_clock::now() - longest_silence;
  const auto look = [&](bool finished) {
    if (raised) return;
    try {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      if (progress.is_none()) return;
      const Job::State state = [&] {
        const std::lock_guard lock(job.mutex_);
        return job.state_;
      }();
      const auto now = std::chrono::steady_clock::now();
      const bool news =
          state.stage != told.stage || state.fraction != told.fraction || now - told_at >= longest_silence;
      if (!finished && (state.stage.empty() || !news)) return;
      told = state;
      told_at = now;
      progress(state.stage, finished ? 1.0 : state.fraction);
    } catch (py::error_already_set&) {
      raised = std::current_exception();
      const std::lock_guard lock(job.mutex_);
      job.cancelled_ = true;
    }
  };
  {
    const py::gil_scoped_release free;
    std::unique_lock lock(mutex);
    while (!changed.wait_for(lock, between_looks, [&] { return done; })) {
      lock.unlock();
      {
        const py::gil_scoped_acquire held;
        look(false);
      }
      lock.lock();
    }
    lock.unlock();
    worker.join();
  }
  if (!failure) look(true);
  if (raised) std::rethrow_exception(raised);
  if (failure) std::rethrow_exception(failure);
}

void warn(const std::vector<std::string>& lines) {
  for (const std::string& line : lines) {
    if (PyErr_WarnEx(warning_class, in_one_line(line).c_str(), 1) != 0) throw py::error_already_set();
  }
}

void set_warning_class(PyObject* type) { warning_class = type; }

}  // namespace ivory::python
