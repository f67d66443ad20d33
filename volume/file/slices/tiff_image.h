// SPDX-License-Identifier: Apache-2.0
// One TIFF file of scalars, whose pages are slices. libtiff decodes strips and tiles, classic and BigTIFF, with
// all its compression schemes. TIFF 6.0; ImageJ's and OME's descriptions of stacks
// (docs.openmicroscopy.org/ome-model).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "volume/file/readable_files.h"
#include "volume/file/scalar_type.h"
#include "volume/texture_space.h"

namespace understudy::volume {

struct TiffHeader {
  std::string path;
  std::array<int, 2> size{};
  ScalarType type = ScalarType::u8;
  int slices = 1;
  int time_steps = 1;
  int channels = 1;
  Vec3 spacing{1, 1, 1};        ///< as specified by ImageJ or OME
  std::size_t piece_bytes = 0;  ///< of the largest strip or tile, decoded
};

/// By the first bytes. Throws FileError if the file cannot be read.
bool is_tiff(const std::string& path, const ReadableFiles& files);

class TiffFile {
 public:
  /// Reads the header. Throws FileError for damaged files, and for images that are not scalar.
  TiffFile(const std::string& path, const ReadableFiles& files);
  ~TiffFile();

  const TiffHeader& header() const;
  /// Fills `scalars` with one slice, tightly packed, in native byte order. Throws FileError.
  void read(int slice, int time_step, int channel, std::span<std::byte> scalars);
  std::uint64_t bytes_read() const;

 private:
  class Pages;
  std::unique_ptr<Pages> pages_;
};

}  // namespace understudy::volume
