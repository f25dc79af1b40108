// Checkpoints: what a long bake has done so far, kept beside its output, and gone on from after whatever stopped it.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>

#include "grid/base/metadata.h"

namespace ivory {

// What happened to a checkpoint. `done` of `total` photons (or whatever the bake counts) stand in it.
struct CheckpointEvent {
  enum class Kind {
    resumed,   // the bake goes on from it
    replaced,  // one that was there is of another bake or damaged: this one starts anew, and will overwrite it
    writing,   // it is about to be
    written,
    failed,  // it could not be written: the bake goes on without, and tries again
  };
  Kind kind = Kind::written;
  std::string line;  // for people
  std::uint64_t done = 0;
  std::uint64_t total = 0;
  double seconds = 0;  // that writing it took, all threads waiting
};

// A checkpoint belongs to one bake: the same scene, parameters, seed and version of ivory, all of which it holds; the
// number of threads may be another.
struct CheckpointPolicy {
  std::string path;  // of the file; empty: none is read or written
  double every_s =
      300;  // from one to the next, and a hundred times as long as the last took to write where that is more
  // What the caller alone knows: its version, the files of scene and environment. Kept in the checkpoint, and to be the
  // same where a bake goes on from it.
  Metadata origin;
  // What is done with a checkpoint of another bake, or a damaged one: it is given up (an event says so), or an Error.
  bool replace = false;
  // Asked many times a second while photons fly, from any thread, one at a time. True: the bake is left within a batch
  // of photons of each thread and the time that a checkpoint takes to write, by BakeStopped. Null: never.
  std::function<bool()> stop = nullptr;
  std::function<void(const CheckpointEvent&)> on_event = nullptr;  // from the thread that called the baker
};

// The bake was asked to stop, and its checkpoint is written. what() says so in a line, and how to go on.
class BakeStopped : public std::runtime_error {
 public:
  BakeStopped(const std::string& path, std::uint64_t done, std::uint64_t total, const std::string& unit);
};

// When the next is due.
class CheckpointClock {
 public:
  explicit CheckpointClock(double every_s) : every_s_(every_s) {}
  bool is_due() const { return seconds_since(last_) >= wait_s_; }
  // To be called before one is written, and after: returns the seconds that it took.
  void begin() { began_ = Clock::now(); }
  double end();

  // Of the time between two, writing one takes so much at most.
  static constexpr double most_share = 0.01;

 private:
  using Clock = std::chrono::steady_clock;
  static double seconds_since(Clock::time_point then) {
    return std::chrono::duration<double>(Clock::now() - then).count();
  }

  double every_s_;
  double wait_s_ = every_s_;
  Clock::time_point last_ = Clock::now();
  Clock::time_point began_ = last_;
};

}  // namespace ivory
