#include "grid/field/evidence.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

namespace ivory {

namespace {

// Photons at a vertex whose sums begin at `sums`; 0 for none. The sum of x = flux times length (or flux) is read from
// the first moments: from that of the constant function, or from the length of each slot's vector, which for light
// from many directions comes out up to a seventh too short.
double photons_at(const GridAccumulator& accumulator, const SumLayout& layout, const std::int64_t* sums) {
  const double constant = layout.slots == 1 ? double(eval(accumulator.basis, V3f(0, 0, 1))[0]) : 0;
  double most = 0;
  for (int c = 0; c < 3; ++c) {
    double first = 0;
    double second = 0;
    for (int slot = 0; slot < layout.slots; ++slot) {
      const std::int64_t* lanes = sums + slot * layout.lanes();
      if (layout.slots == 1) {
        first += double(lanes[c]) / constant;
      } else {
        first += V3d(double(lanes[c]), double(lanes[3 + c]), double(lanes[6 + c])).length();
      }
      second += double(lanes[3 * layout.functions + c]);
    }
    if (first == 0 && second == 0) continue;
    // Second moments too small for their quanta come out as 0: then the photons are many, each of next to no weight,
    // or one of a weak channel, which is a photon all the same.
    const double squares = std::max(second, 1.0) * accumulator.quantum_squared;
    most = std::max({most, 1.0, std::pow(first * accumulator.quantum, 2) / squares});
  }
  return most;
}

}  // namespace

Evidence evidence(const GridAccumulator& accumulator) {
  const SumLayout layout = sum_layout(accumulator.basis, accumulator.estimator);
  assert(accumulator.sums.size() == accumulator.visible_fraction.size() * std::size_t(layout.stride()));
  Evidence out;
  std::vector<double> met;
  for (std::size_t vertex = 0; vertex < accumulator.visible_fraction.size(); ++vertex) {
    if (accumulator.visible_fraction[vertex] <= 0) continue;
    ++out.vertices;
    const double photons =
        photons_at(accumulator, layout, accumulator.sums.data() + vertex * std::size_t(layout.stride()));
    if (photons == 0) {
      ++out.unmet;
      continue;
    }
    if (photons < few_photons) ++out.few;
    met.push_back(photons);
  }
  if (met.empty()) return out;
  const auto middle = met.begin() + std::ptrdiff_t(met.size() / 2);
  std::nth_element(met.begin(), middle, met.end());
  out.median = *middle;
  return out;
}

// A photon of power P that crosses a cell from face to face, each of area A, adds P / A to the E of a receiver that
// faces it, and all N of them are divided by N: for light from one direction along the cell's longest side this is the
// rule of three, for other light it is more than that.
std::optional<float> unmet_bound_lux(const IrradianceGrid& grid) {
  const auto photons = find_int(grid.metadata, "photons_traced");
  if (!photons || *photons <= 0) return std::nullopt;
  // Of photons on their way to the grid, where they differ from the others; else the mean of all, in whichever channel
  // it may be.
  std::optional<double> power_lm = find_number(grid.metadata, "photon_power_lm");
  if (!power_lm) {
    const auto emitted = find_int(grid.metadata, "ledger_emitted");
    const auto unit_lm = find_number(grid.metadata, "ledger_unit_lm");
    if (!emitted || !unit_lm) return std::nullopt;
    power_lm = double(*emitted) * *unit_lm / double(*photons);
  }
  const V3f& h = grid.frame.spacing_m;
  const double face_m2 = std::min({double(h.x) * double(h.y), double(h.y) * double(h.z), double(h.z) * double(h.x)});
  return float(3 * *power_lm / face_m2 / double(*photons));
}

}  // namespace ivory
