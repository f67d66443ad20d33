// SPDX-License-Identifier: Apache-2.0
// NIfTI-1 volumes (.nii, .hdr/.img, each also .gz); the header is read by niftiio, the voxels by us.
#pragma once

#include <string>

#include "apps/viewer/model/volume.h"

namespace viewer {

/// By the name: .nii .hdr .img, each also with .gz.
bool is_nifti(const std::string& path);

/// The first volume of a series. Stored slope and intercept are applied; types other than the five drawn become
/// f32.
Volume load_nifti(const std::string& path);

}  // namespace viewer
