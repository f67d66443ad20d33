// SPDX-License-Identifier: Apache-2.0
// NRRD volumes (attached or detached header, raw, ascii or gzip encoding), read by teem.
#pragma once

#include <string>

#include "apps/viewer/model/volume.h"

namespace viewer {

/// By the magic at the start of the file.
bool is_nrrd(const std::string& path);

/// A scalar volume of three axes (axes of length 1 do not count). 32- and 64-bit types become f32.
Volume load_nrrd(const std::string& path);

}  // namespace viewer
