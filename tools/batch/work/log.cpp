#include "tools/batch/work/log.h"

#include <chrono>
#include <ctime>

#include <fmt/chrono.h>

#include "grid/base/error.h"

namespace ivory {

BatchLog::BatchLog(const std::string& path) : path_(path), file_(path, std::ios::app) {
  if (!file_) throw Error(path, "cannot be written", "check its folder, or name another by --log");
}

void BatchLog::write(const std::string& line) {
  const std::scoped_lock lock(mutex_);
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  file_ << fmt::format("{:%Y-%m-%d %H:%M:%S}  {}\n", fmt::localtime(now), in_one_line(line)) << std::flush;
}

}  // namespace ivory
