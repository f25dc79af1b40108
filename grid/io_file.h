// Files as wholes: written under a temporary name beside the target, then renamed; and hashed.
#pragma once

#include <string>

namespace ivory {

class PendingFile {
 public:
  // Throws Error where `path` exists and not `force`, or where its folder cannot be written to.
  PendingFile(std::string path, bool force);
  // Removes the temporary file unless commit() ran.
  ~PendingFile();
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;

  // The name to write to: beside the target, with the target's extension.
  const std::string& temporary() const { return temporary_; }
  // Renames onto the target. Throws Error where that fails.
  void commit();

 private:
  std::string path_;
  std::string temporary_;
  bool committed_ = false;
};

// Hash (XXH64, 16 hexadecimal digits) of a file's bytes. Throws Error where it cannot be read.
std::string file_hash(const std::string& path);

}  // namespace ivory
