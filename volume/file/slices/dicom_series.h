// SPDX-License-Identifier: Apache-2.0
// A DICOM series: the files of one scan, most often one slice each.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "volume/file/readable_files.h"
#include "volume/file/slices/dicom_headers.h"
#include "volume/file/volume_file.h"

namespace understudy::volume {

/// The volume of those DICOM `files` that belong to one series, all of them in `folder`. What holds no image is
/// passed over. Slices lie in the order of their positions in the patient; where several lie at each position
/// they are time steps, in the order of their numbers. `chosen`: a file of the series that is meant; empty: all
/// images must belong to one. `headers`: those that are known. Throws FileError, also where slices are missing.
std::unique_ptr<VolumeFile> open_dicom_series(const std::string& folder, std::span<const std::string> files,
                                              const std::string& chosen, int time_step,
                                              const ReadableFiles& readable, DicomHeaders& headers);

}  // namespace understudy::volume
