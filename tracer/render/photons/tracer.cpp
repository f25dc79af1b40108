#include "tracer/render/photons/tracer.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tracer/bsdf/bsdf.h"
#include "tracer/core/sampler.h"
#include "tracer/core/surface.h"
#include "tracer/render/photons/lambert.h"

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

// How many pieces of a photon are sent at the box: a whole number, or the odds of one. `reflected_lm` goes about evenly
// into the half space. Without a bound below, so that what sends pieces ever again, between bright walls around the
// box, sends fewer the less it carries, and ends: none carries more for it than the piece that scatters as ever.
float pieces_to_send(const AimedBox& box, float reflected_lm, float sought_lm) {
  const float pieces = reflected_lm * box.solid_angle / pi / sought_lm;
  return pieces < 1 ? pieces : std::floor(std::min(pieces, float(PhotonWindow::most_pieces)));
}

bool includes(const DirectSources& sources, const Lights& lights, int light) {
  if (light == no_index) return sources.all();
  if (lights.is_environment(std::size_t(light))) return sources.sky;
  return lights.is_punctual(std::size_t(light)) ? sources.punctual : sources.area;
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
    : lit_(lit),
      params_(params),
      emission_(params.emission ? *params.emission : lit.lights.emission(params.target)),
      surfaces_(*lit.scene) {
  // A photon carries about the total power; 2^-20 of it leaves 2^40 photons to the integers. Past the scene's sphere
  // more enters than the lights' power for the scene says.
  const Rgb power = lit.lights.total_power_lm();
  const EntryDiscs& discs = emission_.discs();
  const double wider = discs.beyond_scene ? discs.radii_m.back() / double(discs.scene.radius_m) : 1;
  ledger_unit_lm_ = std::max(double(power.x) + power.y + power.z, 1e-30) * std::max(1.0, wider * wider) * 0x1p-20;
}

template <bool arrivals_asked, typename OnSegment, typename OnArrival>
void PhotonTracer::trace_paths(std::uint64_t begin, std::uint64_t end, PhotonLedger& ledger, const OnSegment& segment,
                               const OnArrival& arrival) const {
  const double units_a_lm = 1 / ledger_unit_lm_;
  const auto units = [&](const Rgb& power) {
    // No power is negative, and llround() is a call. NOLINTNEXTLINE(bugprone-incorrect-roundings)
    return static_cast<std::int64_t>((double(power.x) + double(power.y) + double(power.z)) * units_a_lm + 0.5);
  };

  // A photon under way, or a piece of one.
  struct Piece {
    Ray ray;
    Rgb power;
    std::int64_t carried;
    int bounce;
    int pieces;  // that its photon was split into on the way here
  };
  const bool all_alike = !params_.window && !params_.aim;
  const bool has_coverage = lit_.intersector.has_coverage();
  std::vector<Piece> waiting;  // the last first: the order of random numbers is that of the path alone
  for (std::uint64_t index = begin; index < end; ++index) {
    RandomStream random(params_.seed, params_.purpose, index);
    const EmittedPhoton photon = lit_.lights.emit(emission_, random);
    const std::int64_t emitted = units(photon.power);
    ledger.emitted += emitted;
    ++ledger.photons;
    if (is_black(photon.power)) continue;
    const bool straight = includes(params_.include_direct, lit_.lights, photon.light);
    const float sought_lm =
        params_.aim && params_.aim->sought_lm > 0 ? params_.aim->sought_lm : max_component(photon.power);
    waiting.push_back({Ray{.origin = photon.origin, .direction = photon.direction}, photon.power, emitted, 0, 1});

    // The fast way on from a flat, plain Lambertian surface, as most are: what sample() and spawn_ray() below do, but
    // the lot is drawn before the surface is looked at. Changes `piece` into what goes on; false where nothing does.
    const auto scatter_plainly = [&](const PlainInstance& plain, const Hit& hit, Piece& piece) {
      const bool counts = piece.bounce > 0 || straight;
      Surface surface;
      const float cosine = piece.ray.direction.dot(hit.ng);
      surface.ng = cosine <= 0 ? hit.ng : -hit.ng;
      if (arrivals_asked && counts) {
        PlainSurfaces::place(plain, hit, surface);
        surface.diffuse_albedo = plain.diffuse_albedo;
        arrival(surface, piece.power);
      }
      if (piece.bounce == params_.max_bounces) {
        ledger.terminated += piece.carried;
        return false;
      }
      ledger.absorbed += piece.carried;
      const float survival = max_component(plain.diffuse_albedo);
      const float u_survive = random.next();
      const V2f u = random.next2();
      constexpr float min_cosine = 1e-6F;
      if (!(std::abs(cosine) > min_cosine) || !(u_survive < survival)) return false;
      if (!(arrivals_asked && counts)) PlainSurfaces::place(plain, hit, surface);
      piece.power = piece.power * plain.diffuse_albedo / survival;
      piece.carried = units(piece.power);
      ledger.absorbed -= piece.carried;
      piece.ray = spawn_ray(surface, cosine_direction(surface.ng, u));
      ++piece.bounce;
      return true;
    };

    while (!waiting.empty()) {
      Piece piece = waiting.back();
      waiting.pop_back();
      std::optional<Hit> hit;
      bool ended = false;
      for (;;) {
        if (has_coverage) piece.ray.coverage_seed = random.next_u32();
        const float jitter = random.next();
        hit = lit_.intersector.closest(piece.ray);
        ++ledger.rays;
        if (piece.bounce > 0 || straight) segment(piece.ray, hit, piece.power, jitter, photon.light);
        if (!hit || !all_alike) break;
        const PlainInstance& plain = surfaces_.instance(hit->instance);
        if (plain.mesh == nullptr || !plain.is_lambert || !plain.is_flat(hit->triangle)) break;
        ended = !scatter_plainly(plain, *hit, piece);
        if (ended) break;
      }
      if (ended) continue;
      // By name: Clang 14 does not capture structured bindings.
      Ray& ray = piece.ray;
      Rgb& power = piece.power;
      std::int64_t& carried = piece.carried;
      const int bounce = piece.bounce;
      int& pieces = piece.pieces;
      const bool counts = bounce > 0 || straight;
      if (!hit) {
        ledger.escaped += carried;
        continue;
      }
      const Surface surface = surfaces_.make_scattering(ray, *hit);
      if (arrivals_asked && counts) arrival(surface, power);
      if (bounce == params_.max_bounces) {
        ledger.terminated += carried;
        continue;
      }

      int copies = 1;
      if (params_.window) {
        const float here_lm = params_.window->at(surface.p, surface.ng);
        const float ratio = here_lm > 0 ? max_component(power) / here_lm : 1.0F;
        if (ratio >= PhotonWindow::split_above) {
          copies = std::min(
              {int(std::min(ratio, 1000.0F)), PhotonWindow::most_pieces, PhotonWindow::most_pieces_a_photon / pieces});
          copies = std::max(copies, 1);
          power /= float(copies);
          pieces *= copies;
        } else if (ratio < PhotonWindow::lot_below) {
          const float odds = std::max(2 * ratio, PhotonWindow::least_odds);
          if (random.next() >= odds) {
            ledger.absorbed += carried;
            continue;
          }
          power /= odds;
          const std::int64_t left = units(power);
          ledger.absorbed += carried - left;
          carried = left;
        }
      }

      const Bsdf bsdf = make_bsdf(surface);
      const V3f wo = -ray.direction;
      const AimedBox box = params_.aim ? aim(*params_.aim, surface.p) : AimedBox{};
      float sent = 0;
      if (box.area_m2 > 0) {
        const Rgb reflected = power * (bsdf.diffuse_albedo + bsdf.f0);
        sent = pieces_to_send(box, max_component(reflected), sought_lm);
        if (sent * float(pieces) > float(PhotonWindow::most_pieces_a_photon)) sent = std::min(sent, 1.0F);
      }
      const auto go_on = [&](const V3f& wi, const Rgb& throughput, float survival, int of) {
        const Rgb on = power * throughput / survival;
        const std::int64_t left = units(on);
        ledger.absorbed -= left;
        waiting.push_back({spawn_ray(surface, wi), on, left, bounce + 1, of});
      };
      ledger.absorbed += carried;
      for (int copy = 0; copy < copies; ++copy) {
        const float u_lobe = is_lambertian(bsdf) ? 0.0F : random.next();
        const float u_survive = random.next();
        std::optional<BsdfSample> scattered = sample(bsdf, wo, u_lobe, random.next2(), Lobes::all, LightFrom::wo);
        if (!scattered) continue;
        if (sent > 0) {
          const float own = scattered->pdf_solid_angle;
          scattered->throughput *= own / (own + sent * pdf_solid_angle(*params_.aim, box, scattered->wi));
        }
        // Russian roulette with the strongest channel of the throughput as the odds of going on: that
        // channel's power stays level, so that every segment is worth its deposit.
        const Rgb throughput = scattered->throughput * shading_normal_correction(bsdf, wo, scattered->wi);
        const float survival = std::min(1.0F, max_component(throughput));
        if (u_survive < survival) go_on(scattered->wi, throughput, survival, pieces);
      }
      if (sent == 0 || (sent < 1 && random.next() >= sent)) continue;
      const int whole = std::max(1, int(sent));
      for (int i = 0; i < whole * copies; ++i) {
        const float u_face = random.next();
        const V3f wi = sample(*params_.aim, box, u_face, random.next2());
        const BsdfValue value = eval_with_pdf(bsdf, wo, wi, LightFrom::wo);
        const float density = value.pdf_solid_angle + sent * pdf_solid_angle(*params_.aim, box, wi);
        if (is_black(value.value) || !(density > 0)) continue;
        go_on(wi, value.value / density * shading_normal_correction(bsdf, wo, wi), 1, pieces * whole);
      }
    }
  }
}

void PhotonTracer::trace(std::uint64_t begin, std::uint64_t end, std::vector<PhotonSegment>& segments,
                         PhotonLedger& ledger) const {
  trace_paths<false>(
      begin, end, ledger,
      [&](const Ray& ray, const std::optional<Hit>& hit, const Rgb& power, float jitter, int light) {
        segments.push_back(
            {ray.origin, ray.direction, hit ? hit->t : std::numeric_limits<float>::infinity(), power, jitter, light});
      },
      [](const Surface&, const Rgb&) {});
}

void PhotonTracer::trace_arrivals(std::uint64_t begin, std::uint64_t end, std::vector<PhotonArrival>& arrivals,
                                  PhotonLedger& ledger) const {
  trace_paths<true>(
      begin, end, ledger, [](const Ray&, const std::optional<Hit>&, const Rgb&, float, int) {},
      [&](const Surface& surface, const Rgb& power) {
        if (!is_black(surface.diffuse_albedo)) arrivals.push_back({surface.p, surface.ng, power});
      });
}

}  // namespace ivory
