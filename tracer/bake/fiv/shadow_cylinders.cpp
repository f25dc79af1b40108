#include "tracer/bake/fiv/shadow_cylinders.h"

#include <cmath>

#include <tbb/parallel_for.h>

namespace ivory {

namespace {

constexpr float start_height = 2;  // rays start beyond the unit sphere

}  // namespace

ShadowCylinders trace_shadow_cylinders(const Intersector& object, std::span<const V3f> w, int resolution) {
  ShadowCylinders out;
  out.resolution = resolution;
  out.frames.resize(w.size());
  const std::size_t pixels = std::size_t(resolution) * std::size_t(resolution);
  out.depth.assign(w.size() * pixels, ShadowCylinders::no_depth);
  const float pixel = 2.0F / float(resolution);
  tbb::parallel_for(std::size_t(0), w.size(), [&](std::size_t k) {
    const ShadingFrame frame = out.frames[k] = make_shading_frame(w[k]);
    float* depth = out.depth.data() + k * pixels;
    for (int row = 0; row < resolution; ++row) {
      const float v = (float(row) + 0.5F) * pixel - 1;
      // The row's chord of the unit disc.
      const float half_chord = std::sqrt(std::max(0.0F, 1 - v * v));
      const int begin = std::max(0, int((1 - half_chord) / pixel - 0.5F));
      const int end = std::min(resolution, int(std::lround((1 + half_chord) / pixel)) + 1);
      const V3f row_origin = frame.z * start_height + frame.y * v;
      for (int first = begin; first < end; first += 8) {
        const int count = std::min(8, end - first);
        std::array<V3f, 8> origins;
        for (int i = 0; i < count; ++i)
          origins[std::size_t(i)] = row_origin + frame.x * ((float(first + i) + 0.5F) * pixel - 1);
        const std::array<float, 8> t = object.distances(origins, count, -frame.z);
        for (int i = 0; i < count; ++i) {
          if (std::isfinite(t[std::size_t(i)])) {
            depth[std::size_t(row) * std::size_t(resolution) + std::size_t(first + i)] =
                start_height - t[std::size_t(i)];
          }
        }
      }
    }
  });
  return out;
}

double covered_share(const ShadowCylinders& cylinders) {
  std::size_t covered = 0;
  for (const float depth : cylinders.depth) covered += depth > ShadowCylinders::no_depth ? 1 : 0;
  return double(covered) / (double(cylinders.depth.size()) * double(pi) / 4);
}

}  // namespace ivory
