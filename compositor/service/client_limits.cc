// SPDX-License-Identifier: Apache-2.0
#include "compositor/service/client_limits.h"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace understudy::compositor {

namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t no_limit = ~std::uint64_t(0);

/// Returns the limit in such a file; groups without a limit have "max", or a number above all memory.
std::uint64_t limit_in(const fs::path& file) {
  std::uint64_t bytes = 0;
  return std::ifstream(file) >> bytes ? bytes : no_limit;
}

/// Returns the lowest limit of the group and its ancestors.
std::uint64_t limit_of(const fs::path& root, fs::path group, const char* file) {
  std::uint64_t least = limit_in(root / file);
  for (group = group.relative_path(); !group.empty(); group = group.parent_path())
    least = std::min(least, limit_in(root / group / file));
  return least;
}

/// Lines of /proc/self/cgroup look like "0::/user.slice" (version 2) and "9:memory:/user.slice" (version 1).
std::uint64_t control_group_limit() {
  const fs::path root = "/sys/fs/cgroup";
  std::uint64_t least = no_limit;
  std::ifstream groups("/proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {
    const std::string group = line.substr(std::min(line.size(), line.find(":/") + 1));
    if (line.starts_with("0::")) least = std::min(least, limit_of(root, group, "memory.max"));
    if (line.find(":memory:") != std::string::npos)
      least = std::min(least, limit_of(root / "memory", group, "memory.limit_in_bytes"));
  }
  return least;
}

}  // namespace

std::uint64_t usable_memory() {
  // Only once: later this process may not be allowed to open files.
  static const std::uint64_t found = [] {
    const auto physical = std::uint64_t(::sysconf(_SC_PHYS_PAGES)) * std::uint64_t(::sysconf(_SC_PAGESIZE));
    return std::min(physical, control_group_limit());
  }();
  return found;
}

std::uint64_t available_memory() {
  std::ifstream file("/proc/meminfo");
  for (std::string line; std::getline(file, line);) {
    constexpr std::string_view name = "MemAvailable:";
    if (line.starts_with(name)) return std::strtoull(line.c_str() + name.size(), nullptr, 10) << 10;
  }
  return 0;
}

ClientLimits client_limits(int ranks, std::chrono::milliseconds image_time) {
  const std::uint64_t texels = usable_memory() / 3 * 2 / std::uint64_t(std::max(1, ranks));
  return {texels, image_time.count() > 0 ? texels / 2 : texels, image_time};
}

}  // namespace understudy::compositor
