// A scene whose surfaces all lie in planes across the axes, with charts for a lightmap: one a plane and connected
// surface.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>
#include <vector>

#include "tracer/core/scene.h"

namespace ivory {

// Gives each mesh, placed where it stands, TEXCOORD_1 in one atlas of size x size texels: charts begin and end on whole
// texels, `margin` apart. Answers the texels a metre, the most that fit.
inline double unwrap_planes(const std::vector<Mesh*>& meshes, int size, int margin) {
  struct Chart {
    Mesh* mesh = nullptr;
    std::vector<std::size_t> triangles;
    unsigned across = 0;
    V3f low, high;
  };
  std::vector<Chart> charts;
  for (Mesh* mesh : meshes) {
    // Triangles of one plane that share a corner's place belong together.
    std::vector<int> owner(mesh->triangles.size());
    std::iota(owner.begin(), owner.end(), 0);
    const auto root = [&](int i) {
      while (owner[std::size_t(i)] != i) i = owner[std::size_t(i)];
      return i;
    };
    using Place = std::array<long, 3>;
    const auto place = [](const V3f& p) {
      return Place{std::lround(p.x * 1e4), std::lround(p.y * 1e4), std::lround(p.z * 1e4)};
    };
    std::map<std::tuple<unsigned, bool, long, Place>, int> at;
    std::vector<unsigned> axis_of(mesh->triangles.size());
    for (std::size_t t = 0; t < mesh->triangles.size(); ++t) {
      const auto& corners = mesh->triangles[t];
      const V3f& a = mesh->positions[corners.x];
      const V3f n = (mesh->positions[corners.y] - a).cross(mesh->positions[corners.z] - a);
      const unsigned axis = std::abs(n.x) > std::abs(n.y) ? (std::abs(n.x) > std::abs(n.z) ? 0U : 2U)
                                                          : (std::abs(n.y) > std::abs(n.z) ? 1U : 2U);
      axis_of[t] = axis;
      for (unsigned i = 0; i < 3; ++i) {
        const V3f& p = mesh->positions[corners[i]];
        const auto [found, is_new] =
            at.emplace(std::tuple(axis, n[axis] > 0, std::lround(p[axis] * 1e4), place(p)), int(t));
        if (!is_new) owner[std::size_t(root(int(t)))] = root(found->second);
      }
    }
    std::map<int, Chart> own;
    for (std::size_t t = 0; t < mesh->triangles.size(); ++t) {
      Chart& chart = own[root(int(t))];
      chart.mesh = mesh;
      chart.across = axis_of[t];
      for (unsigned i = 0; i < 3; ++i) {
        const V3f& p = mesh->positions[mesh->triangles[t][i]];
        if (chart.triangles.empty() && i == 0) chart.low = chart.high = p;
        for (unsigned axis = 0; axis < 3; ++axis) {
          chart.low[axis] = std::min(chart.low[axis], p[axis]);
          chart.high[axis] = std::max(chart.high[axis], p[axis]);
        }
      }
      chart.triangles.push_back(t);
    }
    for (auto& entry : own) charts.push_back(std::move(entry.second));
    // Corners belong to one triangle each from now on.
    Mesh split = *mesh;
    split.positions.clear();
    split.normals.clear();
    split.uvs.assign(2, {});
    for (auto& corners : split.triangles) {
      for (unsigned i = 0; i < 3; ++i) {
        split.positions.push_back(mesh->positions[corners[i]]);
        if (!mesh->normals.empty()) split.normals.push_back(mesh->normals[corners[i]]);
        corners[i] = std::uint32_t(split.positions.size() - 1);
      }
    }
    split.uvs[1].resize(split.positions.size());
    *mesh = std::move(split);
  }
  double texels_per_m = size;
  const auto extent = [&](const Chart& chart, unsigned side) {
    const unsigned axis = (chart.across + 1 + side) % 3;
    return std::max(1.0, std::ceil(double(chart.high[axis] - chart.low[axis]) * texels_per_m));
  };
  const auto place_all = [&] {
    std::stable_sort(charts.begin(), charts.end(),
                     [&](const Chart& a, const Chart& b) { return extent(a, 1) > extent(b, 1); });
    double x = margin;
    double y = margin;
    double shelf = 0;
    for (const Chart& chart : charts) {
      const double width = extent(chart, 0);
      const double height = extent(chart, 1);
      if (x + width + margin > size) {
        x = margin;
        y += shelf + margin;
        shelf = 0;
      }
      shelf = std::max(shelf, height);
      if (x + width + margin > size || y + height + margin > size) return false;
      for (const std::size_t t : chart.triangles) {
        for (unsigned i = 0; i < 3; ++i) {
          const std::uint32_t vertex = chart.mesh->triangles[t][i];
          const auto share = [&](unsigned side) {
            const unsigned axis = (chart.across + 1 + side) % 3;
            const double length = double(chart.high[axis] - chart.low[axis]);
            return length > 0 ? double(chart.mesh->positions[vertex][axis] - chart.low[axis]) / length : 0.0;
          };
          chart.mesh->uvs[1][vertex] = V2f(float((x + share(0) * width) / size), float((y + share(1) * height) / size));
        }
      }
      x += width + margin;
    }
    return true;
  };
  while (!place_all()) texels_per_m *= 0.97;
  return texels_per_m;
}

}  // namespace ivory
