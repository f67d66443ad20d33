// SPDX-License-Identifier: Apache-2.0
// What is remembered of the ray caster of one volume.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "spu/volume/proxy/ambiguous_steps.h"
#include "spu/volume/proxy/camera_followers.h"
#include "spu/volume/proxy/kept_window.h"
#include "spu/volume/proxy/march.h"
#include "spu/volume/proxy/march_inputs.h"
#include "spu/volume/proxy/table_contents.h"

namespace understudy::spu {

/// A march whose table was measured, value by value.
struct MeasuredMarch {
  March march;
  MarchInputs inputs;
  std::vector<TableContents> tables;  ///< of samples
};

struct KnownMarch {
  std::optional<March> march;
  int box_changes = 0;  ///< so often another box was drawn than the one that was taken for the whole texture
  MarchInputs inputs;   ///< what the march was found under
  /// The last few. The march is derived from the last one, by a factor of its steps, or equals it. (From march
  /// to march, opacities that long steps make nearly 1 would be lost.)
  std::vector<MeasuredMarch> measured;
  std::vector<MeasuredWay> ways;  ///< of views that left open what its steps are, under the same steps
  CameraFollowers followers;
  volume::Matrix4 camera{};          ///< of its last image, from texture to clip coordinates
  volume::Matrix4 earlier_camera{};  ///< of the one before
  /// Where its program keeps fragments, where it discards any by their place; the last one measured last.
  std::vector<KeptWindow> kept;
};

/// The input of the fragment stage that addressed the volume; empty: none is known.
inline std::string known_coordinate(const KnownMarch& known) {
  return known.march ? known.march->space.input : std::string();
}

}  // namespace understudy::spu
