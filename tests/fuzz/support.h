// What the fuzzers share. A reader answers hostile bytes with its result or with an Error of one line that names the
// file; anything else falls: another exception, a report of a sanitizer, a value that its header rules out.
//
// The readers meet a machine of machine_bytes, so that check_memory() refuses the same claims everywhere.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace ivory::fuzz {

inline constexpr std::size_t machine_bytes = std::size_t(32) << 20U;

// Writes the bytes to the one file of this process with that extension (".gltf"), in memory where the system has
// /dev/shm, alone in its folder; its path.
std::string file_of(const std::uint8_t* data, std::size_t size, const std::string& extension);

// Says `what` on stderr and aborts, unless `right`.
void require(bool right, const std::string& what);

// Runs read(); an Error must be one line that begins with `path`. False where there was one.
bool reads(const std::string& path, const std::function<void()>& read);

// False for an OpenEXR file with an attribute that claims more bytes than the file has. OpenEXR asks for that memory
// and then finds that there is nothing to fill it with; AddressSanitizer takes a second over it, the system none.
bool attributes_fit(const std::uint8_t* data, std::size_t size);

bool all_finite(const std::vector<float>& values);

// Takes values off the input, from its front; zeros when it is used up.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), left_(size) {}
  bool empty() const { return left_ == 0; }
  std::uint8_t byte();
  // From 0 to `most`.
  std::size_t below_or(std::size_t most);
  // Any bit pattern, or one of the values that programs trip over.
  float number();
  double wide_number();
  std::int64_t integer();
  // Up to `longest` bytes.
  std::string text(std::size_t longest);

 private:
  template <typename T>
  T raw();
  const std::uint8_t* data_;
  std::size_t left_;
};

}  // namespace ivory::fuzz
