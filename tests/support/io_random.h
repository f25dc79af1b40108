// Random sparse grids and sums for the file tests.
#pragma once

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>
#include <string>

#include "grid/field/accumulator.h"
#include "grid/field/irradiance_grid.h"
#include "tests/support/paths.h"

namespace ivory::test {

inline GridFrame random_frame(std::mt19937& rng, bool rotated = true) {
  std::uniform_real_distribution<float> unit(0.1F, 1.0F);
  GridFrame frame;
  frame.size = {5, 9, 12};  // crosses the 8^3 leaves of OpenVDB
  frame.origin_m = {unit(rng) - 3, unit(rng) * 10, unit(rng)};
  frame.spacing_m = {unit(rng), unit(rng), unit(rng)};
  if (rotated) {
    const float a = unit(rng) * 3;
    const float b = unit(rng) * 3;
    const M33f about_z(std::cos(a), std::sin(a), 0, -std::sin(a), std::cos(a), 0, 0, 0, 1);
    const M33f about_x(1, 0, 0, 0, std::cos(b), std::sin(b), 0, -std::sin(b), std::cos(b));
    frame.local_to_world = about_z * about_x;
  }
  return frame;
}

// Two thirds of the vertices store something.
inline std::vector<float> random_visibility(std::mt19937& rng, std::size_t count) {
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<float> visible(count);
  for (float& v : visible) v = unit(rng) < 0.33F ? 0 : 0.01F + 0.99F * unit(rng);
  return visible;
}

inline std::vector<GuardRecord> random_guard(std::mt19937& rng, const std::vector<float>& visible) {
  std::vector<GuardRecord> guard(visible.size());
  for (std::size_t v = 0; v < visible.size(); ++v) {
    for (auto& word : guard[v].words) word = visible[v] > 0 ? std::uint32_t(rng()) : 0;
  }
  return guard;
}

inline IrradianceGrid random_grid(std::uint32_t seed, Basis basis, bool guarded = true) {
  std::mt19937 rng(seed);
  std::normal_distribution<float> normal(0, 10);
  IrradianceGrid grid;
  grid.frame = random_frame(rng);
  grid.basis = basis;
  if (seed % 2 == 1) grid.light = StoredLight::direct_and_indirect;
  const std::size_t count = grid.frame.vertex_count();
  grid.visible_fraction = random_visibility(rng, count);
  if (guarded) grid.guard = random_guard(rng, grid.visible_fraction);
  grid.moments.assign(count * std::size_t(grid.stride()), 0);
  grid.variance.assign(count, Rgb(0, 0, 0));
  for (std::size_t v = 0; v < count; ++v) {
    if (grid.visible_fraction[v] == 0) continue;
    for (int i = 0; i < grid.stride(); ++i) grid.moments[v * std::size_t(grid.stride()) + std::size_t(i)] = normal(rng);
    grid.variance[v] = Rgb(std::abs(normal(rng)), std::abs(normal(rng)), std::abs(normal(rng)));
  }
  grid.metadata = {{"scene_hash", std::string("00ff")}, {"photons", std::int64_t(123456789012345)}, {"albedo", 0.1}};
  return grid;
}

inline GridAccumulator random_sums(std::uint32_t seed, Basis basis, Estimator estimator) {
  std::mt19937 rng(seed);
  std::mt19937_64 bits(seed);
  GridAccumulator sums;
  sums.frame = random_frame(rng);
  sums.basis = basis;
  sums.estimator = estimator;
  const std::size_t count = sums.frame.vertex_count();
  sums.visible_fraction = random_visibility(rng, count);
  sums.guard = random_guard(rng, sums.visible_fraction);
  const auto stride = std::size_t(sum_layout(basis, estimator).stride());
  sums.sums.assign(count * stride, 0);
  for (std::size_t v = 0; v < count; ++v) {
    if (sums.visible_fraction[v] == 0) continue;
    for (std::size_t i = 0; i < stride; ++i) sums.sums[v * stride + i] = std::int64_t(bits()) >> 2;
  }
  sums.quantum = 1.0 / 3.0;
  sums.quantum_squared = 1e-7;
  sums.photon_begin = 10;
  sums.photon_end = 20'000'000'000;
  sums.counters = {{"rays", 1'000'000'000'000}, {"ledger_emitted", 5}};
  sums.metadata = {{"photons", std::int64_t(20'000'000'000)}, {"method", std::string("photons")}};
  return sums;
}

inline std::string read_bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline void write_bytes(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

// A fresh folder for one test.
inline std::filesystem::path scratch_folder(const std::string& name) {
  const auto folder = std::filesystem::path(output_folder) / name;
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

}  // namespace ivory::test
