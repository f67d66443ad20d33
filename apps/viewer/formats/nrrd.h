// SPDX-License-Identifier: Apache-2.0
// Reads NRRD volumes with teem (attached or detached header, raw, ascii or gzip encoding).
#pragma once

#include <string>

#include "apps/viewer/model/volume.h"

namespace viewer {

/// Detected by the magic number at the start of the file.
bool is_nrrd(const std::string& path);

/// Reads a scalar volume with three axes (axes of length 1 do not count). 32-bit integers
/// and 64-bit types become f32.
Volume load_nrrd(const std::string& path);

}  // namespace viewer
