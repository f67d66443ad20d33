// SPDX-License-Identifier: Apache-2.0
// How often a lost group of nodes is started again, and after which pause.
#pragma once

#include <chrono>
#include <optional>

namespace understudy::launcher {

constexpr int max_restarts = 5;
constexpr std::chrono::milliseconds first_pause{200};  ///< before a restart; doubles each time
/// A group that has lived so long makes up for one that was lost before.
constexpr std::chrono::seconds restart_forgiven_after{60};

class Restarts {
 public:
  /// A group that lived so long is lost: the pause before the next one; nothing when there were too many.
  std::optional<std::chrono::milliseconds> after(std::chrono::steady_clock::duration lived);
  /// Those that are not forgiven, this one too.
  int count() const { return count_; }

 private:
  int count_ = 0;
};

}  // namespace understudy::launcher
