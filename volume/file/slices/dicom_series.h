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

/// Opens the volume of those DICOM `files`, all in `folder`, that belong to one series. Files without an image
/// are ignored. Slices are ordered by their positions in the patient; several images at each position are time
/// steps, in the order of their numbers. `chosen`: a file of the requested series; empty: all images must
/// belong to one. `headers`: cache of headers. Throws FileError, also if slices are missing.
std::unique_ptr<VolumeFile> open_dicom_series(const std::string& folder, std::span<const std::string> files,
                                              const std::string& chosen, int time_step,
                                              const ReadableFiles& readable, DicomHeaders& headers);

}  // namespace understudy::volume
