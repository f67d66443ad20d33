// SPDX-License-Identifier: Apache-2.0
// NRRD volumes, header and data in one file or in two (teem.sourceforge.net/nrrd/format.html). Encodings: raw
// and gzip.
#pragma once

#include <memory>
#include <string>

#include "volume/file/volume_file.h"

namespace understudy::volume {

/// By the first bytes.
bool is_nrrd(const std::string& path, const ReadableFiles& files = {});

/// Opens a scalar volume of three axes, at `time_step` along a time axis. That is a first or last axis of kind
/// time or list, a last axis without a direction in space, or the last axis if no field tells them apart. Other
/// axes of length 1 are ignored. Throws FileError.
std::unique_ptr<VolumeFile> open_nrrd(const std::string& path, int time_step = 0,
                                      const ReadableFiles& files = {});

}  // namespace understudy::volume
