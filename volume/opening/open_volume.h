// SPDX-License-Identifier: Apache-2.0
// Opens a volume by its name, in any supported format.
//
// NRRD, UVOL, TIFF and DICOM are recognised by their first bytes, MetaImage, NIfTI and VTI by their names (.mha
// .mhd, and .nii .hdr .img .vti, each of these also with .gz), folders by their contents (Zarr, or slices in
// DICOM or TIFF files). A name that begins with "synthetic:" needs no file. All other files are raw scalars,
// whose size and type come from the caller or from the name (engine.256x256x110,
// head_256x256x113_int16be.raw.gz).
#pragma once

#include <memory>
#include <string>

#include "volume/file/readable_files.h"
#include "volume/file/volume_file.h"

namespace understudy::volume {

class DicomHeaders;

/// Reads only the header, and only from `files`, including a second file that the first one refers to. Throws
/// FileError.
std::unique_ptr<VolumeFile> open_volume(const std::string& name, const FileHints& hints = {},
                                        const ReadableFiles& files = {});

/// The same for opening several time steps: a folder of thousands of DICOM files is parsed only for the first
/// of them, and `headers` keeps the result.
std::unique_ptr<VolumeFile> open_volume(const std::string& name, const FileHints& hints,
                                        const ReadableFiles& files, DicomHeaders& headers);

}  // namespace understudy::volume
