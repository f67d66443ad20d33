// SPDX-License-Identifier: Apache-2.0
// Resources that a process and those that it starts may leave behind, counted before and after.
#pragma once

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include "tests/compositor/scratch_folder.h"

namespace understudy::compositor::testing {

struct ProcessState {
  char state = 0;  ///< 'Z': it has ended and nobody has waited for it
  pid_t parent = 0;
};

/// Reads the state of the process with this folder under /proc.
inline ProcessState state_of(const std::filesystem::path& process) {
  std::ifstream stat(process / "stat");
  std::string line;
  std::getline(stat, line);
  // The name is in parentheses, and may contain parentheses.
  const std::size_t name_ends = line.rfind(')');
  if (name_ends == std::string::npos || name_ends + 4 > line.size()) return {};
  return {line[name_ends + 2], pid_t(std::atoi(line.c_str() + name_ends + 4))};
}

template <class Look>
void for_each_process(Look look) {
  std::error_code gone;
  for (const auto& entry : std::filesystem::directory_iterator("/proc", gone))
    if (std::isdigit(static_cast<unsigned char>(entry.path().filename().string()[0])) != 0) look(entry.path());
}

inline int zombies_of_this_process() {
  int zombies = 0;
  for_each_process([&](const std::filesystem::path& process) {
    const ProcessState found = state_of(process);
    zombies += found.state == 'Z' && found.parent == getpid();
  });
  return zombies;
}

/// In /dev/shm, and not mapped by any process: other programs may use some at the same time.
inline std::set<std::string> abandoned_shared_memory() {
  std::set<std::string> found;
  std::error_code gone;
  for (const auto& entry : std::filesystem::directory_iterator("/dev/shm", gone)) found.insert(entry.path());
  if (found.empty()) return found;
  for_each_process([&](const std::filesystem::path& process) {
    std::ifstream maps(process / "maps");
    for (std::string line; std::getline(maps, line);)
      if (const auto at = line.find("/dev/shm/"); at != std::string::npos) found.erase(line.substr(at));
  });
  return found;
}

class GroupResources {
 public:
  /// Returns what exists beyond what existed at construction, after waiting for what is about to go; empty if
  /// there is nothing.
  std::string more() const {
    // Other programs may make some at any time, and be about to map it.
    std::set<std::string> memory = abandoned_shared_memory();
    eventually([&] {
      const std::set<std::string> now = abandoned_shared_memory();
      std::erase_if(memory,
                    [&](const std::string& name) { return memory_.contains(name) || !now.contains(name); });
      return open_descriptors() <= descriptors_ && zombies_of_this_process() <= zombies_ && memory.empty();
    });
    std::string found;
    if (const auto now = open_descriptors(); now > descriptors_)
      found += std::to_string(now - descriptors_) + " more descriptors\n";
    if (const int now = zombies_of_this_process(); now > zombies_)
      found += std::to_string(now - zombies_) + " more zombies\n";
    for (const std::string& name : memory) found += name + "\n";
    return found;
  }

 private:
  std::ptrdiff_t descriptors_ = open_descriptors();
  int zombies_ = zombies_of_this_process();
  std::set<std::string> memory_ = abandoned_shared_memory();
};

}  // namespace understudy::compositor::testing
