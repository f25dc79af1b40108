#include "tracer/bake/field/contract/journal.h"

#include <cstdlib>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "grid/base/error.h"
#include "grid/io/file.h"
#include "grid/io/vdb/vdb.h"
#include "tracer/bake/field/grid_checkpoint.h"

namespace ivory {
namespace {

const std::string reached_name = checkpoint_prefix + "reached";

std::string text_of(const V3f& v) { return fmt::format("{:a},{:a},{:a}", v.x, v.y, v.z); }
std::string text_of(const Box3f& box) { return text_of(box.min) + ":" + text_of(box.max); }

// All that decides what a bake to an error comes to, as text to be hashed: numbers to the last bit. Threads are not of
// it.
std::string identity(const LitScene& lit, const ContractParams& params) {
  const GridBakeParams& bake = params.bake;
  std::string text = fmt::format("scene={} {}\ncpu={}\n", lit.scene->name, lit.scene->content_hash,
                                 checkpoint_cpu(lit.intersector.portable()));
  for (const auto& [key, value] : bake.checkpoint->origin)
    text += key + "=" + std::visit([](const auto& v) { return fmt::format("{}", v); }, value) + "\n";
  text += fmt::format("target={:a} domain={} guard={} most_work={:a}\n", params.target, name_of(params.domain),
                      name_of(params.lookup.guard), params.most_work.value_or(0));
  for (const DomainPoint& point : params.points)
    text += fmt::format("point={} {} {:a}\n", text_of(point.p), text_of(point.n), point.weight);
  if (bake.bounds) text += "bounds=" + text_of(*bake.bounds) + "\n";
  if (bake.resolution)
    text += fmt::format("size={},{},{}\n", bake.resolution->x, bake.resolution->y, bake.resolution->z);
  if (bake.dynamic_regions) {
    text += "regions=";
    for (const Box3f& region : *bake.dynamic_regions) text += text_of(region) + " ";
  }
  text += fmt::format("\nrotate={:a} voxel={:a} levels={} photons={} bounces={} seed={} memory={}\n", bake.rotate_y_deg,
                      bake.voxel_size_m.value_or(0), bake.levels, bake.photons, bake.max_bounces, bake.seed,
                      bake.max_memory_bytes);
  text +=
      fmt::format("basis={} estimator={} guard={} light={} emission={}\n", name_of(bake.basis), name_of(bake.estimator),
                  name_of(bake.guard), name_of(stored_light(bake.include_direct)), name_of(bake.emission));
  if (bake.groups)
    text += fmt::format("groups={} {}\n", fmt::join(bake.groups->names, ","), fmt::join(bake.groups->of_light, ","));
  return text;
}

// "error noise" of each, as hexadecimal numbers.
std::vector<ReachedError> parse(const std::string& text) {
  std::vector<ReachedError> all;
  const char* at = text.c_str();
  for (;;) {
    char* end = nullptr;
    ReachedError reached;
    reached.error = std::strtod(at, &end);
    if (end == at) return all;
    at = end;
    reached.noise = std::strtod(at, &end);
    at = end;
    all.push_back(reached);
  }
}

}  // namespace

Journal::Journal(const LitScene& lit, const ContractParams& params) {
  if (!params.bake.checkpoint) return;
  policy_ = params.bake.checkpoint;
  policy_->origin[checkpoint_series] = text_hash(identity(lit, params));
  std::error_code unreadable;  // then reading it says why
  if (policy_->path.empty() || !std::filesystem::exists(policy_->path, unreadable)) return;
  const std::string why = checkpoint_fault(*policy_, [&](const Metadata& found) {
    if (find_text(found, checkpoint_series) != find_text(policy_->origin, checkpoint_series))
      return std::string("its scene or options differ");
    reached_ = parse(find_text(found, reached_name).value_or(""));
    return std::string();
  });
  if (why.empty()) return;
  // It has been said; the bakes need not say it again.
  policy_->on_event = [said = policy_->on_event](const CheckpointEvent& event) {
    if (said && event.kind != CheckpointEvent::Kind::replaced) said(event);
  };
}

ReachedError Journal::reached(const std::function<ReachedError()>& measure) {
  if (!is_known()) reached_.push_back(measure());
  return reached_[next_++];
}

std::optional<CheckpointPolicy> Journal::policy() const {
  if (!policy_) return std::nullopt;
  std::string text;
  for (const ReachedError& reached : reached_) text += fmt::format("{:a} {:a} ", reached.error, reached.noise);
  CheckpointPolicy policy = *policy_;
  policy.origin[reached_name] = text;
  return policy;
}

}  // namespace ivory
