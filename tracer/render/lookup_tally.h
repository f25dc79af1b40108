// What came of a grid's look-ups: how many found no vertex that sees their point, and so read 0, and how many asked for
// a point outside the grid, for which its nearest vertices answer.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <thread>

namespace ivory {

// Counts from any thread; threads seldom meet in one cache line.
class LookupTally {
 public:
  void add(bool seen, bool covered) {
    Slot& slot = slots_[std::hash<std::thread::id>{}(std::this_thread::get_id()) % slots_.size()];
    slot.lookups.fetch_add(1, std::memory_order_relaxed);
    if (!seen) slot.unseen.fetch_add(1, std::memory_order_relaxed);
    if (!covered) slot.outside.fetch_add(1, std::memory_order_relaxed);
  }
  std::int64_t lookups() const { return sum(&Slot::lookups); }
  std::int64_t unseen() const { return sum(&Slot::unseen); }
  std::int64_t outside() const { return sum(&Slot::outside); }

 private:
  struct alignas(64) Slot {
    std::atomic<std::int64_t> lookups{0};
    std::atomic<std::int64_t> unseen{0};
    std::atomic<std::int64_t> outside{0};
  };
  std::int64_t sum(std::atomic<std::int64_t> Slot::*count) const {
    std::int64_t all = 0;
    for (const Slot& slot : slots_) all += slot.*count;
    return all;
  }
  std::array<Slot, 64> slots_;
};

}  // namespace ivory
