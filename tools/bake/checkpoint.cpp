#include "tools/bake/checkpoint.h"

#include <filesystem>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tools/cli/host.h"
#include "tools/cli/interrupt.h"

namespace ivory {

namespace fs = std::filesystem;

struct KeptCheckpoint::Signals {
  Interrupt interrupt;
};

void add_checkpoint_option(Command command, CheckpointOptions& options, const std::string& description) {
  command
      .add_option(
          "--checkpoint",
          [&options](const std::string& text) {
            const auto minutes = parse_number(text);
            if (!minutes || !(*minutes >= 0))
              throw UsageError("--checkpoint: '" + text + "' is not a number of minutes, 0 or more");
            options.minutes = *minutes;
            options.is_given = true;
          },
          description)
      .type_name("MINUTES")
      .default_str(fmt::format("{}", options.minutes));
}

void refuse_checkpoint_option(Command command) {
  command
      .add_option(
          "--checkpoint",
          [](const std::string&) {
            throw UsageError("--checkpoint: this bake keeps none; only 'ivory bake grid' does");
          },
          "Refused")
      .group("");
}

std::string checkpoint_path(const std::string& output) {
  const fs::path path(output);
  return (path.parent_path() / (path.stem().string() + ".checkpoint" + path.extension().string())).string();
}

KeptCheckpoint::KeptCheckpoint(const CheckpointOptions& options, const std::string& output, Metadata origin,
                               const CommonOptions& common, std::string unit)
    : common_(common), unit_(std::move(unit)) {
  policy_.origin = std::move(origin);
  policy_.every_s = 60 * options.minutes;
  policy_.replace = common.force;
  const std::string path = checkpoint_path(output);
  if (options.minutes > 0) {
    policy_.path = path;
    return;
  }
  std::error_code unreadable;
  if (fs::exists(path, unreadable)) {
    warnings_.push_back(path + ": is not gone on from, as without --checkpoint");
    print_note(common, "warning: " + warnings_.back());
  }
}

KeptCheckpoint::~KeptCheckpoint() { baked(); }

std::optional<CheckpointPolicy> KeptCheckpoint::policy(Progress& progress) {
  if (policy_.path.empty()) return std::nullopt;
  // In a host's process signals are the host's.
  if (CommandHost* host = common_.host; host != nullptr) {
    host->set_stoppable(Stoppable::yes);
    policy_.stop = [host] { return host->stop_asked(); };
  } else {
    signals_ = std::make_unique<Signals>();
    std::error_code unreadable;
    signals_->interrupt.set_last_words(
        fs::exists(policy_.path, unreadable)
            ? "ivory: stopped; the same command goes on from " + policy_.path
            : "ivory: stopped before there was anything to keep; the same command starts anew");
    policy_.stop = [this] { return signals_->interrupt.asked(); };
  }
  policy_.on_event = [this, &progress](const CheckpointEvent& event) { note(event, progress); };
  return policy_;
}

void KeptCheckpoint::note(const CheckpointEvent& event, Progress& progress) {
  const bool saves = event.kind == CheckpointEvent::Kind::writing;
  if (signals_) signals_->interrupt.be_patient(saves);
  if (common_.host != nullptr) common_.host->set_stoppable(saves ? Stoppable::saving : Stoppable::yes);
  switch (event.kind) {
    case CheckpointEvent::Kind::writing:
      return;
    case CheckpointEvent::Kind::written:
      ++written_;
      seconds_ += event.seconds;
      if (signals_) signals_->interrupt.set_last_words("ivory: stopped; the same command goes on from " + policy_.path);
      return;
    case CheckpointEvent::Kind::resumed:
      resumed_ = event.done;
      return progress.say("note: " + event.line);
    case CheckpointEvent::Kind::replaced:
    case CheckpointEvent::Kind::failed:
      // A full disk stays full: once is enough.
      if (!warnings_.empty() && warnings_.back() == event.line) return;
      warnings_.push_back(event.line);
      return progress.say("warning: " + event.line);
  }
}

void KeptCheckpoint::baked() {
  signals_.reset();
  if (common_.host != nullptr) common_.host->set_stoppable(Stoppable::no);
}

void KeptCheckpoint::finish(nlohmann::ordered_json& result) {
  if (resumed_ || written_ > 0) {
    std::error_code error;
    if (!fs::remove(policy_.path, error) && error) {
      warnings_.push_back(policy_.path + ": cannot be removed (" + error.message() + "), though all is done");
      print_note(common_, "warning: " + warnings_.back());
    }
    result["checkpoint"] = {{"file", policy_.path}, {"written", written_}, {"seconds", seconds_}};
    if (resumed_) result["checkpoint"]["resumed_" + unit_] = *resumed_;
  }
  for (const std::string& warning : warnings_) result["warnings"].push_back(warning);
}

}  // namespace ivory
