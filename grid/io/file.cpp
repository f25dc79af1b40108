#include "grid/io/file.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <system_error>
#include <utility>

#include <OpenImageIO/hash.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "grid/base/error.h"

namespace ivory {

namespace fs = std::filesystem;

namespace {

// What a chain of symbolic links points to, whether it exists or not. fs::weakly_canonical() would take a link to a
// file that is not there for the file.
fs::path behind_links(fs::path path) {
  constexpr int most_links = 40;  // as Linux follows
  std::error_code error;
  for (int i = 0; i < most_links && fs::is_symlink(path, error); ++i) {
    const fs::path next = fs::read_symlink(path, error);
    if (error) break;
    path = next.is_absolute() ? next : path.parent_path() / next;
  }
  return path;
}

// Makes an empty file beside the target under a name that is nobody's; empty where the folder cannot be written to.
std::string make_temporary(const fs::path& target) {
  std::random_device random;
  for (int attempt = 0; attempt < 100; ++attempt) {
    const std::string name = fmt::format(".{}.{}.{:08x}{:08x}.part{}", target.stem().string(), ::getpid(), random(),
                                         random(), target.extension().string());
    std::string path = (target.parent_path() / name).string();
    const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file >= 0) {
      ::close(file);
      return path;
    }
    if (errno != EEXIST) break;
  }
  return "";
}

// Waits until a file or a folder is on the disk; 0 or errno. File systems without such a thing say EINVAL.
int sync_to_disk(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return errno;
  const int error = ::fsync(file) == 0 || errno == EINVAL ? 0 : errno;
  ::close(file);
  return error;
}

}  // namespace

PendingFile::PendingFile(std::string path, bool force) : path_(std::move(path)) {
  const fs::path target = behind_links(path_);
  target_ = target.string();
  std::error_code unreadable;  // then it does not exist, or it shows when it is written to
  if (fs::is_symlink(target, unreadable)) throw Error(path_, "is a loop of symbolic links", "give another name");
  if (fs::is_directory(target, unreadable)) throw Error(path_, "is a folder", "give a file name");
  if (fs::exists(target, unreadable) && !fs::is_regular_file(target, unreadable))
    throw Error(path_, "is not an ordinary file", "give another name");  // a device would be replaced by a file
  if (!force && fs::exists(target, unreadable))
    throw Error(path_, "already exists", "give another name, or ask to overwrite it");
  temporary_ = make_temporary(target);
  if (temporary_.empty()) throw Error(path_, "cannot be written", "check that its folder exists and is writable");
}

PendingFile::~PendingFile() {
  if (committed_) return;
  std::error_code ignored;  // nothing sensible is left to do in a destructor
  fs::remove(temporary_, ignored);
}

void PendingFile::commit() {
  if (const int error = sync_to_disk(temporary_))
    throw Error(path_, "cannot be written (" + std::generic_category().message(error) + ")", "check the disk");
  std::error_code error;
  fs::rename(temporary_, target_, error);
  if (error)
    throw Error(path_, "cannot be renamed into place (" + error.message() + ")", "check the folder's permissions");
  committed_ = true;
  // The file is complete under its name; a folder that may not be read cannot be waited for, and need not be.
  const std::string folder = fs::path(target_).parent_path().string();
  sync_to_disk(folder.empty() ? "." : folder);
}

void write_file(const std::string& path, std::string_view bytes, bool force) {
  PendingFile pending(path, force);
  const int file = ::open(pending.temporary().c_str(), O_WRONLY | O_TRUNC | O_CLOEXEC);
  int error = file < 0 ? errno : 0;
  while (error == 0 && !bytes.empty()) {
    const ssize_t written = ::write(file, bytes.data(), std::min(bytes.size(), std::size_t(1) << 30U));
    if (written > 0) {
      bytes.remove_prefix(std::size_t(written));
    } else if (written == 0 || errno != EINTR) {
      error = written == 0 ? ENOSPC : errno;
    }
  }
  if (file >= 0 && ::close(file) != 0 && error == 0) error = errno;  // network disks say it late
  if (error != 0) {
    const bool full = error == ENOSPC || error == EDQUOT || error == EFBIG;
    throw Error(path, "cannot be written (" + std::generic_category().message(error) + ")",
                full ? "make room on its disk, or write elsewhere" : "check the disk");
  }
  pending.commit();
}

std::string lower_extension(const std::string& path) {
  std::string extension = fs::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return char(std::tolower(c)); });
  return extension;
}

std::string file_hash(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  if (!file) throw Error(path, "cannot be read", "check that it exists and is readable");
  return fmt::format("{:016x}", OIIO::xxhash::XXH64(bytes.data(), bytes.size(), 0));
}

}  // namespace ivory
