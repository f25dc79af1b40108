#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/statistics.h"
#include "tracer/core/sampler.h"
#include "tracer/core/sampling.h"
#include "tracer/render/photons/aim.h"

namespace ivory {
namespace {

// Pieces that are sent at a box from all around it, close and far, by the density that they state.
TEST(PhotonAim, StatesItsDensity) {
  PhotonAim to;
  to.frame.size = V3i(4, 2, 3);
  to.frame.spacing_m = V3f(1, 0.7F, 2);
  to.frame.origin_m = V3f(5, -1, 2);
  M44f turn;
  turn.rotate(V3f(0, 0.5F, 0));
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) to.frame.local_to_world[i][j] = turn[i][j];
  RandomStream random(1, StreamPurpose::test, 0);
  for (const V3f& p : {V3f(0, 5, -4), V3f(6, -2, 20), V3f(300, 40, -200), V3f(4, -1.4F, 1)}) {
    const AimedBox box = aim(to, p);
    ASSERT_GT(box.area_m2, 0);
    // The box's solid angle, by evenly chosen directions and by its own: mean of 1 / pdf.
    Accumulator own;
    for (int i = 0; i < 20'000; ++i) {
      const float u = random.next();
      const V3f w = sample(to, box, u, random.next2());
      const float pdf = pdf_solid_angle(to, box, w);
      ASSERT_GT(pdf, 0) << p << " " << w;
      own.add(1 / double(pdf));
    }
    const double cap = std::min(4 * double(pi), own.mean() * 40);  // a cap about the box that holds it
    const V3f middle = (to.frame.to_world(V3f(1.5F, 0.5F, 1)) - p).normalized();
    const ShadingFrame frame = make_shading_frame(middle);
    Accumulator even;
    for (int i = 0; i < 100'000; ++i) {
      const float cosine = float(1 - double(random.next()) * cap / (2 * double(pi)));
      const V3f w = frame.to_world(direction_at_cosine(cosine, random.next()));
      even.add(pdf_solid_angle(to, box, w) > 0 ? cap : 0);
    }
    EXPECT_LT(std::abs(z_score(own, even)), z_limit) << p << ": " << own.mean() << " and " << even.mean();
  }
  EXPECT_EQ(aim(to, to.frame.to_world(V3f(1, 0.5F, 1))).area_m2, 0);
}

}  // namespace
}  // namespace ivory
