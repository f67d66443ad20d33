// SPDX-License-Identifier: Apache-2.0
// Reads the counters that the processes of a run left in the launcher's folder.
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include "spu/report/report.h"

namespace understudy::spu {

void UnmapCounters::operator()(const ProcessCounters* counters) const {
  munmap(const_cast<ProcessCounters*>(counters), sizeof(ProcessCounters));
}

std::vector<MappedCounters> read_counters(const std::filesystem::path& folder) {
  std::vector<MappedCounters> found;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (entry.path().extension() != ".counters" || found.size() >= max_counted_processes) continue;
    const int file = open(entry.path().c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
    if (file < 0) continue;
    struct stat status {};
    void* mapped = MAP_FAILED;
    if (fstat(file, &status) == 0 && S_ISREG(status.st_mode) &&
        status.st_size >= static_cast<off_t>(sizeof(ProcessCounters))) {
      mapped = mmap(nullptr, sizeof(ProcessCounters), PROT_READ, MAP_SHARED, file, 0);
    }
    close(file);
    if (mapped == MAP_FAILED) continue;
    MappedCounters counters(static_cast<const ProcessCounters*>(mapped));
    if (counters->magic == counters_magic) found.push_back(std::move(counters));
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a->pid < b->pid; });
  return found;
}

std::size_t processes_without_figures(const std::filesystem::path& folder) {
  std::size_t count = 0;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    count +=
        entry.path().extension() == ".counters" && entry.is_regular_file(error) && entry.file_size(error) == 0;
  return count;
}

}  // namespace understudy::spu
