#include "tracer/bake/field/deposit/target.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include <tbb/parallel_for.h>

#include "grid/base/error.h"
#include "tracer/bake/field/deposit/huge_pages.h"
#include "tracer/bake/field/deposit/units.h"

namespace ivory {

namespace {

// A photon 2^h times as heavy as the unit's adds 2^(18 + fine_bits + 2 h) to a second moment, of which 2^58 is left
// room for 32. Photons beyond h = 18 are not reckoned with: of 10^11 one may come (tracer/lights/entry_discs.cpp: it
// starts 500 radii away), and its error is then understated.
int coarser_bits(float power_lm, float heaviest_lm, int fine_bits) {
  if (!(heaviest_lm > power_lm) || !(power_lm > 0)) return 0;
  const int h = std::min(18, int(std::ceil(std::log2(double(heaviest_lm) / double(power_lm)))));
  return std::max(0, 18 + fine_bits + 2 * h - 58);
}

}  // namespace

double own_bytes(std::size_t vertices, const SumLayout& layout, int fine_bits) {
  return double(vertices) * layout.slots * double(cell_lanes(std::size_t(layout.lanes()))) * (fine_bits != 0 ? 2 : 1) *
         sizeof(std::int32_t);
}

DepositBuffers choose_buffers(std::size_t vertices, const SumLayout& layout, int fine_bits) {
  return own_bytes(vertices, layout, fine_bits) > most_own_bytes ? DepositBuffers::shared : DepositBuffers::own;
}

void check_estimator(const Lattice& lattice, Estimator estimator) {
  if (lattice.levels() == 1 || estimator == Estimator::track) return;
  throw ParameterError("estimator", "'" + std::string(name_of(estimator)) +
                                        "' works in grids of one spacing only; several levels take 'track'");
}

DepositTarget make_deposit_target(const Lattice& lattice, Basis basis, Estimator estimator, float power_lm,
                                  std::vector<std::uint64_t> cell_masks, int fine_bits, float heaviest_lm,
                                  DepositBuffers buffers) {
  check_estimator(lattice, estimator);
  DepositTarget target;
  target.lattice = lattice;
  target.buffers = buffers;
  const GridFrame& frame = lattice.frame;
  target.basis = basis;
  target.estimator = estimator;
  target.layout = sum_layout(basis, estimator);
  const double mean_spacing_m = (double(frame.spacing_m.x) + double(frame.spacing_m.y) + double(frame.spacing_m.z)) / 3;
  const double unit = double(power_lm) * (estimator == Estimator::track ? mean_spacing_m : 1.0);
  target.quantum = std::ldexp(unit, -18 - fine_bits);
  target.quantum_squared = std::ldexp(unit * unit, -18 - fine_bits + coarser_bits(power_lm, heaviest_lm, fine_bits));
  target.fine_bits = fine_bits;
  // Powers are at most about 2^18 coarse units over a voxel: far from float's limits either way.
  const double scale = std::ldexp(1.0, fine_bits);
  target.units_a_lm = static_cast<float>(1 / (target.quantum * scale));
  target.to_second = static_cast<float>(target.quantum * target.quantum * scale / target.quantum_squared);
  target.cell_masks = std::move(cell_masks);
  assert(target.cell_masks.size() == lattice.vertex_count());
  target.sums.reserve(lattice.vertex_count() * std::size_t(target.layout.stride()));
  ask_for_huge_pages(target.sums.data(), target.sums.capacity() * sizeof(std::int64_t));
  target.sums.assign(lattice.vertex_count() * std::size_t(target.layout.stride()), 0);
  return target;
}

int fine_bits(const Lights::PhotonPower& power) {
  return power.weakest_lm < 0x1p-6F * power.strongest_lm ? max_fine_bits : 0;
}

namespace {

// Calls copy(place in [vertex][slot], place in the target's own order) for every slot of every vertex.
template <typename Copy>
void for_each_slot(const DepositTarget& target, const Copy& copy) {
  const auto lanes = std::size_t(target.layout.lanes());
  const auto slots = std::size_t(target.layout.slots);
  tbb::parallel_for(std::size_t(0), target.cell_masks.size(), [&](std::size_t v) {
    for (std::size_t slot = 0; slot < slots; ++slot)
      copy(std::ptrdiff_t((v * slots + slot) * lanes), std::ptrdiff_t(target.lane_index(slot, v)));
  });
}

}  // namespace

std::vector<std::int64_t> take_sums(DepositTarget& target) {
  std::vector<std::int64_t> own = std::exchange(target.sums, {});
  if (target.buffers == DepositBuffers::shared) return own;
  const auto lanes = std::size_t(target.layout.lanes());
  std::vector<std::int64_t> by_vertex(own.size());
  for_each_slot(target, [&](std::ptrdiff_t at, std::ptrdiff_t own_at) {
    std::copy_n(own.begin() + own_at, lanes, by_vertex.begin() + at);
  });
  return by_vertex;
}

void put_sums(DepositTarget& target, std::vector<std::int64_t> by_vertex) {
  target.sums = std::move(by_vertex);
  if (target.buffers == DepositBuffers::shared) return;
  const auto lanes = std::size_t(target.layout.lanes());
  std::vector<std::int64_t> own(target.sums.size());
  for_each_slot(target, [&](std::ptrdiff_t at, std::ptrdiff_t own_at) {
    std::copy_n(target.sums.begin() + at, lanes, own.begin() + own_at);
  });
  target.sums = std::move(own);
}

GridAccumulator to_accumulator(DepositTarget target) {
  GridAccumulator out;
  static_cast<Lattice&>(out) = std::move(target.lattice);
  out.basis = target.basis;
  out.estimator = target.estimator;
  out.quantum = target.quantum;
  out.quantum_squared = target.quantum_squared;
  out.sums = take_sums(target);
  return out;
}

namespace {

template <std::size_t functions>
void set_lanes(const DepositTarget& target, const Rgb& power_lm, const float* f, float measure, SegmentLanes& lanes) {
  const Rgb scaled = power_lm * (measure * target.units_a_lm);
  for (unsigned c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < functions; ++i) lanes.values[3 * i + c] = scaled[c] * f[i];
    lanes.values[3 * functions + c] = scaled[c] * scaled[c] * target.to_second;
  }
}

}  // namespace

SegmentLanes track_lanes(const DepositTarget& target, const V3f& w, const Rgb& power_lm) {
  SegmentLanes lanes;
  if (target.layout.slots == 8) {
    lanes.slot = (w.x < 0 ? 1U : 0U) | (w.y < 0 ? 2U : 0U) | (w.z < 0 ? 4U : 0U);
    const std::array<float, 3> functions{std::abs(w.x), std::abs(w.y), std::abs(w.z)};
    set_lanes<3>(target, power_lm, functions.data(), 1, lanes);
  } else if (target.layout.functions == 4) {
    set_lanes<4>(target, power_lm, eval(target.basis, w).data(), 1, lanes);
  } else {
    assert(target.layout.functions == 9);
    set_lanes<9>(target, power_lm, eval(target.basis, w).data(), 1, lanes);
  }
  return lanes;
}

SegmentLanes face_lanes(const DepositTarget& target, const V3f& w, const Rgb& power_lm, unsigned axis) {
  SegmentLanes lanes;
  lanes.slot = 2 * axis + (w[axis] > 0 ? 0 : 1);
  const std::array<float, 3> functions{w.x, w.y, w.z};
  set_lanes<3>(target, power_lm, functions.data(), target.estimator == Estimator::face ? 1 / std::abs(w[axis]) : 1,
               lanes);
  return lanes;
}

}  // namespace ivory
