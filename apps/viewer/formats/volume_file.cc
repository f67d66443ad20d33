// SPDX-License-Identifier: Apache-2.0
#include "apps/viewer/formats/volume_file.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "apps/viewer/formats/nifti.h"
#include "apps/viewer/formats/nrrd.h"
#include "apps/viewer/formats/raw.h"
#include "apps/viewer/model/error.h"

namespace viewer {

Volume load_volume(const std::string& path, const VolumeHints& hints) {
  std::error_code ignored;
  const std::filesystem::file_status status = std::filesystem::status(path, ignored);
  if (!std::filesystem::exists(status))
    throw Error(ExitCode::bad_file, fmt::format("{}: no such file; check the path", path));
  if (std::filesystem::is_directory(status))
    throw Error(ExitCode::bad_file, fmt::format("{}: is a folder; give a volume file in it", path));

  Volume volume = is_nrrd(path) ? load_nrrd(path) : is_nifti(path) ? load_nifti(path) : load_raw(path, hints);
  volume.file = path;
  if (hints.spacing) volume.spacing = *hints.spacing;
  for (double& distance : volume.spacing) {
    distance = std::abs(distance);
    if (!(distance >= min_spacing && distance <= max_spacing))
      throw Error(
          ExitCode::bad_file,
          fmt::format("{}: the spacing {} x {} x {} is not between {} and {}; give one with --spacing X Y Z",
                      path, volume.spacing[0], volume.spacing[1], volume.spacing[2], min_spacing, max_spacing));
  }
  return volume;
}

}  // namespace viewer
