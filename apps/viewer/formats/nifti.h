// SPDX-License-Identifier: Apache-2.0
// Reads NIfTI-1 volumes (.nii, .hdr/.img, each also .gz): the header with niftiio, the voxels directly.
#pragma once

#include <string>

#include "apps/viewer/model/volume.h"

namespace viewer {

/// Detected by name: .nii .hdr .img, each also with .gz.
bool is_nifti(const std::string& path);

/// Reads the first volume of a series and applies the stored slope and intercept. Types other than the five
/// of ScalarType become f32.
Volume load_nifti(const std::string& path);

}  // namespace viewer
