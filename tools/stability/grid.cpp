// How photons are deposited and directions reconstructed, where either goes wrong.
#include <algorithm>
#include <cmath>

#include "tools/stability/scenes.h"
#include "tools/stability/stability.h"
#include "tracer/bake/field/deposit/photon_deposit.h"

namespace ivory {
namespace {

// F and D_i of one directional light of 1 lux: w and sgn(w_i) w.
std::array<double, 12> directional_moments(const V3f& w) {
  std::array<double, 12> m{};
  for (unsigned j = 0; j < 3; ++j) {
    m[j] = w[j];
    for (unsigned i = 0; i < 3; ++i) m[3 * (i + 1) + j] = w[i] < 0 ? -w[j] : w[j];
  }
  return m;
}

// N parallel photons enter through a disc of 1 m radius, so n = N h^2 / pi of them pass 1 m^2 seen along their way
// times a face of side h. A face inclined by |w_j| is crossed by n |w_j| of them, each worth 1 / (n |w_j|): D_j, which
// these faces alone measure, has the relative variance 1 / (n |w_j|), and F, the mean of the three, a ninth of
// their sum.
std::vector<StabilityPoint> grazing_photons(const StabilityParams& params) {
  const std::uint64_t photons = params.quick ? 20'000 : 200'000;
  const GridFrame frame = centred_frame(4, 0.8F);
  const double n = double(photons) * std::pow(double(frame.spacing_m.x), 2) / pi_d;
  std::vector<StabilityPoint> points;
  for (const double elevation : {0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 45.0}) {
    const double e = elevation * pi_d / 180;
    const V3f w(V3d(std::cos(e) * std::cos(0.6), std::sin(e), std::cos(e) * std::sin(0.6)));
    Scene scene;
    scene.name = "grazing light";
    scene.lights.push_back(DirectionalLight{-w, Rgb(1, 1, 1)});
    const LitScene world = make_lit_scene(std::move(scene));
    const std::array<double, 12> truth = directional_moments(w);
    double face_variance = 0;
    double mean_cosine = 0;
    double paper_bias = 0;
    for (unsigned j = 0; j < 3; ++j) {
      const double cosine = std::abs(double(w[j]));
      face_variance += (1 + 1.0 / 9) / (4 * n * cosine);
      mean_cosine += cosine / 3;
      paper_bias += (1 - cosine) * (1 - cosine) / 4;
    }
    paper_bias = std::sqrt(paper_bias + (1 - mean_cosine) * (1 - mean_cosine) / 4);
    for (const Estimator estimator : {Estimator::track, Estimator::face, Estimator::face_paper}) {
      GridBakeParams bake;
      bake.frame = frame;
      bake.estimator = estimator;
      bake.photons = photons;
      bake.guard = Guard::off;
      const IrradianceGrid grid = bake_all_light(world, bake);
      double squares = 0;
      for (std::size_t v = 0; v < frame.vertex_count(); ++v) {
        for (std::size_t f = 0; f < 12; ++f) squares += std::pow(double(grid.at(v)[3 * f]) - truth[f], 2);
      }
      // |F| = |D_j| = 1: four unit vectors a vertex.
      const double error = std::sqrt(squares / (4 * double(frame.vertex_count())));
      // Twice the closed form for the faces: at the least elevation a few dozen crossings in all make the noise. The
      // lengths of photons in a cell that they pass vary by less than their mean, and positions sampled along them add
      // a part again: 1 / n to 2 / n, and 13 % for how well so few cells tell their own noise.
      double bound = 1.6 / std::sqrt(n);
      if (estimator == Estimator::face) bound = 2 * std::sqrt(face_variance);
      if (estimator == Estimator::face_paper) bound = paper_bias + 2 * std::sqrt(1 / n);
      points.push_back({std::string(name_of(estimator)), elevation, error, bound});
    }
  }
  return points;
}

// Photons exactly in the planes between cells, axis-aligned but for a tilt: whatever side a tie falls on, the length
// that the cells receive together must be the photons' own, and lie in the cells beside each photon's line, in every
// layer across it as much as the photon is long there.
std::vector<StabilityPoint> grid_planes(const StabilityParams&) {
  constexpr int side = 8;
  const GridFrame frame = centred_frame(side, 1);
  // A side: planes 2, 4 and 6 of the grid. The two cells to either side of them, which a tilt of 0.1 does not leave,
  // are no other photon's.
  constexpr int count = 3;
  constexpr float power = 1.0F / (count * count);
  std::vector<StabilityPoint> points;
  for (const float tilt : {0.0F, 1e-30F, 1e-12F, 1e-8F, 1e-6F, 1e-4F, 1e-2F, 0.1F}) {
    for (const bool sampled : {true, false}) {
      double worst = 0;
      double worst_layer = 0;
      for (unsigned axis = 0; axis < 3; ++axis) {
        const unsigned u = (axis + 1) % 3;
        const unsigned v = (axis + 2) % 3;
        DepositTarget target = make_deposit_target(frame, Basis::vectors, Estimator::track, power,
                                                   std::vector<std::uint64_t>(frame.vertex_count(), ~std::uint64_t(0)));
        std::vector<PhotonSegment> segments;
        V3f direction(0, 0, 0);
        direction[axis] = 1;
        direction[u] = tilt;
        direction.normalize();
        for (int i = 0; i < count; ++i) {
          for (int j = 0; j < count; ++j) {
            V3f origin(0, 0, 0);
            origin[axis] = -1;
            origin[u] = float(2 * i - 2) * frame.spacing_m.x - tilt;
            origin[v] = float(2 * j - 2) * frame.spacing_m.x;
            const float jitter = (float(j * count + i) + 0.5F) / float(count * count);
            segments.push_back({origin, direction, 10, Rgb(power, power, power), jitter});
          }
        }
        PhotonDepositor depositor(target, sampled ? TrackWalk::sampled : TrackWalk::exact);
        depositor.deposit(segments);
        depositor.flush();
        // Of |w_axis| times the photons' lengths inside the grid, 1 m wide, with power 1 in all: 1 lm m.
        double sum = 0;
        std::array<double, count * count * side> layers{};  // of each photon, the cells beside its line
        for (int vertex = 0; vertex < side * side * side; ++vertex) {
          const V3i at = target.lattice.frame.vertex_coordinates(std::size_t(vertex));
          double here = 0;
          for (std::size_t slot = 0; slot < 8; ++slot)
            here += double(target.sums[target.lane_index(slot, std::size_t(vertex)) + 3 * axis]) * target.quantum;
          sum += here;
          const int i = (at[int(u)] - 1) / 2;  // cells 1 and 2 lie beside plane 2
          const int j = (at[int(v)] - 1) / 2;
          const bool beside = at[int(u)] >= 1 && at[int(v)] >= 1 && i < count && j < count;
          if (beside) layers[std::size_t((i * count + j) * side + at[int(axis)])] += here;
        }
        worst = std::max(worst, std::abs(sum - 1));
        for (const double length : layers)
          worst_layer = std::max(worst_layer, std::abs(length * count * count * side - 1));
      }
      // A photon's length in a cell is rounded to a quantum of 2^-18 of a voxel's: half of one, at most four times a
      // layer, and 1 / sqrt(12) each over some hundred cells in all, 72 voxels long.
      const std::string walk = sampled ? "sampled walk" : "exact walk";
      points.push_back({walk, double(tilt), worst, 1e-6});
      points.push_back({walk + ", layer by layer", double(tilt), worst_layer, 1e-5});
    }
    // What such light becomes: E(n) for the worst normal. The sign of a component that vanishes is a matter of chance.
    const V3f w = V3f(1, tilt, -tilt).normalized();
    std::array<float, 36> moments{};
    const std::array<double, 12> m = directional_moments(w);
    for (std::size_t i = 0; i < 36; ++i) moments[i] = float(m[i / 3]);
    for (const Reconstruction r : {Reconstruction::optimal, Reconstruction::paper}) {
      double worst = 0;
      constexpr int normals = 20'000;
      for (int i = 0; i < normals; ++i) {
        const double y = 1 - 2 * (i + 0.5) / normals;
        const double phi = i * 2.399963229728653;  // golden angle: even over the sphere
        const double s = std::sqrt(1 - y * y);
        const V3f normal(V3d(s * std::cos(phi), y, s * std::sin(phi)));
        const double e = double(irradiance(Basis::vectors, r, moments.data(), normal).x);
        worst = std::max(worst, std::abs(e - std::max(0.0, double(normal.dot(w)))));
      }
      // D_i is the same for light at both signs of w_i, so the optimal reconstruction is exact along the axes, and its
      // error grows with what the light has of the other two, up to the basis' worst of 0.260; the paper's remap gives
      // n_x^2 for n_x: 2 / sqrt(27) less at worst.
      const bool optimal = r == Reconstruction::optimal;
      points.push_back({optimal ? "E(n), worst normal" : "E(n), worst normal, paper's remap", double(tilt), worst,
                        optimal ? std::min(0.261, 2 * double(tilt) + 1e-6) : 0.386});
    }
  }
  return points;
}

// Uniform light of 1 nit, E = pi for every normal, from the exact moments; x from the axis y to the diagonal.
std::vector<StabilityPoint> diagonal_normals(const StabilityParams&) {
  std::vector<StabilityPoint> points;
  for (const Basis basis : all_bases) {
    std::array<double, max_functions> sums{};
    constexpr int directions = 200'000;
    for (int i = 0; i < directions; ++i) {
      const double y = 1 - 2 * (i + 0.5) / directions;
      const double phi = i * 2.399963229728653;
      const double s = std::sqrt(1 - y * y);
      const auto f = eval(basis, V3f(V3d(s * std::cos(phi), y, s * std::sin(phi))));
      for (std::size_t k = 0; k < max_functions; ++k) sums[k] += double(f[k]) * 4 * pi_d / directions;
    }
    std::array<float, 3 * max_functions> moments{};
    for (std::size_t i = 0; i < moments.size(); ++i) moments[i] = float(sums[i / 3]);
    for (int step = 0; step <= 12; ++step) {
      const double angle = step / 12.0 * std::acos(1 / std::sqrt(3.0));
      const V3d n(std::sin(angle) * std::sqrt(0.5), std::cos(angle), std::sin(angle) * std::sqrt(0.5));
      const auto error = [&](Reconstruction r) {
        return std::abs(double(irradiance(basis, r, moments.data(), V3f(n)).x) / pi_d - 1);
      };
      const double degrees = angle * 180 / pi_d;
      // The lattice of directions integrates these functions to a few 1e-6.
      constexpr double lattice = 1e-5;
      points.push_back({std::string(name_of(basis)), degrees, error(Reconstruction::optimal), lattice});
      if (basis != Basis::vectors) continue;
      const double predicted = 1 - (n.x * n.x * n.x + n.y * n.y * n.y + n.z * n.z * n.z);
      points.push_back({"vectors, paper's remap", degrees, error(Reconstruction::paper), predicted + lattice});
    }
  }
  return points;
}

}  // namespace

std::vector<StabilityCase> stability_grid_cases() {
  return {
      {.name = "grazing_photons",
       .title = "Light that grazes the grid's planes",
       .sentence =
           "The noise of --estimator face grows as one over the root of the angle between light and a grid plane, "
           "and face_paper is wrong by up to two thirds at every angle: leave the estimator at track, whose noise "
           "does not depend on the angle.",
       .x_label = "angle between light and grid plane, degrees",
       .y_label = "RMS error of the stored vectors / E",
       .log_x = true,
       .run = grazing_photons},
      {.name = "grid_planes",
       .title = "Light exactly along the grid's planes",
       .sentence =
           "No light is lost, counted twice or put elsewhere where photons run in the planes between cells, and light "
           "along an "
           "axis is what six vectors reconstruct exactly; only the paper's remap is at its worst there (38 % of "
           "E for the worst normal): leave --reconstruction at optimal.",
       .x_label = "tilt against the axis",
       .y_label = "error / E",
       .log_x = true,
       .run = grid_planes},
      {.name = "diagonal_normals",
       .title = "Uniform light on diagonal normals",
       .sentence = "The paper's remap loses up to 42 % of uniform light where the normal lies between the grid's axes: "
                   "read grids with --reconstruction optimal (the default), which is exact in uniform light.",
       .x_label = "angle between normal and axis, degrees",
       .y_label = "|E / (pi L) - 1|",
       .log_y = false,
       .run = diagonal_normals},
  };
}

}  // namespace ivory
