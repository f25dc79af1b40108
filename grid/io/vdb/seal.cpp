#include "grid/io/vdb/seal.h"

#include <cassert>
#include <cerrno>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>
#include <vector>

#include <OpenImageIO/hash.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "grid/base/error.h"
#include "grid/io/file.h"

namespace ivory {

namespace {

// Header of file format 222 and later: magic (8 bytes), format version (4), library version (8), has grid offsets (1),
// UUID as text (36).
constexpr std::string_view magic{" BDV\0\0\0\0", 8};
constexpr std::size_t uuid_offset = 21;
constexpr std::size_t uuid_length = 36;
constexpr std::size_t header_length = uuid_offset + uuid_length;

// "ivory" in ASCII, then version 8 of RFC 9562 (custom UUIDs) and its variant bits; 60 bits remain for the checksum.
constexpr std::string_view mark = "69766f72-7900-8000-8";
constexpr std::uint64_t checksum_mask = (std::uint64_t(1) << 60U) - 1;

std::string uuid_of(std::string_view bytes) {
  // Both parts enter: the second hash is seeded by the first.
  const std::uint64_t head = OIIO::xxhash::XXH64(bytes.data(), uuid_offset, 0);
  const std::uint64_t all =
      OIIO::xxhash::XXH64(bytes.data() + header_length, bytes.size() - header_length, head) & checksum_mask;
  const std::string digits = fmt::format("{:015x}", all);
  return std::string(mark) + digits.substr(0, 3) + "-" + digits.substr(3);
}

}  // namespace

void seal_vdb(std::string& bytes) {
  assert(bytes.size() > header_length);
  bytes.replace(uuid_offset, uuid_length, uuid_of(bytes));
}

void seal_vdb_file(const std::string& file, const std::string& path) {
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CLOEXEC);
  if (descriptor < 0) throw not_written(path, errno);
  struct stat status {};
  int error = ::fstat(descriptor, &status) == 0 ? 0 : errno;
  if (error == 0) {
    const auto size = std::size_t(status.st_size);
    assert(size > header_length);
    // Not read, but mapped: it may be larger than what memory is left.
    void* const bytes = ::mmap(nullptr, size, PROT_READ, MAP_SHARED, descriptor, 0);
    if (bytes == MAP_FAILED) {
      error = errno;
    } else {
      const std::string uuid = uuid_of({static_cast<const char*>(bytes), size});
      if (::pwrite(descriptor, uuid.data(), uuid_length, uuid_offset) != ssize_t(uuid_length)) error = errno;
      ::munmap(bytes, size);
    }
  }
  ::close(descriptor);
  if (error != 0) throw not_written(path, error);
}

namespace {

struct OpenVdb {
  std::ifstream file;  // behind the header
  std::string header;
  bool sealed = false;
};

OpenVdb open_header(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) throw Error(path, "does not exist", "check the name");
  if (!fs::is_regular_file(status)) throw Error(path, "is not a file", "give a .vdb file");
  OpenVdb in{std::ifstream(path, std::ios::binary), std::string(header_length, '\0')};
  if (!in.file) throw Error(path, "cannot be opened", "check its permissions");
  if (!in.file.read(in.header.data(), std::streamsize(header_length)) || !in.header.starts_with(magic))
    throw Error(path, "is not an OpenVDB file", "give a .vdb file that ivory baked");
  in.sealed = std::string_view(in.header).substr(uuid_offset, mark.size()) == mark;
  return in;
}

}  // namespace

bool is_sealed_vdb(const std::string& path) { return open_header(path).sealed; }

void verify_vdb(const std::string& path) {
  OpenVdb in = open_header(path);
  if (!in.sealed) return;
  std::string& bytes = in.header;
  const std::uintmax_t size = std::filesystem::file_size(path);
  bytes.resize(size);
  if (!in.file.read(bytes.data() + header_length, std::streamsize(size - header_length)))
    throw Error(path, "cannot be read", "check the disk");
  if (std::string_view(bytes).substr(uuid_offset, uuid_length) != uuid_of(bytes))
    throw Error(path, "is damaged or cut short (its checksum differs)", "copy or bake it again");
}

}  // namespace ivory
