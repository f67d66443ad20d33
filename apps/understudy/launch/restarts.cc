// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/launch/restarts.h"

#include <algorithm>

namespace understudy::launcher {

std::optional<std::chrono::milliseconds> Restarts::after(std::chrono::steady_clock::duration lived) {
  count_ -= int(std::min<std::int64_t>(count_, lived / restart_forgiven_after));
  if (count_ == max_restarts) return {};
  return first_pause * (1 << count_++);
}

}  // namespace understudy::launcher
