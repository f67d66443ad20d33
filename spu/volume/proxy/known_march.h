// SPDX-License-Identifier: Apache-2.0
// What is stored about the ray caster of one volume.
#pragma once

#include <cstdint>
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

/// A march whose table was measured value by value.
struct MeasuredMarch {
  March march;
  MarchInputs inputs;
  std::vector<TableContents> tables;  ///< those that samples look up
};

struct KnownMarch {
  std::optional<March> march;
  int box_changes = 0;  ///< how often the box that was drawn differed from the one taken for the whole texture
  MarchInputs inputs;   ///< of the last image that used the march
  /// The last few. The march equals the last one, or is derived from it by a factor of its steps. (If it were
  /// derived from march to march, opacities that long steps make nearly 1 would be lost.)
  std::vector<MeasuredMarch> measured;
  std::uint64_t derived = 0;      ///< how often the march was derived so
  std::vector<MeasuredWay> ways;  ///< of views that left its steps open, under the same steps
  CameraFollowers followers;
  volume::Matrix4 camera{};          ///< of its last image, from texture to clip coordinates
  volume::Matrix4 earlier_camera{};  ///< of the image before that
  /// Where its program keeps fragments, if it discards any by position; the one measured last is at the end.
  std::vector<KeptWindow> kept;
};

/// The input of the fragment stage that addressed the volume; empty if none is known.
inline std::string known_coordinate(const KnownMarch& known) {
  return known.march ? known.march->space.input : std::string();
}

}  // namespace understudy::spu
