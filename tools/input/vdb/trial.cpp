#include "tools/input/vdb/trial.h"

#include <array>
#include <cerrno>
#include <exception>
#include <fstream>
#include <new>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace ivory {

namespace {

constexpr int exit_threw = 3;
constexpr int exit_crashed = 4;

// Address space in use; 0 where the system does not tell.
std::uint64_t used_address_space_bytes() {
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * std::uint64_t(::sysconf(_SC_PAGESIZE));
}

bool write_all(int descriptor, const std::string& text) {
  for (std::size_t at = 0; at < text.size();) {
    const ssize_t count = ::write(descriptor, text.data() + at, text.size() - at);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    at += std::size_t(count);
  }
  return true;
}

// The child: answers through `descriptor` and its exit code. Its crash is an answer, not news: no core
// file, nothing on the terminal.
[[noreturn]] void run_child(int descriptor, std::uint64_t memory_bytes, const std::function<std::string()>& action) {
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  if (const std::uint64_t used = used_address_space_bytes(); used != 0) {
    const rlimit memory{used + memory_bytes, used + memory_bytes};
    ::setrlimit(RLIMIT_AS, &memory);
  }
  const int null = ::open("/dev/null", O_WRONLY);
  ::dup2(null, STDOUT_FILENO);
  ::dup2(null, STDERR_FILENO);
  ::alarm(600);
  int code = exit_crashed;
  try {
    code = write_all(descriptor, action()) ? 0 : exit_crashed;
  } catch (const std::bad_alloc&) {
    code = exit_crashed;
  } catch (const std::exception& error) {
    code = write_all(descriptor, error.what()) ? exit_threw : exit_crashed;
  }
  ::_exit(code);
}

}  // namespace

TrialOutcome run_trial(std::uint64_t memory_bytes, const std::function<std::string()>& action) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return {TrialOutcome::Kind::not_started, {}};
  const pid_t child = ::fork();
  if (child == 0) {
    ::close(ends[0]);
    run_child(ends[1], memory_bytes, action);
  }
  ::close(ends[1]);
  TrialOutcome outcome;
  std::array<char, 65536> buffer{};
  for (;;) {
    const ssize_t count = ::read(ends[0], buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    outcome.text.append(buffer.data(), std::size_t(count));
  }
  ::close(ends[0]);
  if (child < 0) return {TrialOutcome::Kind::not_started, {}};
  int status = 0;
  while (::waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) return outcome;
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) outcome.kind = TrialOutcome::Kind::returned;
  if (WIFEXITED(status) && WEXITSTATUS(status) == exit_threw) outcome.kind = TrialOutcome::Kind::threw;
  return outcome;
}

MemoryFile::MemoryFile(const std::string& bytes) : descriptor_(::memfd_create("ivory", MFD_CLOEXEC)) {
  if (descriptor_ >= 0 && write_all(descriptor_, bytes)) return;
  if (descriptor_ >= 0) ::close(descriptor_);
  throw std::bad_alloc();
}

MemoryFile::~MemoryFile() { ::close(descriptor_); }

std::string MemoryFile::path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

}  // namespace ivory
