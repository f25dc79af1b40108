#include "grid/io/cubemap.h"

#include <array>
#include <cmath>
#include <optional>

#include "grid/base/anchor.h"
#include "grid/base/error.h"
#include "grid/io/exr.h"

namespace ivory {

namespace {

const std::string kind = "cubemap";
const std::string remedy = "make one with ivory bake cubemap";
const std::vector<std::string> channels{
    "R", "G", "B", "inverse_distance.00", "inverse_distance.10", "inverse_distance.01", "inverse_distance.11"};
constexpr std::int64_t format_version = 1;
const std::array<std::string, 3> place_keys{"position_x_m", "position_y_m", "position_z_m"};

// Where the file was baked, where it states that in double.
std::optional<V3d> far_position(const Metadata& metadata) {
  V3d position;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const auto value = find_number(metadata, place_keys[axis]);
    if (!value || !std::isfinite(*value)) return std::nullopt;
    position[axis] = *value;
  }
  return position;
}

// |q| of a texel's corner k: distance = |q| depth.
double corner_length(int size, int face, int row, int column, int k) {
  return cube_point(face, cube_edge(size, column + k % 2), cube_edge(size, row + k / 2)).length();
}

}  // namespace

void write_localized_cube(const std::string& path, const LocalizedCube& cube, bool force) {
  const int size = cube.radiance.size;
  ExrAsset asset;
  asset.kind = kind;
  asset.width = size;
  asset.height = cube_faces * size;
  asset.channels = channels;
  asset.cube_environment = true;
  asset.metadata = cube.metadata;
  asset.metadata["format_version"] = format_version;
  const V3d position = to_world(cube.origin_m, cube.anchor_m);
  asset.lists["position_m"] = {float(position.x), float(position.y), float(position.z)};
  // Floats do not hold a place far out: there it stands beside them in double.
  if (cube.anchor_m != V3d(0, 0, 0)) {
    for (unsigned axis = 0; axis < 3; ++axis) asset.metadata[place_keys[axis]] = position[axis];
  }
  std::size_t i = 0;
  for (int face = 0; face < cube_faces; ++face) {
    for (int row = 0; row < size; ++row) {
      for (int column = 0; column < size; ++column, ++i) {
        const Rgb& radiance = cube.radiance.texels[i];
        asset.values.insert(asset.values.end(), {radiance.x, radiance.y, radiance.z});
        for (int k = 0; k < 4; ++k) {
          asset.values.push_back(
              float(double(cube.corners[i][std::size_t(k)]) / corner_length(size, face, row, column, k)));
        }
      }
    }
  }
  write_exr(path, asset, ExrPrecision::float32, force);
}

LocalizedCube read_localized_cube(const std::string& path) {
  const ExrAsset asset = read_exr(path, kind, remedy);
  if (find_int(asset.metadata, "format_version") != format_version)
    throw Error(path, "is a cube map of another format version", remedy);
  const auto position = asset.lists.find("position_m");
  if (asset.channels != channels || asset.height != cube_faces * asset.width || position == asset.lists.end() ||
      position->second.size() != 3)
    throw Error(path, "is damaged", remedy);
  if (asset.width > largest_localized_size) {
    throw Error(path,
                "has " + std::to_string(asset.width) + " texels along an edge, more than the " +
                    std::to_string(largest_localized_size) + " that a localized cube map may have",
                remedy);
  }
  LocalizedCube cube;
  cube.origin_m = V3f(position->second[0], position->second[1], position->second[2]);
  cube.metadata = asset.metadata;
  if (const auto far = far_position(asset.metadata)) {
    cube.anchor_m = V3d(std::round(far->x), std::round(far->y), std::round(far->z));
    cube.origin_m = to_local(*far, cube.anchor_m);
  }
  const int size = cube.radiance.size = asset.width;
  const float* value = asset.values.data();
  for (int face = 0; face < cube_faces; ++face) {
    for (int row = 0; row < size; ++row) {
      for (int column = 0; column < size; ++column, value += channels.size()) {
        cube.radiance.texels.emplace_back(value[0], value[1], value[2]);
        TexelCorners v{};
        for (int k = 0; k < 4; ++k)
          v[std::size_t(k)] = float(double(value[3 + k]) * corner_length(size, face, row, column, k));
        cube.corners.push_back(v);
      }
    }
  }
  if (const std::string fault = find_fault(cube); !fault.empty())
    throw Error(path, "is damaged (" + fault + ")", remedy);
  return cube;
}

}  // namespace ivory
