// SPDX-License-Identifier: Apache-2.0
// A refusal: the application draws a run itself, and here is why.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <utility>

namespace understudy::spu {

/// The one way in which any stage says that a run is not substituted. Thrown where there is no way on,
/// returned where the caller decides; it ends in the summary, in the report and, with all its parts, in
/// --explain.
struct Refusal {
  Refusal(std::string what, std::string seen = {}, std::string to_do = {})
      : reason(std::move(what)), evidence(std::move(seen)), advice(std::move(to_do)) {}
  Refusal(const char* what) : reason(what) {}

  std::string reason;    ///< what is in the way, in words that do not change from frame to frame
  std::string evidence;  ///< what was measured, and what would have passed; empty: the reason says it all
  std::string advice;    ///< what the user can do about it; empty: nothing
};

/// Thrown where nothing of a run is visible: the application may draw it, it costs nothing and means nothing.
struct NothingVisible {};

/// What is remembered of the refusals of one volume.
struct RefusalHistory {
  std::string handed_back;           ///< why the volume is not substituted for good; empty: it is not
  std::string last_reason;           ///< the last that was said
  int in_a_row = 0;                  ///< since it was last substituted
  bool explained_otherwise = false;  ///< the last comparison was lost, and there is another explanation to try
  std::uint64_t left_in_frame = ~std::uint64_t(0);
  std::uint64_t next_try = 0;  ///< the frame from which on it is tried again, after a lost comparison
  /// The same by the clock. A context whose images other contexts show, as a widget of Qt's, may draw for long
  /// while no frame ends.
  std::chrono::steady_clock::time_point next_try_by{};

  /// Waits for `frames` after `frame`, or for as many tenths of a second.
  void pause(std::uint64_t frame, std::uint64_t frames) {
    next_try = frame + frames;
    next_try_by = std::chrono::steady_clock::now() + frames * std::chrono::milliseconds(100);
  }
  bool pauses(std::uint64_t frame) const {
    return frame < next_try && std::chrono::steady_clock::now() < next_try_by;
  }
};

/// After this many refusals in a row a volume that is costly to look at is looked at only in one frame of so
/// many.
constexpr int patient_refusals = 8;
constexpr std::uint64_t refused_retry_frames = 64;

}  // namespace understudy::spu
