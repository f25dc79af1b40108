#include "tracer/lights/guide.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>

// One photon brings f(x) into what is sought where x, of the measure mu of unguided photons, is its place in the cubes;
// sent with the density g it brings f / g. The variance of the mean, per photon, is
//
//   int f^2 / g dmu - const,   least for   g ~ sqrt(f^2) = |f|,
//
// and where g must be constant over a cell, for g = sqrt(m) with m the mean of f^2 over the cell: the root mean square.
// (Not the mean: cells where few photons bring much count for more than those where many bring little.)
//
// Cells are found by halving. A cell that holds n samples, of which sample i brings the square s_i (over the density it
// was sent with), is halved along the axis that lowers the bound (sum over cells sqrt(mu m))^2 most, if its samples are
// not even along it beyond doubt: with eight bins along the axis and Q = sum s_i^2,
//
//   T = sum over bins (S_b - S / 8)^2 / (Q / 8)
//
// is about chi-squared of seven degrees of freedom if they are even. Noise is thus not mistaken for structure (a lamp
// in the middle of a closed room keeps one cell), while four photons of a million that came through the same eighth
// of a disc are enough to follow.
//
// What no sample met is not known to be dark. With k the weight of the parent's mean, a cell's mean is taken as
//
//   m = (n m_cell + k m_parent) / (n + k),
//
// so that a cell in which none of n photons brought anything keeps sqrt(k / (n + k)) of its parent's density. And
// because dyadic cells end where light does not, each sample counts half for itself and half for its neighbours one
// half of its cell away, in a second round of halving. Both guard against photons that come rarely and carry much.

namespace ivory {

namespace {

constexpr int bins = 8;
// T exceeds it once in 40 even cells; a cell halved for nothing costs little.
constexpr double doubtless = 16;
constexpr double parent_weight = 2;
constexpr double smallest_gain = 1e-4;  // of the bound's root in all
constexpr float smallest_size = 0x1p-16F;

struct Point {
  std::array<float, guide_axes> u;
  float square;  // what it stands for here
  float whole;   // of the sample that it is a part of
  bool counts;   // among n: not for its neighbours' parts
};

struct Box {
  std::array<float, guide_axes> low;
  std::array<float, guide_axes> size;
};

struct Leaf {
  Box box;
  double mean;
  std::size_t begin, end;  // of the points
};

class Halving {
 public:
  Halving(std::vector<Point>& points, unsigned axes, double mean_of_all) : points_(points), axes_(axes) {
    least_gain_ = smallest_gain * std::sqrt(mean_of_all);
  }

  // `measure`: of the box, times the number of photons, so that sums over it are means.
  void run(std::size_t begin, std::size_t end, const Box& box, double measure, double photons, double parent_mean) {
    double n = 0;
    double sum = 0;
    double squares = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const Point& p = points_[i];
      n += p.counts ? 1 : 0;
      sum += double(p.square);
      squares += double(p.square) * double(p.whole);
    }
    const double own = sum / (measure * photons);
    const double mean = (n * own + parent_weight * parent_mean) / (n + parent_weight);
    const int axis = sum > 0 ? axis_to_halve(begin, end, box, sum, squares, std::sqrt(own) * measure) : -1;
    if (axis < 0) {
      leaves_.push_back({box, mean, begin, end});
      return;
    }
    const auto a = std::size_t(axis);
    Box half = box;
    half.size[a] *= 0.5F;
    const float middle = box.low[a] + half.size[a];
    const auto first = points_.begin();
    const auto split = std::stable_partition(first + std::ptrdiff_t(begin), first + std::ptrdiff_t(end),
                                             [&](const Point& p) { return p.u[a] < middle; });
    const auto between = std::size_t(split - first);
    run(begin, between, half, measure / 2, photons, mean);
    half.low[a] = middle;
    run(between, end, half, measure / 2, photons, mean);
  }

  const std::vector<Leaf>& leaves() const { return leaves_; }

 private:
  int axis_to_halve(std::size_t begin, std::size_t end, const Box& box, double sum, double squares,
                    double bound) const {
    std::array<std::array<double, bins>, guide_axes> in_bin{};
    for (std::size_t i = begin; i < end; ++i) {
      const Point& p = points_[i];
      if (p.square == 0) continue;
      for (std::size_t a = 0; a < guide_axes; ++a) {
        if ((axes_ >> a & 1U) == 0) continue;
        const int bin = int((p.u[a] - box.low[a]) / box.size[a] * float(bins));
        in_bin[a][std::size_t(std::clamp(bin, 0, bins - 1))] += double(p.square);
      }
    }
    int best = -1;
    double best_gain = least_gain_;
    for (std::size_t a = 0; a < guide_axes; ++a) {
      if ((axes_ >> a & 1U) == 0 || box.size[a] <= smallest_size) continue;
      double t = 0;
      double roots = 0;
      for (const double s : in_bin[a]) {
        t += (s - sum / bins) * (s - sum / bins);
        roots += std::sqrt(s / sum / bins);
      }
      t /= squares / bins;
      const double gain = bound * (1 - roots);
      if (t > doubtless && gain > best_gain) {
        best_gain = gain;
        best = int(a);
      }
    }
    return best;
  }

