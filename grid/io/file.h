// Files as wholes: written under a temporary name beside the target, then renamed; and hashed.
#pragma once

#include <string>
#include <string_view>

#include "grid/base/error.h"

namespace ivory {

// What to throw where a file cannot be made or written; `error` is errno.
Error not_written(const std::string& path, int error);

class PendingFile {
 public:
  // Throws Error where `path` exists and not `force`, where it is no ordinary file (a folder, a device, a pipe), or
  // where its folder cannot be written to. A symbolic link stands for what it points to, and stays.
  PendingFile(std::string path, bool force);
  // Removes the temporary file unless commit() ran.
  ~PendingFile();
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;

  // The name to write to: beside the target, with the target's extension. No other process, on this machine or on
  // another that shares the folder, has the same. Hidden, and begins as the target does: a process that is killed while
  // it writes leaves it, and nobody misses it.
  const std::string& temporary() const { return temporary_; }
  // Brings what was written onto the disk, then renames it onto the target: after a loss of power there is the old file
  // or the whole new one. Throws Error where that fails. Where another process has made the target since and not
  // `force`, neither is lost: the Error names the temporary file, which stays.
  void commit();

 private:
  std::string path_;    // as given, for messages
  std::string target_;  // behind symbolic links
  std::string temporary_;
  bool force_;
  bool kept_ = false;  // the temporary file, or the target in its place
};

// Writes a file of these bytes, whole or not at all. Throws Error as PendingFile does, and where it cannot be written.
void write_file(const std::string& path, std::string_view bytes, bool force);

// A file name's extension with its dot, in lower case: ".exr" of "A.EXR"; "" where it has none.
std::string lower_extension(const std::string& path);

// Hash (XXH64, 16 hexadecimal digits) of bytes.
std::string text_hash(std::string_view bytes);

// The same of a file's bytes. Throws Error where it cannot be read.
std::string file_hash(const std::string& path);

}  // namespace ivory
