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

/// A scalar volume of three axes, at `time_step` along a first or last axis of time: its kind is time or list,
/// or it is the last, and nothing says of any axis what it is. Other axes do not count where their length is 1.
/// Throws FileError.
std::unique_ptr<VolumeFile> open_nrrd(const std::string& path, int time_step = 0,
                                      const ReadableFiles& files = {});

}  // namespace understudy::volume
