// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/observation/stack_watch.h"

#include <utility>

#include "spu/volume/refusal/refusal.h"

namespace understudy::spu {
namespace {

/// A viewer shows its stack within this many frames, or creates another.
constexpr int most_frames_without_stack = 600;

}  // namespace

bool StackWatch::begin() {
  possible_ = true;
  frames_without_ = 0;
  return !std::exchange(watched_, true);
}

void StackWatch::looked_at(bool volume) {
  if (volume) {
    others_ = 0;
  } else if (++others_ >= patient_refusals) {
    possible_ = false;
  }
}

bool StackWatch::frame_without_volume() {
  if (!watched_ || (possible_ && ++frames_without_ < most_frames_without_stack)) return false;
  // The next textures of one size begin a new row; one check of what they draw is enough then.
  detection = {};
  others_ = patient_refusals - 1;
  return true;
}

bool StackWatch::end() {
  possible_ = false;
  return std::exchange(watched_, false);
}

}  // namespace understudy::spu
