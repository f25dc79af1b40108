#include "grid/io/vdb/layout.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "grid/base/anchor.h"
#include "grid/base/error.h"

namespace ivory {

namespace {

constexpr std::array<std::string_view, 6> axis_names{"px", "mx", "py", "my", "pz", "mz"};
constexpr std::array<std::string_view, 9> harmonic_names{"L00",  "L1m1", "L10", "L11", "L2m2",
                                                         "L2m1", "L20",  "L21", "L22"};
constexpr std::array<char, 3> channel_names{'r', 'g', 'b'};

// Three consecutive functions as the components of one grid a colour channel.
void add_channels(std::vector<VectorField>& fields, const std::string& name, int first_function, bool is_vector) {
  for (int channel = 0; channel < 3; ++channel) {
    const int first = first_function * 3 + channel;
    fields.push_back({name + "_" + channel_names[std::size_t(channel)], is_vector, {first, first + 3, first + 6}});
  }
}

void add_rgb(std::vector<VectorField>& fields, std::string name, int function) {
  fields.push_back({std::move(name), false, {function * 3, function * 3 + 1, function * 3 + 2}});
}

}  // namespace

std::string level_suffix(int level) { return level == 0 ? "" : "_level" + std::to_string(level); }

std::string in_group(const std::string& group, const std::string& grid_name) {
  return group.empty() ? grid_name : group + "_" + grid_name;
}

std::string guard_name(int half) { return "guard_" + std::to_string(half); }

std::array<float, 6> floats_from_guard(const GuardRecord& record) {
  std::array<float, 6> floats{};
  for (unsigned i = 0; i < 6; ++i) {
    const unsigned bit = 24 * i;
    std::uint64_t window = record.words[bit / 32];
    if (bit / 32 + 1 < 4) window |= std::uint64_t(record.words[bit / 32 + 1]) << 32U;
    floats[i] = float((window >> (bit % 32)) & 0xFFFFFFU);
  }
  return floats;
}

std::optional<GuardRecord> guard_from_floats(const std::array<float, 6>& floats) {
  GuardRecord record;
  for (unsigned i = 0; i < 6; ++i) {
    const float most = i < 5 ? 0x1p24F : 0x1p8F;  // 128 = 5 * 24 + 8
    if (!(floats[i] >= 0 && floats[i] < most) || floats[i] != std::floor(floats[i])) return std::nullopt;
    const unsigned bit = 24 * i;
    const std::uint64_t window = std::uint64_t(floats[i]) << (bit % 32);
    record.words[bit / 32] |= std::uint32_t(window);
    if (bit / 32 + 1 < 4) record.words[bit / 32 + 1] |= std::uint32_t(window >> 32U);
  }
  return record;
}

int file_stride(Basis basis) { return basis == Basis::vectors ? 54 : function_count(basis) * 3; }

std::vector<float> file_values_from_moments(Basis basis, std::span<const float> moments) {
  if (basis != Basis::vectors) return {moments.begin(), moments.end()};
  std::vector<float> values;
  values.reserve(moments.size() / 36 * 54);
  for (std::size_t at = 0; at < moments.size(); at += 36) {
    const auto hemispheres = hemispheres_from_moments(std::span<const float, 36>(moments.data() + at, 36));
    values.insert(values.end(), hemispheres.begin(), hemispheres.end());
  }
  return values;
}

std::vector<float> moments_from_file_values(Basis basis, const std::vector<float>& values) {
  if (basis != Basis::vectors) return values;
  std::vector<float> moments;
  moments.reserve(values.size() / 54 * 36);
  for (std::size_t at = 0; at < values.size(); at += 54) {
    const auto vertex = moments_from_hemispheres(std::span<const float, 54>(values.data() + at, 54));
    moments.insert(moments.end(), vertex.begin(), vertex.end());
  }
  return moments;
}

std::vector<VectorField> vector_fields(Basis basis) {
  std::vector<VectorField> fields;
  switch (basis) {
    case Basis::vectors:
      for (int hemisphere = 0; hemisphere < 6; ++hemisphere)
        add_channels(fields, "I_" + std::string(axis_names[std::size_t(hemisphere)]), hemisphere * 3, true);
      break;
    case Basis::vectors9:
      add_channels(fields, "F", 0, true);
      add_channels(fields, "S", 3, false);  // S and C change sign or mix under rotation unlike any vector
      add_channels(fields, "C", 6, false);
      break;
    case Basis::ambient_cube:
      for (int function = 0; function < 6; ++function)
        add_rgb(fields, "E_" + std::string(axis_names[std::size_t(function)]), function);
      break;
    case Basis::sh9:
    case Basis::sh4:
      for (int function = 0; function < function_count(basis); ++function)
        add_rgb(fields, std::string(harmonic_names[std::size_t(function)]), function);
      break;
  }
  return fields;
}

std::vector<std::string> sum_field_names(const SumLayout& layout) {
  std::vector<std::string> names;
  for (int slot = 0; slot < layout.slots; ++slot) {
    for (int function = 0; function <= layout.functions; ++function) {
      const std::string number = function == layout.functions ? "square" : std::to_string(function);
      for (const char channel : channel_names)
        names.push_back("sum_" + std::to_string(slot) + "_" + number + "_" + channel);
    }
  }
  return names;
}

std::array<double, 16> transform_matrix(const PlacedFrame& placed) {
  const GridFrame& frame = placed.frame;
  std::array<double, 16> m{};
  for (int row = 0; row < 3; ++row) {
    // Products of floats are exact in double.
    for (int column = 0; column < 3; ++column) {
      m[4 * std::size_t(row) + std::size_t(column)] =
          double(frame.spacing_m[row]) * double(frame.local_to_world[row][column]);
    }
    m[12 + std::size_t(row)] = double(frame.origin_m[row]) + placed.anchor_m[row];
  }
  m[15] = 1;
  return m;
}

PlacedFrame frame_from_transform(const std::string& path, const std::array<double, 16>& matrix,
                                 const PlacedFrame& stored) {
  const auto refuse = [&](const std::string& cause) {
    return Error(path, "its transform " + cause, "only moving, rotating and even scaling keep a grid readable");
  };
  const std::array<double, 16> expected = transform_matrix(stored);
  double largest = 0;
  double difference = 0;
  for (std::size_t i = 0; i < 16; ++i) {
    if (!std::isfinite(matrix[i])) throw refuse("is not finite");
    largest = std::max(largest, std::abs(expected[i]));
    difference = std::max(difference, std::abs(matrix[i] - expected[i]));
  }
  if (difference <= 1e-12 * largest) return stored;  // OpenVDB keeps simple maps as scales and shifts

  GridFrame frame = stored.frame;
  std::array<V3d, 3> axis;
  double least_scale = std::numeric_limits<double>::infinity();
  double greatest_scale = 0;
  for (int row = 0; row < 3; ++row) {
    const double* entries = matrix.data() + 4 * row;
    V3d& a = axis[std::size_t(row)];
    a = V3d(entries[0], entries[1], entries[2]);
    const double length = a.length();
    if (!(length > 0)) throw refuse("is flat");
    a /= length;
    frame.spacing_m[row] = float(length);
    for (int column = 0; column < 3; ++column) frame.local_to_world[row][column] = float(a[column]);
    const double scale = length / double(stored.frame.spacing_m[row]);
    least_scale = std::min(least_scale, scale);
    greatest_scale = std::max(greatest_scale, scale);
  }
  constexpr double tolerance = 1e-4;  // other programs keep such matrices in float
  if (std::abs(axis[0].dot(axis[1])) > tolerance || std::abs(axis[1].dot(axis[2])) > tolerance ||
      std::abs(axis[2].dot(axis[0])) > tolerance)
    throw refuse("is sheared");
  if (axis[0].cross(axis[1]).dot(axis[2]) < 0) throw refuse("is mirrored");
  if (greatest_scale > least_scale * (1 + tolerance)) throw refuse("is stretched unevenly");
  const V3d corner(matrix[12], matrix[13], matrix[14]);
  const V3d reach = V3d(frame.direction_to_world((V3f(frame.size) - V3f(1, 1, 1)) * frame.spacing_m)) * 0.5;
  const V3d anchor_m = choose_anchor(corner + reach, reach.length());
  frame.origin_m = to_local(corner, anchor_m);
  return {frame, anchor_m};
}

}  // namespace ivory
