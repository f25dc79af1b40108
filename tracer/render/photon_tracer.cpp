#include "tracer/render/photon_tracer.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tracer/bsdf/bsdf.h"
#include "tracer/core/sampler.h"
#include "tracer/core/surface.h"

namespace ivory {
namespace {

// Light carried along wo = -direction and scattered to wi obeys the adjoint of the BSDF. With
// interpolated normals the two differ (Veach 1997, eq. 5.19): the power leaving must be multiplied by
//
//   |wo.ns| |wi.ng| / (|wo.ng| |wi.ns|),
//
// which is one where ns = ng. Its mean is what counts; grazing photons make it large and rare, so it
// is bounded here at a bias far below the photon noise.
float shading_normal_correction(const Bsdf& bsdf, const V3f& wo, const V3f& wi) {
  if (bsdf.ns == bsdf.ng) return 1;
  constexpr float bound = 20;
  const float numerator = std::abs(wo.dot(bsdf.ns) * wi.dot(bsdf.ng));
  const float denominator = std::abs(wo.dot(bsdf.ng) * wi.dot(bsdf.ns));
  return numerator >= bound * denominator ? bound : numerator / denominator;
}

}  // namespace

PhotonLedger& PhotonLedger::operator+=(const PhotonLedger& other) {
  emitted += other.emitted;
  absorbed += other.absorbed;
  escaped += other.escaped;
  terminated += other.terminated;
  photons += other.photons;
  rays += other.rays;
  return *this;
}

PhotonTracer::PhotonTracer(const LitScene& lit, const PhotonParams& params)
    : lit_(lit), params_(params), emission_(lit.lights.emission(params.target)) {
  // A photon carries about the total power; 2^-20 of it leaves 2^40 photons to the integers. Past the scene's sphere
  // more enters than the lights' power for the scene says.
  const Rgb power = lit.lights.total_power_lm();
  const EntryDiscs& discs = emission_.discs();
  const double wider = discs.beyond_scene ? discs.radii_m.back() / double(discs.scene.radius_m) : 1;
  ledger_unit_lm_ = std::max(double(power.x) + power.y + power.z, 1e-30) * std::max(1.0, wider * wider) * 0x1p-20;
}

template <typename OnSegment, typename OnArrival>
void PhotonTracer::trace_paths(std::uint64_t begin, std::uint64_t end, PhotonLedger& ledger, const OnSegment& segment,
                               const OnArrival& arrival) const {
  const Scene& scene = *lit_.scene;
  const double units_a_lm = 1 / ledger_unit_lm_;
  const auto units = [&](const Rgb& power) {
    return static_cast<std::int64_t>((double(power.x) + double(power.y) + double(power.z)) * units_a_lm + 0.5);
  };

  for (std::uint64_t index = begin; index < end; ++index) {
    RandomStream random(params_.seed, StreamPurpose::photon, index);
    const EmittedPhoton photon = lit_.lights.emit(emission_, random);
    Ray ray{.origin = photon.origin, .direction = photon.direction};
    Rgb power = photon.power;
    std::int64_t carried = units(power);
    ledger.emitted += carried;
    ++ledger.photons;
    if (is_black(power)) continue;

    for (int bounce = 0;; ++bounce) {
      if (lit_.intersector.has_coverage()) ray.coverage_seed = random.next_u32();
      const float jitter = random.next();
      const std::optional<Hit> hit = lit_.intersector.closest(ray);
      ++ledger.rays;
      const bool counts = bounce > 0 || params_.include_direct;
      if (counts) segment(ray, hit, power, jitter);
      if (!hit) {
        ledger.escaped += carried;
        break;
      }
      const Surface surface = make_surface(scene, ray, *hit);
      if (counts) arrival(surface, power);
      if (bounce == params_.max_bounces) {
        ledger.terminated += carried;
        break;
      }

      const Bsdf bsdf = make_bsdf(surface);
      const V3f wo = -ray.direction;
      const float u_lobe = is_lambertian(bsdf) ? 0.0F : random.next();
      const float u_survive = random.next();
      const std::optional<BsdfSample> scattered = sample(bsdf, wo, u_lobe, random.next2());
      if (!scattered) {
        ledger.absorbed += carried;
        break;
      }
      // Russian roulette with the strongest channel of the throughput as the odds of going on: that
      // channel's power stays level, so that every segment is worth its deposit.
      const Rgb throughput = scattered->throughput * shading_normal_correction(bsdf, wo, scattered->wi);
      const float survival = std::min(1.0F, max_component(throughput));
      if (u_survive >= survival) {
        ledger.absorbed += carried;
        break;
      }
      power = power * throughput / survival;
      const std::int64_t left = units(power);
      ledger.absorbed += carried - left;
      carried = left;
      ray = spawn_ray(surface, scattered->wi);
    }
  }
}

void PhotonTracer::trace(std::uint64_t begin, std::uint64_t end, std::vector<PhotonSegment>& segments,
                         PhotonLedger& ledger) const {
  trace_paths(
      begin, end, ledger,
      [&](const Ray& ray, const std::optional<Hit>& hit, const Rgb& power, float jitter) {
        segments.push_back(
            {ray.origin, ray.direction, hit ? hit->t : std::numeric_limits<float>::infinity(), power, jitter});
      },
      [](const Surface&, const Rgb&) {});
}

void PhotonTracer::trace_arrivals(std::uint64_t begin, std::uint64_t end, std::vector<PhotonArrival>& arrivals,
                                  PhotonLedger& ledger) const {
  trace_paths(
      begin, end, ledger, [](const Ray&, const std::optional<Hit>&, const Rgb&, float) {},
      [&](const Surface& surface, const Rgb& power) {
        if (!is_black(surface.diffuse_albedo)) arrivals.push_back({surface.p, surface.ng, power});
      });
}

}  // namespace ivory
