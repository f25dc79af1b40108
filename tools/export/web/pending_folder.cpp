#include "tools/export/web/pending_folder.h"

#include <filesystem>
#include <system_error>

#include <sys/stat.h>
#include <unistd.h>

#include "grid/base/error.h"

namespace ivory {

namespace fs = std::filesystem;

namespace {

bool is_empty_folder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error) && fs::is_empty(path, error);
}

}  // namespace

PendingFolder::PendingFolder(const std::string& path, bool force) : path_(path) {
  while (path_.size() > 1 && path_.back() == '/') path_.pop_back();
  std::error_code error;
  if (fs::exists(path_, error)) {
    if (!fs::is_directory(path_, error)) throw Error(path_, "is a file", "name a folder");
    if (!force && !is_empty_folder(path_)) throw Error(path_, "exists already", "pass --force to write into it");
  }
  const fs::path target(path_);
  std::string pattern = (target.parent_path() / ("." + target.filename().string() + ".XXXXXX")).string();
  if (mkdtemp(pattern.data()) == nullptr) {
    throw Error(path_, "cannot be written: " + std::error_code(errno, std::generic_category()).message(),
                "make its parent folder, or choose another");
  }
  temporary_ = pattern;
  // As any new folder: a server of another user may read it.
  const mode_t mask = umask(0);
  umask(mask);
  chmod(temporary_.c_str(), 0777 & ~mask);
}

PendingFolder::~PendingFolder() {
  std::error_code error;
  if (!temporary_.empty()) fs::remove_all(temporary_, error);
}

void PendingFolder::commit() {
  std::error_code error;
  const auto check = [&] {
    if (error) throw Error(path_, "cannot be written: " + error.message(), "free space, or choose another folder");
  };
  if (!fs::exists(path_, error) || is_empty_folder(path_)) {
    fs::rename(temporary_, path_, error);
    check();
    temporary_.clear();
    return;
  }
  for (const auto& entry : fs::recursive_directory_iterator(temporary_)) {
    const fs::path to = fs::path(path_) / fs::relative(entry.path(), temporary_);
    if (entry.is_directory()) {
      fs::create_directories(to, error);
    } else {
      fs::rename(entry.path(), to, error);
    }
    check();
  }
}

}  // namespace ivory
