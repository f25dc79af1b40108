#include "tracer/lights/entry_discs.h"

#include <algorithm>
#include <cmath>
#include <limits>

// Light of one direction w brings the illuminance E to every point that faces it. A photon along w that crosses the
// plane at right angles to w at the point x, chosen with the density p(x) (1/m^2), therefore carries
//
//   E / p(x),
//
// whatever p is, as long as it is above 0 where the photon may do anything. With one disc over the scene's sphere, of
// radius R, p = 1 / (pi R^2): of the photons in a scene of R = 700 m one in 24,000 meets a room of 4.5 m, in one of 70
// km none. So where a small part of a scene is asked for (a sphere of radius r), there is a ladder of discs about its
// centre,
//
//   r, 4 r, 16 r, ...   below R / 2, and the scene's,
//
// and p is that of the mixture, whichever disc x came from (Veach's balance heuristic in its one-sample form):
//
//   p(x) = sum over the discs k that hold x of a_k / (pi r_k^2),   a_k >= 0 adding up to one.
//
// Discs of one direction lie in one plane, so the sum is exact. At the distance d from the centre p is at least
// a_k / (pi (4 d)^2) for the disc k that is the first to hold x: no photon carries more than 16 / a_k times what the
// density 1 / (pi d^2) would give it, and light that falls on the ground around and bounces in is found, too.
//
// Shares: where a part c_k of the light comes by the ring between two discs, its variance goes as c_k r_k^2 / a_k. Over
// open ground c_k falls as 1 / r_k or 1 / r_k^2, so that no a_k would be much too small if all were equal; in rooms
// most comes by the smallest disc and by the yard, the second. So a quarter of the photons goes through each of these,
// and half evenly through all: a_k >= 1 / (2 count) whatever the scene.
//
// Photons start near the scene's bounds and not 2 R away: in floats a ray that starts 140 km away is good to a
// centimetre, over flat ground it need not be.

