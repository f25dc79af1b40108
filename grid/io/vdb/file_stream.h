// Files too large to be held in memory first: a stream into a PendingFile.
#pragma once

#include <memory>
#include <ostream>
#include <string>

#include "grid/io/file.h"

namespace ivory {

// Writes and seeks. What fails is kept with its cause, and flush_all() throws it.
class FileStream : public std::ostream {
 public:
  // Writes over what `file` has under its temporary name; `path` is for messages. Throws Error where it cannot be
  // opened.
  FileStream(const PendingFile& file, const std::string& path);
  ~FileStream() override;
  FileStream(const FileStream&) = delete;
  FileStream& operator=(const FileStream&) = delete;

  // To be called before the file is renamed. Throws Error where anything could not be written.
  void flush_all();

 private:
  class Buffer;
  std::unique_ptr<Buffer> buffer_;
  std::string path_;
};

}  // namespace ivory
