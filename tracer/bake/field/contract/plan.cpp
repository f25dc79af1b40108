#include "tracer/bake/field/contract/plan.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ivory {

double ErrorModel::bias(double spacing_m) const { return std::hypot(direction, at_1m * std::pow(spacing_m, order)); }

double ErrorModel::noise(double spacing_m, double photons) const {
  return std::sqrt(noise_photons / photons) / spacing_m;
}

double ErrorModel::error(double spacing_m, double photons) const {
  return std::hypot(bias(spacing_m), noise(spacing_m, photons));
}

ErrorModel fit_errors(const std::vector<PilotErrors>& pilots, double direction) {
  constexpr double least_order = 0.5;
  constexpr double most_order = 1.25;
  const PilotErrors& fine = pilots.back();
  // Directional errors are measured at fewer points: they take no more than nine tenths of the bias.
  ErrorModel model;
  model.direction = std::min(direction, 0.9 * fine.bias);
  const auto resolution = [&](const PilotErrors& pilot) {
    return std::sqrt(std::max(1e-12, pilot.bias * pilot.bias - model.direction * model.direction));
  };
  if (pilots.size() > 1) {
    const PilotErrors& coarse = pilots[pilots.size() - 2];
    const double order = std::log(resolution(coarse) / resolution(fine)) / std::log(coarse.spacing_m / fine.spacing_m);
    model.order = std::clamp(order, least_order, most_order);
  }
  model.at_1m = resolution(fine) / std::pow(fine.spacing_m, model.order);
  model.noise_photons = std::pow(fine.noise * fine.spacing_m, 2) * fine.photons;
  return model;
}

Plan choose_plan(const std::vector<Spacing>& spacings, const ErrorModel& errors, const CostModel& costs,
                 const PlanLimits& limits) {
  constexpr double most_photons = 1e12;
  constexpr double nearly = 1.1;
  struct Offer {
    Plan plan;
    bool within = true;  // the time
  };
  std::vector<Offer> offers;
  for (std::size_t i = 0; i < spacings.size(); ++i) {
    const Spacing& s = spacings[i];
    Plan plan;
    plan.spacing = i;
    plan.bias = errors.bias(s.spacing_m);
    const double room = limits.aim * limits.aim - plan.bias * plan.bias;
    // Where the bias alone is too much, noise of half of it is what photons should reach: fewer would show, more do
    // not.
    const double noise_squared = room > 0 ? room : plan.bias * plan.bias / 4;
    double photons = limits.photons.value_or(errors.noise_photons / (s.spacing_m * s.spacing_m) / noise_squared);
    photons = std::clamp(std::ceil(photons), limits.photons ? 1.0 : limits.least_photons, most_photons);
    const auto seconds = [&](double n) {
      return costs.seconds(s.vertices, s.layers, std::max(0.0, n - s.photons_at_hand)) -
             (s.photons_at_hand > 0 ? costs.seconds(s.vertices, s.layers, 0) : 0);
    };
    bool within = true;
    if (limits.most_seconds && seconds(photons) > *limits.most_seconds) {
      const double a_photon = costs.seconds(s.vertices, s.layers, 1) - costs.seconds(s.vertices, s.layers, 0);
      const double left = *limits.most_seconds - seconds(s.photons_at_hand);
      const double fewer = s.photons_at_hand + std::max(0.0, left) / a_photon;
      within = left >= 0 && !limits.photons && fewer >= limits.least_photons;
      if (within) photons = std::min(photons, std::floor(fewer));
    }
    plan.photons = std::uint64_t(photons);
    plan.noise = errors.noise(s.spacing_m, photons);
    plan.error = std::hypot(plan.bias, plan.noise);
    plan.seconds = seconds(photons);
    plan.meets = within && plan.error <= limits.aim * (1 + 1e-9);
    offers.push_back({plan, within});
  }
  const auto cheapest = [&](const auto& counts) {
    const Plan* best = nullptr;
    for (const Offer& offer : offers) {
      if (counts(offer) && (best == nullptr || offer.plan.seconds < best->seconds)) best = &offer.plan;
    }
    return best;
  };
  if (const Plan* best = cheapest([](const Offer& o) { return o.plan.meets; })) return *best;
  double least = std::numeric_limits<double>::infinity();
  for (const Offer& offer : offers) {
    if (offer.within) least = std::min(least, offer.plan.error);
  }
  if (const Plan* best = cheapest([&](const Offer& o) { return o.within && o.plan.error <= nearly * least; }))
    return *best;
  return *cheapest([](const Offer& /*offer*/) { return true; });
}

}  // namespace ivory
