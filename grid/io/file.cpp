#include "grid/io/file.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <system_error>
#include <utility>

#include <OpenImageIO/hash.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
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

// A name beside the target that is nobody's. As long as file systems bear whatever the target's is: of a long one its
// beginning, cut between characters of UTF-8.
std::string temporary_name(const fs::path& target, std::random_device& random) {
  constexpr std::size_t longest_stem = 60;
  constexpr std::size_t longest_extension = 16;  // those that say what is in the file are far shorter
  std::string stem = target.stem().string();
  if (stem.size() > longest_stem) {
    std::size_t end = longest_stem;
    while (end > 0 && (static_cast<unsigned char>(stem[end]) & 0xC0U) == 0x80U) --end;
    stem.resize(end);
  }
  std::string extension = target.extension().string();
  if (extension.size() > longest_extension) extension.clear();
  return fmt::format(".{}.{}.{:08x}{:08x}.part{}", stem, ::getpid(), random(), random(), extension);
}

std::string message_of(int error) { return std::generic_category().message(error); }

// What to do about a file that cannot be made or written.
const char* remedy_of(int error) {
  switch (error) {
    case ENOENT:
    case ENOTDIR:
      return "make its folder first, or give another name";
    case EACCES:
    case EPERM:
    case EROFS:
      return "give a name in a folder that may be written to";
    case ENOSPC:
    case EDQUOT:
      return "free some space on its disk, or write to another";
    case EFBIG:
      return "raise the limit of file sizes (ulimit -f)";
    case EMFILE:
    case ENFILE:
      return "raise the limit of open files (ulimit -n)";
    case ENAMETOOLONG:
      return "give a shorter name";
    default:
      return "check its folder and its disk";
  }
}

}  // namespace

Error not_written(const std::string& path, int error) {
  return {path, "cannot be written (" + message_of(error) + ")", remedy_of(error)};
}

namespace {

// Makes an empty file beside the target under a name that is nobody's; 0 or errno.
int make_temporary(const fs::path& target, std::string& path) {
  std::random_device random;
  for (int attempt = 0; attempt < 100; ++attempt) {
    path = (target.parent_path() / temporary_name(target, random)).string();
    const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file >= 0) return ::close(file) == 0 ? 0 : errno;
    if (errno != EEXIST) break;
  }
  return errno;
}

// Waits until a file or a folder is on the disk; 0 or errno. File systems without such a thing say EINVAL.
int sync_to_disk(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return errno;
  const int error = ::fsync(file) == 0 || errno == EINVAL ? 0 : errno;
  ::close(file);
  return error;
}

// Renames unless the new name is taken; 0 or errno, EEXIST where it is.
int rename_to_free_name(const std::string& from, const std::string& to) {
  if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return 0;
  if (errno != EINVAL && errno != ENOSYS) return errno;
  // A file system that cannot: two names for a moment, or, where it has no such links either, a look beforehand.
  if (::link(from.c_str(), to.c_str()) == 0) {
    ::unlink(from.c_str());
    return 0;
  }
  if (errno == EEXIST || ::access(to.c_str(), F_OK) == 0) return EEXIST;
  return ::rename(from.c_str(), to.c_str()) == 0 ? 0 : errno;
}

}  // namespace

PendingFile::PendingFile(std::string path, bool force) : path_(std::move(path)), force_(force) {
  const fs::path target = behind_links(path_);
  target_ = target.string();
  std::error_code unreadable;  // then it does not exist, or it shows when it is written to
  if (fs::is_symlink(target, unreadable)) throw Error(path_, "is a loop of symbolic links", "give another name");
  // By the name as given: what /dev/stdout is, its links alone do not say.
  const fs::file_status status = fs::status(path_, unreadable);
  if (fs::is_directory(status)) throw Error(path_, "is a folder", "give a file name");
  if (fs::exists(status) && !fs::is_regular_file(status))  // which a file would replace
    throw Error(path_, "is a device or a pipe, and files are written under another name first", "give a file name");
  if (!force && fs::exists(status)) throw Error(path_, "already exists", "give another name, or ask to overwrite it");
  // The temporary name is shorter, so that this would show only when it is renamed, after hours.
  struct stat unused {};
  if (::lstat(target_.c_str(), &unused) != 0 && errno == ENAMETOOLONG) throw not_written(path_, ENAMETOOLONG);
  if (const int error = make_temporary(target, temporary_)) throw not_written(path_, error);
}

PendingFile::~PendingFile() {
  if (kept_) return;
  std::error_code ignored;  // nothing sensible is left to do in a destructor
  fs::remove(temporary_, ignored);
}

void PendingFile::commit() {
  if (const int error = sync_to_disk(temporary_)) throw not_written(path_, error);
  const int error = force_ ? (::rename(temporary_.c_str(), target_.c_str()) == 0 ? 0 : errno)
                           : rename_to_free_name(temporary_, target_);
  if (error == EEXIST) {
    kept_ = true;
    throw Error(path_, "was made by another program in the meantime and stays",
                "this result is " + temporary_ + ", to be renamed");
  }
  if (error != 0) throw not_written(path_, error);
  kept_ = true;
  // The file is complete under its name; a folder that may not be read cannot be waited for, and need not be.
  const std::string folder = fs::path(target_).parent_path().string();
  sync_to_disk(folder.empty() ? "." : folder);
}

void write_file(const std::string& path, std::string_view bytes, bool force) {
  PendingFile pending(path, force);
  // No stream, whose failures have no cause.
  const int file = ::open(pending.temporary().c_str(), O_WRONLY | O_CLOEXEC);
  int error = file < 0 ? errno : 0;
  while (error == 0 && !bytes.empty()) {
    const ssize_t count = ::write(file, bytes.data(), bytes.size());
    if (count >= 0) {
      bytes.remove_prefix(std::size_t(count));
    } else if (errno != EINTR) {
      error = errno;
    }
  }
  if (file >= 0 && ::close(file) != 0 && error == 0) error = errno;
  if (error != 0) throw not_written(path, error);
  pending.commit();
}

std::string lower_extension(const std::string& path) {
  std::string extension = fs::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return char(std::tolower(c)); });
  return extension;
}

std::string text_hash(std::string_view bytes) {
  return fmt::format("{:016x}", OIIO::xxhash::XXH64(bytes.data(), bytes.size(), 0));
}

std::string file_hash(const std::string& path) {
  // A folder opens, and fails in the stream's own words when it is read.
  std::error_code unreadable;
  std::ifstream file(path, std::ios::binary);
  if (!file || fs::is_directory(path, unreadable))
    throw Error(path, "cannot be read", "check that it exists and is readable");
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  return text_hash(bytes);
}

}  // namespace ivory
