// A folder that is there whole or not at all.
#pragma once

#include <string>

namespace ivory {

class PendingFolder {
 public:
  // Throws Error where `path` is a file, or a folder that is not empty and not `force`, or where nothing can be written
  // beside it.
  PendingFolder(const std::string& path, bool force);
  // Removes what was written unless commit() ran.
  ~PendingFolder();
  PendingFolder(const PendingFolder&) = delete;
  PendingFolder& operator=(const PendingFolder&) = delete;

  // The folder to write into, beside the target.
  const std::string& temporary() const { return temporary_; }
  // Puts it in the target's place; where that holds files, files of the same names give way and the others stay. Throws
  // Error where that fails.
  void commit();

 private:
  std::string path_;  // without a slash at its end
  std::string temporary_;
};

}  // namespace ivory
