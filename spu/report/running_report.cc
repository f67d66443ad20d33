// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <memory>
#include <new>

#include "spu/report/report.h"

namespace understudy::spu {
namespace {

/// Bytes are atomic on every system: another thread may write them. Whoever uses the copy checks what it reads,
/// as it does with the files of other processes.
__attribute__((no_sanitize("thread"))) void copy_while_it_changes(const volatile std::byte* from, std::byte* to,
                                                                  std::size_t bytes) {
  for (std::size_t i = 0; i < bytes; ++i) to[i] = from[i];
}

}  // namespace

std::string running_report_json(std::size_t most_frames) {
  const auto copy = std::make_unique_for_overwrite<std::byte[]>(sizeof(ProcessCounters));
  copy_while_it_changes(reinterpret_cast<const volatile std::byte*>(&process_counters()), copy.get(),
                        sizeof(ProcessCounters));
  const auto* const counters = std::launder(reinterpret_cast<const ProcessCounters*>(copy.get()));
  return report_json(Processes(&counters, 1), most_frames);
}

}  // namespace understudy::spu
