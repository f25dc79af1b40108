#include "grid/io_file.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

#include <OpenImageIO/hash.h>
#include <fmt/format.h>
#include <unistd.h>

#include "grid/error.h"

namespace ivory {

namespace fs = std::filesystem;

PendingFile::PendingFile(std::string path, bool force) : path_(std::move(path)) {
  const fs::path target(path_);
  if (fs::is_directory(target)) throw Error(path_, "is a folder", "give a file name");
  if (fs::exists(target) && !fs::is_regular_file(target))
    throw Error(path_, "is not an ordinary file", "give another name");  // a device would be replaced by a file
  if (!force && fs::exists(target)) throw Error(path_, "already exists", "give --force to overwrite it");
  temporary_ = (target.parent_path() / ("." + target.stem().string() + "." + std::to_string(::getpid()) + ".part" +
                                        target.extension().string()))
                   .string();
  if (!std::ofstream(temporary_))
    throw Error(path_, "cannot be written", "check that its folder exists and is writable");
}

PendingFile::~PendingFile() {
  if (committed_) return;
  std::error_code ignored;  // nothing sensible is left to do in a destructor
  fs::remove(temporary_, ignored);
}

void PendingFile::commit() {
  std::error_code error;
  fs::rename(temporary_, path_, error);
  if (error)
    throw Error(path_, "cannot be renamed into place (" + error.message() + ")", "check the folder's permissions");
  committed_ = true;
}

std::string file_hash(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  if (!file) throw Error(path, "cannot be read", "check that it exists and is readable");
  return fmt::format("{:016x}", OIIO::xxhash::XXH64(bytes.data(), bytes.size(), 0));
}

}  // namespace ivory
