#include "grid/io/vdb/file_stream.h"

#include <cerrno>
#include <streambuf>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

#include "grid/io/file.h"

namespace ivory {

class FileStream::Buffer : public std::streambuf {
 public:
  explicit Buffer(const std::string& name) : file_(::open(name.c_str(), O_WRONLY | O_CLOEXEC)) {
    if (file_ < 0) error_ = errno;
    setp(bytes_.data(), bytes_.data() + bytes_.size());
  }
  ~Buffer() override {
    if (file_ >= 0) ::close(file_);
  }
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;

  int error() const { return error_; }

  // Empties the buffer into the file.
  bool write_out() {
    const char* at = pbase();
    while (error_ == 0 && at != pptr()) {
      const ssize_t count = ::write(file_, at, std::size_t(pptr() - at));
      if (count >= 0) {
        at += count;
        position_ += count;
      } else if (errno != EINTR) {
        error_ = errno;
      }
    }
    setp(bytes_.data(), bytes_.data() + bytes_.size());
    return error_ == 0;
  }

 protected:
  int_type overflow(int_type c) override {
    if (!write_out()) return traits_type::eof();
    if (traits_type::eq_int_type(c, traits_type::eof())) return traits_type::not_eof(c);
    *pptr() = traits_type::to_char_type(c);
    pbump(1);
    return c;
  }
  int sync() override { return write_out() ? 0 : -1; }
  pos_type seekoff(off_type offset, std::ios_base::seekdir from, std::ios_base::openmode /*which*/) override {
    // What streams ask by tellp().
    if (from == std::ios_base::cur && offset == 0) return position_ + (pptr() - pbase());
    if (!write_out()) return {off_type(-1)};
    const int whence = from == std::ios_base::beg ? SEEK_SET : from == std::ios_base::cur ? SEEK_CUR : SEEK_END;
    const off_t position = ::lseek(file_, offset, whence);
    if (position < 0) {
      error_ = errno;
      return {off_type(-1)};
    }
    position_ = position;
    return position_;
  }
  pos_type seekpos(pos_type position, std::ios_base::openmode which) override {
    return seekoff(off_type(position), std::ios_base::beg, which);
  }

 private:
  int file_;
  int error_ = 0;
  off_type position_ = 0;  // of the file, where the buffer's first byte goes
  std::vector<char> bytes_ = std::vector<char>(1 << 18);
};

FileStream::FileStream(const PendingFile& file, const std::string& path)
    : std::ostream(nullptr), buffer_(std::make_unique<Buffer>(file.temporary())), path_(path) {
  if (buffer_->error() != 0) throw not_written(path_, buffer_->error());
  rdbuf(buffer_.get());
}

FileStream::~FileStream() = default;

void FileStream::flush_all() {
  if (!buffer_->write_out()) throw not_written(path_, buffer_->error());
  if (!good()) throw not_written(path_, EIO);
}

}  // namespace ivory
