// SPDX-License-Identifier: Apache-2.0
// Decides how often a lost group of nodes is restarted, and after which pause.
#pragma once

#include <chrono>
#include <optional>

namespace understudy::launcher {

constexpr int max_restarts = 5;
constexpr std::chrono::milliseconds first_pause{200};  ///< pause before the first restart; doubles each time
/// A group that has lived this long compensates for one earlier loss.
constexpr std::chrono::seconds restart_forgiven_after{60};

class Restarts {
 public:
  /// Call when a group that has lived this long is lost. Returns the pause before the next one;
  /// nothing after too many losses.
  std::optional<std::chrono::milliseconds> after(std::chrono::steady_clock::duration lived);
  /// Number of uncompensated losses, including this one.
  int count() const { return count_; }

 private:
  int count_ = 0;
};

}  // namespace understudy::launcher
