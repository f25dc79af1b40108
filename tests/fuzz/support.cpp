#include "tests/fuzz/support.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>

#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "grid/base/error.h"

// What `ulimit -v` grants, as grid/base/memory.cpp asks for it. The kernel is not told: AddressSanitizer's own memory
// would not fit. Sanitizers call this before they can bear instrumented code.
extern "C" __attribute__((no_sanitize("address", "undefined", "coverage"))) int getrlimit(__rlimit_resource_t resource,
                                                                                          rlimit* limits) noexcept {
  const long result = ::syscall(SYS_prlimit64, 0, resource, nullptr, limits);
  if (result == 0 && resource == RLIMIT_AS) limits->rlim_cur = ivory::fuzz::machine_bytes;
  return int(result);
}

namespace ivory::fuzz {

namespace fs = std::filesystem;

namespace {

// Removed when the process ends; one that falls leaves it.
class Folder {
 public:
  Folder() {
    const fs::path memory = "/dev/shm";
    path_ =
        (fs::is_directory(memory) ? memory : fs::temp_directory_path()) / ("ivory_fuzz_" + std::to_string(::getpid()));
    fs::create_directories(path_);
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

}  // namespace

std::string file_of(const std::uint8_t* data, std::size_t size, const std::string& extension) {
  static const Folder folder;
  const std::string path = (folder.path() / ("input" + extension)).string();
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(reinterpret_cast<const char*>(data), std::streamsize(size));
  file.close();
  require(bool(file), path + " cannot be written");
  return path;
}

void require(bool right, const std::string& what) {
  if (right) return;
  std::fprintf(stderr, "wrong: %s\n", what.c_str());
  std::abort();
}

bool reads(const std::string& path, const std::function<void()>& read) {
  try {
    read();
    return true;
  } catch (const Error& error) {
    const std::string line = error.what();
    require(line.starts_with(path), "no file in '" + line + "'");
    require(line.find('\n') == std::string::npos, "more than a line: '" + line + "'");
    return false;
  }
}

bool attributes_fit(const std::uint8_t* data, std::size_t size) {
  std::size_t at = 8;  // behind magic and version
  while (at < size && data[at] != 0) {
    for (int text = 0; text < 2; ++text) {  // name and type
      while (at < size && data[at] != 0) ++at;
      ++at;
    }
    std::int32_t length = 0;
    if (at + sizeof(length) > size) return true;
    std::memcpy(&length, data + at, sizeof(length));
    at += sizeof(length);
    if (length < 0) return true;  // refused
    if (std::size_t(length) > size - at) return false;
    at += std::size_t(length);
  }
  return true;
}

bool all_finite(const std::vector<float>& values) {
  return std::all_of(values.begin(), values.end(), [](float value) { return std::isfinite(value); });
}

template <typename T>
T Bytes::raw() {
  T value{};
  const std::size_t size = std::min(sizeof(T), left_);
  std::memcpy(&value, data_, size);
  data_ += size;
  left_ -= size;
  return value;
}

std::uint8_t Bytes::byte() { return raw<std::uint8_t>(); }

std::size_t Bytes::below_or(std::size_t most) { return most == 0 ? 0 : raw<std::uint32_t>() % (most + 1); }

float Bytes::number() {
  using Limits = std::numeric_limits<float>;
  constexpr std::array<float, 12> special{0,
                                          -0.0F,
                                          1,
                                          -1,
                                          0.5F,
                                          Limits::min(),
                                          Limits::denorm_min(),
                                          Limits::max(),
                                          -Limits::max(),
                                          Limits::infinity(),
                                          -Limits::infinity(),
                                          Limits::quiet_NaN()};
  const std::size_t choice = byte();
  if (choice < special.size()) return special[choice];
  if (choice < 128) return float(raw<std::int16_t>()) / 256;
  return raw<float>();
}

double Bytes::wide_number() { return byte() % 2 == 0 ? double(number()) : raw<double>(); }

std::int64_t Bytes::integer() {
  switch (byte() % 4) {
    case 0:
      return raw<std::int64_t>();
    case 1:
      return raw<std::int32_t>();
    default:
      return std::int64_t(raw<std::uint8_t>()) - 4;
  }
}

std::string Bytes::text(std::size_t longest) {
  const std::size_t size = std::min(std::size_t(byte()) % (longest + 1), left_);
  std::string result(reinterpret_cast<const char*>(data_), size);
  data_ += size;
  left_ -= size;
  return result;
}

}  // namespace ivory::fuzz
