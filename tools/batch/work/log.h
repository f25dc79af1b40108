// What a person reads in the morning.
#pragma once

#include <fstream>
#include <mutex>
#include <string>

namespace ivory {

// Lines with the time of day, added at the end of a file and there at once. Thread-safe.
class BatchLog {
 public:
  // Throws Error where the file cannot be written.
  explicit BatchLog(const std::string& path);
  void write(const std::string& line);
  const std::string& path() const { return path_; }

 private:
  std::string path_;
  std::ofstream file_;
  std::mutex mutex_;
};

}  // namespace ivory