namespace ivory {

namespace {

constexpr double ladder_step = 4;

double disc_area(double radius_m) { return double(pi) * radius_m * radius_m; }

double scene_share(const EntryDiscs& discs) {
  double rest = 1;
  for (const double share : discs.shares) rest -= share;
  return rest;
}

// How far from x, in the direction of w, the line through x leaves the box for good; below every number where it misses
// it.
double exit_distance(const Box3f& box, const V3d& x, const V3d& w) {
  if (box.isEmpty()) return -std::numeric_limits<double>::infinity();
  double enter = -std::numeric_limits<double>::infinity();
  double leave = std::numeric_limits<double>::infinity();
  for (unsigned axis = 0; axis < 3; ++axis) {
    const double low = double(box.min[axis]) - x[axis];
    const double high = double(box.max[axis]) - x[axis];
    if (w[axis] == 0) {
      if (low > 0 || high < 0) return -std::numeric_limits<double>::infinity();
      continue;
    }
    enter = std::max(enter, std::min(low / w[axis], high / w[axis]));
    leave = std::min(leave, std::max(low / w[axis], high / w[axis]));
  }
  return leave >= enter ? leave : -std::numeric_limits<double>::infinity();
}

}  // namespace

EntryDiscs make_entry_discs(const BoundingSphere& scene, const Box3f& box,
                            const std::optional<EmissionTarget>& target) {
  EntryDiscs discs;
  discs.scene = scene;
  if (!target) return discs;
  const double r = double(target->radius_m);
  const double limit = 0.5 * double(scene.radius_m);
  const bool sticks_out = (V3d(target->center) - V3d(scene.center)).length() + r > double(scene.radius_m);
  discs.beyond_scene = target->direct && sticks_out;
  if (r > limit && !discs.beyond_scene) return discs;

  discs.box = box;
  if (!discs.box.isEmpty()) {
    const float margin = 1e-4F * scene.radius_m;
    discs.box.min -= V3f(margin, margin, margin);
    discs.box.max += V3f(margin, margin, margin);
  }
  discs.target = V3d(target->center);
  discs.radii_m.push_back(r);
  for (double radius = r * ladder_step; radius <= limit; radius *= ladder_step) discs.radii_m.push_back(radius);
  discs.shares.assign(discs.radii_m.size(), 0.5 / double(discs.radii_m.size() + 1));
  discs.shares[0] += 0.25;
  if (discs.shares.size() > 1) discs.shares[1] += 0.25;
  return discs;
}

std::vector<double> disc_shares(const EntryDiscs& discs) {
  std::vector<double> shares = discs.shares;
  shares.push_back(scene_share(discs));
  return shares;
}

Entry enter(const EntryDiscs& discs, std::size_t chosen, const Imath::V2d& point, const V3f& w,
            const ShadingFrame& frame) {
  const BoundingSphere& scene = discs.scene;
  if (discs.radii_m.empty()) {
    const V2f disc = V2f(point) * scene.radius_m;
    // Twice the radius back: clear of the sphere despite rounding.
    return {scene.center + w * (2 * scene.radius_m) + frame.x * disc.x + frame.y * disc.y,
            pi * scene.radius_m * scene.radius_m};
  }

  // Points of the plane through the target's centre, about which they are counted: small numbers near it.
  const V3d x_axis(frame.x);
  const V3d y_axis(frame.y);
  const V3d to_scene = V3d(scene.center) - discs.target;
  const Imath::V2d scene_middle(to_scene.dot(x_axis), to_scene.dot(y_axis));
  const bool of_scene = chosen == discs.shares.size();
  const double radius = of_scene ? double(scene.radius_m) : discs.radii_m[chosen];
  Imath::V2d x = point * radius;
  if (of_scene) x += scene_middle;

  double density = 0;
  for (std::size_t k = 0; k < discs.radii_m.size(); ++k) {
    // A point on a disc's very rim belongs to the disc that it was chosen from, whatever rounding says.
    if (k == chosen || x.length() < discs.radii_m[k]) density += discs.shares[k] / disc_area(discs.radii_m[k]);
  }
  const bool meets_scene = of_scene || (x - scene_middle).length() < double(scene.radius_m);
  if (meets_scene) density += scene_share(discs) / disc_area(double(scene.radius_m));

  const V3d place = discs.target + x_axis * x.x + y_axis * x.y;
  const double start = std::max(discs.radii_m[0], exit_distance(discs.box, place, V3d(w)));
  const double area = meets_scene || discs.beyond_scene ? 1 / density : 0;
  return {V3f(place + V3d(w) * start), float(area)};
}

Entry sample(const EntryDiscs& discs, const V3f& w, const ShadingFrame& frame, RandomStream& random) {
  std::size_t chosen = 0;
  if (!discs.radii_m.empty()) {
    double u = double(random.next());
    while (chosen < discs.shares.size() && u >= discs.shares[chosen]) u -= discs.shares[chosen++];
  }
  return enter(discs, chosen, Imath::V2d(sample_disc(random.next2())), w, frame);
}

float near_area_m2(const EntryDiscs& discs) {
  if (discs.radii_m.empty()) return pi * discs.scene.radius_m * discs.scene.radius_m;
  double density = 0;
  for (std::size_t k = 0; k < discs.radii_m.size(); ++k) density += discs.shares[k] / disc_area(discs.radii_m[k]);
  const bool in_scene = (discs.target - V3d(discs.scene.center)).length() < double(discs.scene.radius_m);
  if (in_scene) density += scene_share(discs) / disc_area(double(discs.scene.radius_m));
  return float(1 / density);
}

float far_area_m2(const EntryDiscs& discs) {
  if (discs.radii_m.empty()) return pi * discs.scene.radius_m * discs.scene.radius_m;
  double largest = disc_area(double(discs.scene.radius_m)) / scene_share(discs);
  for (std::size_t k = 0; k < discs.radii_m.size(); ++k)
    largest = std::max(largest, disc_area(discs.radii_m[k]) / discs.shares[k]);
  return float(largest);
}

}  // namespace ivory