  std::vector<Point>& points_;
  unsigned axes_;
  double least_gain_;
  std::vector<Leaf> leaves_;
};

// Each point with light, half of it moved by half of its cell along the axes that were halved.
std::vector<Point> spread(const std::vector<Point>& points, const std::vector<Leaf>& leaves) {
  std::vector<Point> out;
  for (const Leaf& leaf : leaves) {
    std::vector<std::size_t> halved;
    for (std::size_t a = 0; a < guide_axes; ++a) {
      if (leaf.box.size[a] > 0 && leaf.box.size[a] < 1) halved.push_back(a);
    }
    for (std::size_t i = leaf.begin; i < leaf.end; ++i) {
      Point p = points[i];
      if (p.square == 0 || halved.empty()) {
        out.push_back(p);
        continue;
      }
      const float part = 0.25F * p.square / float(halved.size());
      p.square *= 0.5F;
      out.push_back(p);
      Point moved = p;
      moved.square = part;
      moved.counts = false;
      for (const std::size_t a : halved) {
        for (const float side : {-0.5F, 0.5F}) {
          const float to = p.u[a] + side * leaf.box.size[a];
          moved.u[a] = to >= 0 && to < 1 ? to : p.u[a];
          out.push_back(moved);
        }
        moved.u[a] = p.u[a];
      }
    }
  }
  return out;
}

Box whole_cube(unsigned axes) {
  Box box{};
  for (std::size_t a = 0; a < guide_axes; ++a) box.size[a] = (axes >> a & 1U) != 0 ? 1.0F : 0.0F;
  return box;
}

}  // namespace

EmissionGuide::EmissionGuide(std::span<const GuideStratum> strata) {
  std::vector<double> weights;
  for (std::size_t s = 0; s < strata.size(); ++s) {
    const Box box = whole_cube(strata[s].axes);
    cells_.push_back({std::uint32_t(s), box.low, box.size});
    weights.push_back(strata[s].share);
  }
  finish(strata, weights);
}

void EmissionGuide::finish(std::span<const GuideStratum> strata, const std::vector<double>& weights) {
  table_ = AliasTable(weights);
  density_ = table_.probabilities();
  axes_.clear();
  for (const GuideStratum& s : strata) axes_.push_back(s.axes);
  least_.assign(strata.size(), 0);
  largest_.assign(strata.size(), 0);
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    const Cell& cell = cells_[c];
    double measure = strata[cell.stratum].share;
    for (const float size : cell.size) measure *= size > 0 ? double(size) : 1;
    density_[c] = measure > 0 ? density_[c] / measure : 0;
    double& least = least_[cell.stratum];
    double& largest = largest_[cell.stratum];
    least = least == 0 ? density_[c] : std::min(least, density_[c]);
    largest = std::max(largest, density_[c]);
  }
}

GuidePoint EmissionGuide::sample(RandomStream& random) const {
  const std::uint32_t chosen = table_.sample(random);
  const Cell& cell = cells_[chosen];
  GuidePoint point;
  point.stratum = cell.stratum;
  point.density = density_[chosen];
  for (unsigned axes = axes_[cell.stratum]; axes != 0; axes &= axes - 1) {
    const auto a = std::size_t(std::countr_zero(axes));
    point.u[a] = double(cell.low[a]) + double(cell.size[a]) * (double(random.next_u32()) * 0x1p-32);
  }
  return point;
}

EmissionGuide make_guide(std::span<const GuideStratum> strata, std::span<const GuideSample> samples, double defensive) {
  assert(defensive > 0 && defensive <= 1);
  std::vector<std::vector<Point>> points(strata.size());
  double total = 0;
  double largest = 0;
  for (const GuideSample& s : samples) largest = std::max(largest, s.square / s.point.density);
  if (!(largest > 0)) return EmissionGuide(strata);
  for (const GuideSample& s : samples) {
    Point p{};
    // As parts of the largest: squares of powers in lumen may leave what floats hold.
    p.square = p.whole = float(s.square / s.point.density / largest);
    p.counts = true;
    for (std::size_t a = 0; a < guide_axes; ++a) p.u[a] = std::min(float(s.point.u[a]), 1 - 0x1p-24F);
    points[s.point.stratum].push_back(p);
    total += double(p.square);
  }
  const auto photons = double(samples.size());
  const double mean_of_all = total / photons;

  EmissionGuide guide;
  std::vector<double> roots;  // [cell] root mean square times measure
  double sum = 0;
  for (std::size_t s = 0; s < strata.size(); ++s) {
    if (!(strata[s].share > 0)) continue;
    const Box cube = whole_cube(strata[s].axes);
    Halving coarse(points[s], strata[s].axes, mean_of_all);
    coarse.run(0, points[s].size(), cube, strata[s].share, photons, mean_of_all);
    std::vector<Point> spread_points = spread(points[s], coarse.leaves());
    Halving fine(spread_points, strata[s].axes, mean_of_all);
    fine.run(0, spread_points.size(), cube, strata[s].share, photons, mean_of_all);
    for (const Leaf& leaf : fine.leaves()) {
      double measure = strata[s].share;
      for (const float size : leaf.box.size) measure *= size > 0 ? double(size) : 1;
      guide.cells_.push_back({std::uint32_t(s), leaf.box.low, leaf.box.size});
      roots.push_back(std::sqrt(leaf.mean) * measure);
      sum += roots.back();
    }
  }
  std::vector<double> weights(roots.size());
  for (std::size_t c = 0; c < roots.size(); ++c) {
    const EmissionGuide::Cell& cell = guide.cells_[c];
    double measure = strata[cell.stratum].share;
    for (const float size : cell.size) measure *= size > 0 ? double(size) : 1;
    weights[c] = defensive * measure + (1 - defensive) * roots[c] / sum;
  }
  guide.finish(strata, weights);
  return guide;
}

}  // namespace ivory
