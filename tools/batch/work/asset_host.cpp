#include "tools/batch/work/asset_host.h"

#include <sstream>
#include <utility>

#include <nlohmann/json.hpp>

namespace ivory {

AssetHost::AssetHost(std::string name, int asset, Board& board, BatchLog& log, BatchStop& stop, bool quiet)
    : CommandHost(CommandStage::run),
      name_(std::move(name)),
      asset_(asset),
      board_(board),
      log_(log),
      stop_(stop),
      quiet_(quiet) {}

void AssetHost::result(const nlohmann::ordered_json& object, const std::string& human) {
  std::istringstream lines(human);
  for (std::string line; std::getline(lines, line);) log_.write(name_ + ":   " + line);
  const auto plan = object.find("plan");
  if (plan == object.end() || !plan->contains("memory_bytes")) return;
  const auto& memory = (*plan)["memory_bytes"];
  if (memory.contains("high") && memory["high"].is_number()) memory_bytes_ = memory["high"].get<double>();
}

void AssetHost::note(const std::string& line) {
  const std::string warning = "warning: ";
  log_.write(name_ + ": " + line);
  const bool warns = line.starts_with(warning);
  if (warns) {
    const std::scoped_lock lock(mutex_);
    warnings_.push_back(line.substr(warning.size()));
  }
  if (!quiet_ && warns) board_.say(name_ + ": " + line, /*on_stdout=*/false);
}

void AssetHost::progress(const std::string& label, const std::string& unit, std::uint64_t done, std::uint64_t total) {
  board_.progress(asset_, label, unit, done, total);
}

}  // namespace ivory
