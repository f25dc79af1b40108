// Long work that Python asks for: the interpreter is free meanwhile, and Ctrl-C or the caller's own function end it.
#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/pybind11.h>

namespace ivory::python {

// The work's side: what it hands to the libraries as their progress functions. Each throws where the caller has had
// enough; the libraries let it pass. To be called from any thread.
class Job {
 public:
  std::function<void(std::uint64_t done, std::uint64_t total)> counts(const std::string& stage);
  std::function<void(double fraction)> fractions(const std::string& stage);
  std::function<void(const std::string& line)> notes();

 private:
  friend void run_job(const std::function<void(Job&)>&, const pybind11::object&, int);
  struct State {
    std::string stage;
    double fraction = 0;
  };
  void update(const std::string& stage, double fraction);

  std::mutex mutex_;
  State state_;
  bool cancelled_ = false;
};

// Runs `work` in a thread of its own, held to `threads` (0: one a core), and waits for it. `progress` is None or a
// function of (stage: str, fraction: float), called from the caller's thread, at most twenty times a second and when
// the work is done. What that raises, and KeyboardInterrupt, ends the work at its next progress and is raised here; so
// is what the work throws. The caller holds the GIL, the work does not.
void run_job(const std::function<void(Job&)>& work, const pybind11::object& progress, int threads);

// The same for work that answers something.
template <typename Work>
auto run(const pybind11::object& progress, int threads, const Work& work) {
  std::optional<decltype(work(std::declval<Job&>()))> result;
  run_job([&](Job& job) { result.emplace(work(job)); }, progress, threads);
  return std::move(*result);
}

// Says each line as a Python warning (ivory.Warning), which the caller's filters may turn into an exception.
void warn(const std::vector<std::string>& lines);
// The class of those; set when the module is made, and never released.
void set_warning_class(PyObject* type);

}  // namespace ivory::python
