// Takes what the command of an asset prints.
#pragma once

#include <mutex>
#include <string>
#include <vector>

#include "tools/batch/work/board.h"
#include "tools/batch/work/log.h"
#include "tools/batch/work/stop.h"
#include "tools/cli/host.h"

namespace ivory {

class AssetHost : public CommandHost {
 public:
  AssetHost(std::string name, int asset, Board& board, BatchLog& log, BatchStop& stop, bool quiet);

  void result(const nlohmann::ordered_json& object, const std::string& human) override;
  void note(const std::string& line) override;
  void progress(const std::string& label, const std::string& unit, std::uint64_t done, std::uint64_t total) override;
  void set_stoppable(Stoppable state) override { stop_.set(asset_, state); }
  bool stop_asked() const override { return stop_.asked(); }

  // Of notes those that are warnings, without that word.
  const std::vector<std::string>& warnings() const { return warnings_; }
  // At most, as the result's plan says it; 0 where it says nothing.
  double planned_memory_bytes() const { return memory_bytes_; }

 private:
  std::string name_;
  int asset_;
  Board& board_;
  BatchLog& log_;
  BatchStop& stop_;
  bool quiet_;
  std::vector<std::string> warnings_;
  double memory_bytes_ = 0;
  std::mutex mutex_;
};

}  // namespace ivory
