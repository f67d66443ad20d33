// SPDX-License-Identifier: Apache-2.0
// Opens a volume by its name, whatever its format.
//
// NRRD, UVOL, TIFF and DICOM are known by their first bytes, MetaImage, NIfTI and VTI by their names (.mha
// .mhd, and .nii .hdr .img .vti, each of these also with .gz), folders by what is in them (Zarr, or slices in
// DICOM or TIFF files), and a name that begins with "synthetic:" needs no file. All other files are raw
// scalars, whose size and type come from the caller or from the name (engine.256x256x110,
// head_256x256x113_int16be.raw.gz).
#pragma once

#include <memory>
#include <string>

#include "volume/file/readable_files.h"
#include "volume/file/volume_file.h"

namespace understudy::volume {

class DicomHeaders;

/// Reads no more than the header, from `files` alone: also a second file that the first one names. Throws
/// FileError.
std::unique_ptr<VolumeFile> open_volume(const std::string& name, const FileHints& hints = {},
                                        const ReadableFiles& files = {});

/// The same for one who opens several time steps: a folder of thousands of DICOM files is parsed for the first
/// of them, and `headers` knows it then.
std::unique_ptr<VolumeFile> open_volume(const std::string& name, const FileHints& hints,
                                        const ReadableFiles& files, DicomHeaders& headers);

}  // namespace understudy::volume
