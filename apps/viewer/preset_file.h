// SPDX-License-Identifier: Apache-2.0
// A transfer function of the user's own, in a file:
//   {"knots": [{"at": 0.2, "colour": [1, 0.5, 0.2], "opacity": 0}, ...]}
// with `at` a texel value in [0,1]; colours and opacities are those of presets (see transfer_function.h).
#pragma once

#include <string>
#include <vector>

#include "apps/viewer/model/transfer_function.h"

namespace viewer {

class PresetFile {
 public:
  /// Throws Error with the file, the control point, and what is wrong with it.
  explicit PresetFile(const std::string& path);
  PresetFile(const PresetFile&) = delete;
  PresetFile& operator=(const PresetFile&) = delete;
  ~PresetFile() = default;

  /// Valid as long as this object.
  const Preset& preset() const { return preset_; }

 private:
  std::string path_;
  std::vector<ControlPoint> points_;
  Preset preset_;
};

}  // namespace viewer
