#include "grid/export/probe_tetrahedra.h"

#include <algorithm>

namespace ivory {

namespace {

using Axes = std::array<std::vector<float>, 3>;

// The axes in the order in which a point's coordinates within its cell fall: the six tetrahedra of a cell.
constexpr std::array<std::array<int, 3>, 6> orders{{{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};

class Builder {
 public:
  Builder(const Axes& at, const V3f& origin, const std::array<V3f, 3>& axes) : at_(at), origin_(origin), axes_(axes) {
    for (int i = 0; i < 3; ++i) size_[i] = int(at[std::size_t(i)].size());
    for (int k = 0; k < size_.z; ++k) {
      for (int j = 0; j < size_.y; ++j)
        for (int i = 0; i < size_.x; ++i) out_.points.push_back(position(V3i(i, j, k)));
    }
    for (int k = 0; k + 1 < size_.z; ++k) {
      for (int j = 0; j + 1 < size_.y; ++j)
        for (int i = 0; i + 1 < size_.x; ++i) add_cell(V3i(i, j, k));
    }
    add_cells(V3i(0, 0, 0), size_ - V3i(1, 1, 1));
  }
  ProbeTetrahedra take() { return std::move(out_); }

 private:
  V3f position(const V3i& i) const {
    V3f p = origin_;
    for (int axis = 0; axis < 3; ++axis) p += axes_[std::size_t(axis)] * at_[std::size_t(axis)][std::size_t(i[axis])];
    return p;
  }
  std::int32_t point(const V3i& i) const { return (i.z * size_.y + i.y) * size_.x + i.x; }

  // From the lowest corner one axis after another to the highest.
  void add_cell(const V3i& low) {
    for (const auto& order : orders) {
      V3i corner = low;
      std::array<std::int32_t, 4> tetrahedron{point(corner)};
      for (std::size_t step = 0; step < 3; ++step) {
        corner[order[step]] += 1;
        tetrahedron[step + 1] = point(corner);
      }
      out_.tetrahedra.push_back(tetrahedron);
    }
  }
  std::int32_t first_tetrahedron(const V3i& cell) const {
    return 6 * ((cell.z * (size_.y - 1) + cell.y) * (size_.x - 1) + cell.x);
  }

  std::size_t add_node(V3f normal, const V3f& through) {
    normal.normalize();
    out_.nodes.push_back({normal, normal.dot(through), 0, 0});
    return out_.nodes.size() - 1;
  }

  // The cells from `low` up to before `high`: split where they are most.
  std::int32_t add_cells(const V3i& low, const V3i& high) {
    const V3i count = high - low;
    const int axis = count.x >= count.y && count.x >= count.z ? 0 : (count.y >= count.z ? 1 : 2);
    if (count[axis] == 1) return add_comparison(low, {-1, -1, -1});
    V3i middle = low;
    middle[axis] += count[axis] / 2;
    const std::size_t node = add_node(axes_[std::size_t(axis)], position(middle));
    V3i below_high = high;
    below_high[axis] = middle[axis];
    V3i above_low = low;
    above_low[axis] = middle[axis];
    const std::int32_t over = add_cells(above_low, high);
    const std::int32_t under = add_cells(low, below_high);
    out_.nodes[node].over = over;
    out_.nodes[node].under = under;
    return std::int32_t(node);
  }

  // Within a cell: is x > y, then the other pairs that are not settled yet. `order` is what is known: axes from the
  // largest coordinate down, as comparisons x-y, y-z, x-z settle it.
  struct Known {
    int xy, yz, xz;  // 1: the first is larger, 0: it is not, -1: not known
  };
  std::int32_t add_comparison(const V3i& cell, Known known) {
    if (known.xy >= 0 && known.yz >= 0 && known.xy == known.yz) known.xz = known.xy;
    if (known.xy >= 0 && known.yz >= 0 && known.xz >= 0) {
      const std::array<int, 3> rank{2 - known.xy - known.xz, 2 - (1 - known.xy) - known.yz,
                                    2 - (1 - known.xz) - (1 - known.yz)};
      std::array<int, 3> order{};
      for (int axis = 0; axis < 3; ++axis) order[std::size_t(rank[std::size_t(axis)])] = axis;
      for (std::size_t i = 0; i < orders.size(); ++i) {
        if (orders[i] == order) return -(first_tetrahedron(cell) + std::int32_t(i) + 1);
      }
    }
    int& asked = known.xy < 0 ? known.xy : (known.yz < 0 ? known.yz : known.xz);
    const int first = &asked == &known.yz ? 1 : 0;
    const int second = &asked == &known.xy ? 1 : 2;
    // Coordinates within the cell count by its own width along each axis.
    const auto gradient = [&](int axis) {
      const std::vector<float>& at = at_[std::size_t(axis)];
      const float width = at[std::size_t(cell[axis]) + 1] - at[std::size_t(cell[axis])];
      const V3f& direction = axes_[std::size_t(axis)];
      return direction / (direction.length2() * width);
    };
    const std::size_t node = add_node(gradient(first) - gradient(second), position(cell));
    asked = 1;
    const std::int32_t over = add_comparison(cell, known);
    asked = 0;
    const std::int32_t under = add_comparison(cell, known);
    out_.nodes[node].over = over;
    out_.nodes[node].under = under;
    return std::int32_t(node);
  }

  const Axes& at_;
  V3f origin_;
  std::array<V3f, 3> axes_;
  V3i size_;
  ProbeTetrahedra out_;
};

}  // namespace

ProbeTetrahedra probe_tetrahedra(const std::array<std::vector<float>, 3>& at, const V3f& origin,
                                 const std::array<V3f, 3>& axes) {
  return Builder(at, origin, axes).take();
}

VolumeTetrahedra volume_tetrahedra(const ProbeVolume& volume) {
  const GridFrame& frame = volume.frame;
  Axes at;
  std::array<V3f, 3> axes;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<float>& places = at[std::size_t(axis)];
    places.push_back(-0.5F);
    for (int i = 0; i < frame.size[axis]; ++i) places.push_back(float(i));
    places.push_back(float(frame.size[axis]) - 0.5F);
    V3f unit(0, 0, 0);
    unit[axis] = frame.spacing_m[axis];
    axes[std::size_t(axis)] = frame.direction_to_world(unit);
  }
  VolumeTetrahedra out{probe_tetrahedra(at, frame.origin_m, axes), {}};
  const auto inside = [](int i, int size) { return std::clamp(i - 1, 0, size - 1); };
  for (int k = 0; k < frame.size.z + 2; ++k) {
    for (int j = 0; j < frame.size.y + 2; ++j) {
      for (int i = 0; i < frame.size.x + 2; ++i) {
        out.sh.push_back(
            volume.sh[frame.vertex_index(inside(i, frame.size.x), inside(j, frame.size.y), inside(k, frame.size.z))]);
      }
    }
  }
  return out;
}

ProbeSh9 tap(const VolumeTetrahedra& volume, const V3f& p) {
  std::int32_t node = 0;
  while (node >= 0) {
    const BspNode& at = volume.probes.nodes[std::size_t(node)];
    node = at.normal.dot(p) > at.distance ? at.over : at.under;
  }
  const std::array<std::int32_t, 4>& corners = volume.probes.tetrahedra[std::size_t(-(node + 1))];
  std::array<V3d, 4> to;
  for (std::size_t i = 0; i < 4; ++i) to[i] = V3d(volume.probes.points[std::size_t(corners[i])]) - V3d(p);
  const auto volume_of = [](const V3d& a, const V3d& b, const V3d& c) { return a.dot(b.cross(c)); };
  // Signed volumes with p in place of each corner.
  const std::array<double, 4> part{volume_of(to[1], to[2], to[3]), -volume_of(to[0], to[2], to[3]),
                                   volume_of(to[0], to[1], to[3]), -volume_of(to[0], to[1], to[2])};
  const double whole = part[0] + part[1] + part[2] + part[3];
  ProbeSh9 sh;
  sh.fill(V3f(0, 0, 0));
  for (std::size_t i = 0; i < 4; ++i) {
    const auto weight = float(std::clamp(part[i] / whole, 0.0, 1.0));
    for (std::size_t k = 0; k < 9; ++k) sh[k] += volume.sh[std::size_t(corners[i])][k] * weight;
  }
  return sh;
}

}  // namespace ivory
