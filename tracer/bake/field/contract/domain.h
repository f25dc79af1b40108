// Where a grid's light is asked for: points on the surfaces and in the free space that it covers.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "grid/base/names.h"
#include "grid/field/frame.h"
#include "tracer/core/lit_scene.h"

namespace ivory {

enum class DomainKind { both, surfaces, space };
template <>
inline constexpr auto name_table<DomainKind> = make_name_table<DomainKind>(
    "domain", {{DomainKind::both, "both"}, {DomainKind::surfaces, "surfaces"}, {DomainKind::space, "space"}});

struct DomainPoint {
  V3f p;  // as the scene counts it: less its anchor, metres
  V3f n;  // unit; of a surface its geometric normal, on either side
  double weight = 1;
  bool on_surface = true;
};

// The share of points that lie on surfaces where both are asked for: that is where most look-ups are made, and where a
// grid is worst.
inline constexpr double surface_share = 0.75;

struct DomainParams {
  GridFrame frame;  // points lie in the box of its cells
  DomainKind kind = DomainKind::both;
  // Free space is that of these boxes; none: of the whole frame; empty: there is none.
  std::optional<std::vector<Box3f>> dynamic_regions = std::nullopt;
  std::vector<DomainPoint> given{};  // unless empty, these are the domain
  std::uint64_t seed = 1;
};

// Draws points. On surfaces they are uniform in area over the part within the frame, of either side; in space uniform
// in volume, with normals uniform over the sphere. Whether light comes there is not asked.
class Domain {
 public:
  // Throws ParameterError where nothing of it is left: no surface within the frame, no dynamic region.
  Domain(const Scene& scene, DomainParams params);

  // Point number `index`, which depends on nothing but the seed and the index.
  DomainPoint point(std::uint64_t index) const;
  // How many there are: beyond counting, unless they are given.
  std::uint64_t size() const;
  const DomainParams& params() const { return params_; }
  bool has_surfaces() const { return !pieces_.empty(); }
  bool has_space() const { return !boxes_.empty(); }

 private:
  // A part of a triangle within the frame's box, as barycentrics of its 2nd and 3rd vertex.
  struct Piece {
    V2f a, b, c;
    int instance = 0;
    int triangle = 0;
  };
  std::optional<DomainPoint> surface_point(RandomStream& random) const;
  DomainPoint space_point(RandomStream& random) const;

  const Scene& scene_;
  DomainParams params_;
  std::vector<Piece> pieces_;
  std::vector<double> area_until_;  // m^2, of the pieces up to and including each
  std::vector<Box3f> boxes_;        // of free space: the frame's own axes in index coordinates, or the scene's, metres
  std::vector<double> volume_until_;  // m^3
};

// Light reaches one side of most walls, and none of the inside of solids: of points drawn three to one, those that it
// reaches are not. Weights (1, of points that were drawn) that give surfaces their share again, and add up to the
// number of points; as they are where there are fewer than 16 of either kind.
void balance_weights(const std::vector<DomainPoint*>& points);

}  // namespace ivory
