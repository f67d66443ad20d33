// SPDX-License-Identifier: Apache-2.0
// A refusal: the reason why the application draws a run itself.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <utility>

namespace understudy::spu {

/// The only way in which stages report that a run is not substituted. Thrown if the stage cannot continue,
/// returned if the caller decides; printed in the summary, in the report and, with all its parts, by --explain.
struct Refusal {
  Refusal(std::string what, std::string seen = {}, std::string to_do = {})
      : reason(std::move(what)), evidence(std::move(seen)), advice(std::move(to_do)) {}
  Refusal(const char* what) : reason(what) {}

  std::string reason;    ///< what prevents substitution, in words that do not change from frame to frame
  std::string evidence;  ///< what was measured, and what would have passed; empty: the reason is sufficient
  std::string advice;    ///< what the user can do about it; empty: nothing
};

/// Thrown if nothing of a run is visible: the application may draw it at no cost.
struct NothingVisible {};

/// What is remembered of the refusals of one volume.
struct RefusalHistory {
  std::string handed_back;           ///< why the volume is never substituted again; empty: it may be
  std::string last_reason;           ///< the last reason
  int in_a_row = 0;                  ///< refusals since it was last substituted
  bool explained_otherwise = false;  ///< the last comparison failed, and another explanation is to be tried
  std::uint64_t left_in_frame = ~std::uint64_t(0);
  std::uint64_t next_try = 0;  ///< frame from which it is tried again, after a failed comparison
  /// The same as a time. A context whose images are shown by other contexts, such as that of a Qt widget, may
  /// draw for long without a frame end.
  std::chrono::steady_clock::time_point next_try_by{};

  /// Waits for `frames` after `frame`, or for as many tenths of a second, whichever ends first.
  void pause(std::uint64_t frame, std::uint64_t frames) {
    next_try = frame + frames;
    next_try_by = std::chrono::steady_clock::now() + frames * std::chrono::milliseconds(100);
  }
  bool pauses(std::uint64_t frame) const {
    return frame < next_try && std::chrono::steady_clock::now() < next_try_by;
  }
};

/// After patient_refusals in a row, a volume whose recognition is costly is tried only in one of
/// refused_retry_frames.
constexpr int patient_refusals = 8;
constexpr std::uint64_t refused_retry_frames = 64;

}  // namespace understudy::spu
