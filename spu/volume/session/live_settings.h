// SPDX-License-Identifier: Apache-2.0
// The options that may change while the program runs (`understudy ctl`). Another thread says what is wanted; it
// takes effect at the end of a frame (RenderSession::take_wanted_settings).
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>

#include "spu/options.h"

namespace understudy::spu {

struct LiveSettings {
  bool substitutes = true;  ///< false: the application draws all volumes itself
  bool tint = false;        ///< --debug-tint
  double error = 0;         ///< --error
  double time_ms = 0;       ///< --time

  LiveSettings() = default;
  explicit LiveSettings(const Options& options)
      : tint(options.debug_tint), error(options.error), time_ms(options.time_ms) {}

  bool has_budget() const { return error > 0 || time_ms > 0; }
};

/// Thread-safe.
class WantedSettings {
 public:
  explicit WantedSettings(const LiveSettings& initial) : settings_(initial) {}

  /// Changes whenever the settings do. The only cost of a frame in which they did not.
  std::uint64_t version() const { return version_.load(std::memory_order_relaxed); }
  LiveSettings get() const {
    const std::scoped_lock lock(mutex_);
    return settings_;
  }
  template <class Change>
  void change(Change change) {
    const std::scoped_lock lock(mutex_);
    change(settings_);
    version_.fetch_add(1, std::memory_order_relaxed);
  }

 private:
  mutable std::mutex mutex_;
  LiveSettings settings_;
  std::atomic<std::uint64_t> version_ = 0;
};

}  // namespace understudy::spu
