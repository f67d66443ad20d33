// SPDX-License-Identifier: Apache-2.0
// Volumes that need no file: they are computed when read, so that large ones are available anywhere.
#pragma once

#include <memory>
#include <string>

#include "volume/file/volume_file.h"

namespace understudy::volume {

bool is_synthetic(const std::string& name);

/// "synthetic:XxYxZ[:TYPE[:KIND]]": TYPE is u8 (the default), u16 or f32, and KIND
///   shells   nested shells around the centre, mostly empty (the default),
///   lobes    the test signal of Marschner and Lobb (1994), alpha 0.25, frequency 6: nowhere empty,
///   gyroid   eight periods of sin x cos y + sin y cos z + sin z cos x: nowhere empty, surfaces everywhere.
/// Values are 0 to 1, scaled to the type's whole range. Throws FileError.
std::unique_ptr<VolumeFile> open_synthetic(const std::string& name);

}  // namespace understudy::volume
