#include "grid/base/memory.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <sstream>
#include <thread>
#include <vector>

#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

#include "grid/base/error.h"

namespace ivory {

namespace fs = std::filesystem;

namespace {

constexpr double unlimited = std::numeric_limits<double>::infinity();
constexpr double usable_share = 0.75;

// The `field`th number of a one-line file; infinite for a word ("max"), a negative number and where there is none.
double number_in(const fs::path& path, int field = 0) {
  std::ifstream file(path);
  std::string word;
  for (int i = 0; i <= field; ++i) file >> word;
  std::istringstream text(word);
  double value = 0;
  return file && text >> value && value >= 0 ? value : unlimited;
}

// A share of time needs both its numbers.
double share(double quota_us, double period_us) {
  return std::isfinite(quota_us) && std::isfinite(period_us) && period_us > 0 ? quota_us / period_us : unlimited;
}

// The least of limit(folder) over the group's folder and those above it. A group whose folder is not there, as seen
// from inside a container that has a tree of its own, leaves those above.
double least_above(const fs::path& mount, const std::string& group,
                   const std::function<double(const fs::path&)>& limit) {
  double least = limit(mount);
  fs::path folder = mount;
  for (const fs::path& part : fs::path(group).relative_path()) {
    folder /= part;
    least = std::min(least, limit(folder));
  }
  return least;
}

bool lists(const std::string& controllers, const std::string& name) {
  std::istringstream names(controllers);
  for (std::string found; std::getline(names, found, ',');)
    if (found == name) return true;
  return false;
}

}  // namespace

ControlGroupLimits control_group_limits(const std::string& root) {
  ControlGroupLimits limits{unlimited, unlimited};
  const fs::path mount = root + "/sys/fs/cgroup";
  std::ifstream groups(root + "/proc/self/cgroup");
  // "hierarchy:controllers:group"; version 2's line has no controllers.
  for (std::string line; std::getline(groups, line);) {
    const std::size_t first = line.find(':');
    const std::size_t second = first == std::string::npos ? first : line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1);
    const std::string group = line.substr(second + 1);
    if (controllers.empty()) {
      limits.memory_bytes =
          std::min(limits.memory_bytes,
                   least_above(mount, group, [](const fs::path& f) { return number_in(f / "memory.max"); }));
      limits.processors = std::min(limits.processors, least_above(mount, group, [](const fs::path& f) {
                                     return share(number_in(f / "cpu.max"), number_in(f / "cpu.max", 1));
                                   }));
    }
    if (lists(controllers, "memory"))
      limits.memory_bytes = std::min(limits.memory_bytes, least_above(mount / "memory", group, [](const fs::path& f) {
                                       return number_in(f / "memory.limit_in_bytes");
                                     }));
    if (lists(controllers, "cpu"))
      limits.processors =
          std::min(limits.processors, least_above(mount / "cpu", group, [](const fs::path& f) {
                     return share(number_in(f / "cpu.cfs_quota_us"), number_in(f / "cpu.cfs_period_us"));
                   }));
  }
  return limits;
}

double available_memory_bytes() {
  double bytes = double(::sysconf(_SC_PHYS_PAGES)) * double(::sysconf(_SC_PAGESIZE));
  bytes = std::min(bytes, control_group_limits().memory_bytes);
  rlimit space{};
  if (::getrlimit(RLIMIT_AS, &space) == 0 && space.rlim_cur != RLIM_INFINITY)
    bytes = std::min(bytes, double(space.rlim_cur));
  return bytes;
}

int available_processors() {
  double processors = std::max(1U, std::thread::hardware_concurrency());
  cpu_set_t allowed;  // of 1024 processors; a machine with more refuses the call
  if (::sched_getaffinity(0, sizeof(allowed), &allowed) == 0) processors = CPU_COUNT(&allowed);
  processors = std::min(processors, std::ceil(control_group_limits().processors));
  return std::max(1, int(processors));
}

void check_memory(const std::string& file, double bytes, const std::string& remedy) {
  const double usable = usable_share * available_memory_bytes();
  if (bytes <= usable) return;
  char cause[100];
  std::snprintf(cause, sizeof(cause), "needs %.3g GiB of memory, and %.3g GiB may be used", bytes / 0x1p30,
                usable / 0x1p30);
  throw Error(file, cause, remedy);
}

}  // namespace ivory
