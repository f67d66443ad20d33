// SPDX-License-Identifier: Apache-2.0
// Volumes that need no file: computed where and when they are read, so that large ones can be had anywhere.
#pragma once

#include <memory>
#include <string>

#include "volume/file/volume_file.h"

namespace understudy::volume {

bool is_synthetic(const std::string& name);

/// "synthetic:XxYxZ[:TYPE[:KIND]]": TYPE is u8 (the default), u16 or f32, and KIND
///   shells   nested shells around the middle, the largest part of it empty (the default),
///   lobes    the test signal of Marschner and Lobb (1994), alpha 0.25, frequency 6: nowhere empty,
///   gyroid   eight periods of sin x cos y + sin y cos z + sin z cos x: nowhere empty, surfaces everywhere.
/// Values are 0 to 1 over the type's whole range. Throws FileError.
std::unique_ptr<VolumeFile> open_synthetic(const std::string& name);

}  // namespace understudy::volume
