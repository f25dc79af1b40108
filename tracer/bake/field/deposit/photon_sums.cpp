#include "tracer/bake/field/deposit/photon_sums.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <utility>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace ivory {

namespace {

constexpr std::uint64_t photons_a_batch = 2048;  // about 10,000 segments, small enough to share work out evenly

void add(std::vector<std::int64_t>& total, const std::vector<std::int64_t>& sums) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, sums.size(), 1 << 16), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) total[i] += sums[i];
  });
}

}  // namespace

struct PhotonSums::Worker {
  std::vector<PhotonDepositor> depositors;  // [group]
  std::vector<std::vector<PhotonSegment>> of_group;
  std::vector<PhotonSegment> segments;
  PhotonLedger ledger;
};

PhotonSums::PhotonSums(const PhotonTracer& tracer, DepositTarget target, const LightGroups* groups, int threads)
    : tracer_(tracer), groups_(groups), threads_(threads) {
  const std::size_t count = groups != nullptr ? groups->names.size() : 1;
  targets_.reserve(count);
  targets_.push_back(std::move(target));
  while (targets_.size() < count) targets_.push_back(targets_.front());
}

void PhotonSums::deposit(Worker& worker) const {
  if (groups_ == nullptr) return worker.depositors.front().deposit(worker.segments);
  for (const PhotonSegment& segment : worker.segments)
    worker.of_group[std::size_t(groups_->of_light[std::size_t(segment.light)])].push_back(segment);
  for (std::size_t group = 0; group < targets_.size(); ++group) {
    worker.depositors[group].deposit(worker.of_group[group]);
    worker.of_group[group].clear();
  }
}

std::uint64_t PhotonSums::trace(std::uint64_t begin, std::uint64_t end, const BatchDone& batch_done) {
  // As many of each group: their sums, too, are found in the cache when there are several to add.
  const std::uint64_t batch_photons = photons_a_batch * targets_.size();
  const std::uint64_t batches = (end - begin + batch_photons - 1) / batch_photons;
  // Batches are handed out in order and all that are handed out are finished, so that those done are the first ones.
  std::atomic<std::uint64_t> next{0};
  std::atomic<bool> paused{false};
  std::mutex done_mutex;
  std::uint64_t done = 0;
  std::vector<std::unique_ptr<Worker>> workers(static_cast<std::size_t>(threads_));
  const auto work = [&](std::size_t index) {
    // Made by whoever needs it: memory that nobody touches costs nothing.
    auto own = std::make_unique<Worker>();
    own->depositors.reserve(targets_.size());
    for (DepositTarget& target : targets_) own->depositors.emplace_back(target);
    own->of_group.resize(targets_.size());
    while (!paused.load(std::memory_order_relaxed)) {
      const std::uint64_t batch = next.fetch_add(1, std::memory_order_relaxed);
      if (batch >= batches) break;
      const std::uint64_t first = begin + batch * batch_photons;
      const std::uint64_t last = std::min(first + batch_photons, end);
      own->segments.clear();
      tracer_.trace(first, last, own->segments, own->ledger);
      deposit(*own);
      const std::lock_guard lock(done_mutex);
      done += last - first;
      if (batch_done && batch_done(done)) paused.store(true, std::memory_order_relaxed);
    }
    for (PhotonDepositor& depositor : own->depositors) depositor.settle();
    workers[index] = std::move(own);
  };
  tbb::task_arena arena(threads_);
  arena.execute([&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, workers.size(), 1), [&](const auto& range) {
      for (std::size_t index = range.begin(); index < range.end(); ++index) {
        if (!paused.load(std::memory_order_relaxed) && next.load(std::memory_order_relaxed) < batches) work(index);
      }
    });
  });
  for (const std::unique_ptr<Worker>& worker : workers) {
    if (!worker) continue;
    for (PhotonDepositor& depositor : worker->depositors) depositor.flush();
    ledger_ += worker->ledger;
  }
  return begin + done;
}

void PhotonSums::take(GridAccumulator& out) {
  const DepositTarget& target = targets_.front();
  static_cast<Lattice&>(out) = target.lattice;
  out.basis = target.basis;
  out.estimator = target.estimator;
  out.quantum = target.quantum;
  out.quantum_squared = target.quantum_squared;
  out.sums = take_sums(targets_.front());
  out.groups.clear();
  for (std::size_t group = 0; groups_ != nullptr && group < targets_.size(); ++group) {
    // The first one's are copied, and those of all added up in their place.
    std::vector<std::int64_t> sums = group == 0 ? out.sums : take_sums(targets_[group]);
    if (group != 0) add(out.sums, sums);
    out.groups.push_back({groups_->names[group], std::move(sums)});
  }
  out.counters = {{"ledger_emitted", ledger_.emitted}, {"ledger_absorbed", ledger_.absorbed},
                  {"ledger_escaped", ledger_.escaped}, {"ledger_terminated", ledger_.terminated},
                  {"photons_traced", ledger_.photons}, {"rays_traced", ledger_.rays}};
}

void PhotonSums::put(GridAccumulator& out) {
  if (groups_ == nullptr) {
    put_sums(targets_.front(), std::exchange(out.sums, {}));
  } else {
    std::vector<std::int64_t>().swap(out.sums);
    for (std::size_t group = 0; group < targets_.size(); ++group)
      put_sums(targets_[group], std::move(out.groups[group].sums));
    out.groups.clear();
  }
  const auto counter = [&](const char* name) {
    const auto found = out.counters.find(name);
    return found == out.counters.end() ? std::int64_t(0) : found->second;
  };
  ledger_ = {.emitted = counter("ledger_emitted"),
             .absorbed = counter("ledger_absorbed"),
             .escaped = counter("ledger_escaped"),
             .terminated = counter("ledger_terminated"),
             .photons = counter("photons_traced"),
             .rays = counter("rays_traced")};
}

}  // namespace ivory
