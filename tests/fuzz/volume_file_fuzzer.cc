// SPDX-License-Identifier: Apache-2.0
// Arbitrary volume files of every format. Each is refused, or its first or last texels are read.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "volume/file/file_error.h"
#include "volume/file/texel_stream.h"
#include "volume/file/volume_file.h"
#include "volume/opening/open_volume.h"

namespace {

using namespace understudy::volume;

/// A folder of this process's own, and nothing else is read whatever files name.
class Folder {
 public:
  Folder() : path_((std::filesystem::temp_directory_path() / "volume_file_fuzzer.XXXXXX").string()) {
    if (::mkdtemp(path_.data()) == nullptr) std::abort();
    readable_ = ReadableFiles(std::array{path_});
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::string write(const std::string& name, std::span<const std::uint8_t> bytes) const {
    const std::string path = path_ + "/" + name;
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
    return path;
  }
  const ReadableFiles& readable() const { return readable_; }

 private:
  std::string path_;
  ReadableFiles readable_;
};

/// The names are what most formats are known by. The .img of a .hdr is the same bytes.
constexpr std::array<const char*, 11> names = {"a.nrrd",
                                               "a.nhdr",
                                               "a.nii",
                                               "a.nii.gz",
                                               "a.hdr",
                                               "a.vti",
                                               "a.vti.gz",
                                               "a_3x4x5_int16be.raw",
                                               "a_3x4x5_f32.raw.gz",
                                               "a.uvol",
                                               "a.mha"};

void read(const std::string& path, const ReadableFiles& files, bool at_end) {
  std::unique_ptr<VolumeFile> file = open_volume(path, {}, files);
  if (at_end && file->description().time_steps > 1) {
    FileHints hints;
    hints.time_step = file->description().time_steps - 1;
    file = open_volume(path, hints, files);
  }
  const std::array<int, 3> size = file->description().size;
  TexelBox box{{0, 0, 0}, size};
  // Some thousand texels are enough.
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int some = std::min(size[axis], 16);
    if (at_end)
      box.low[axis] = size[axis] - some;
    else
      box.high[axis] = some;
  }
  const TexelChoice choice = at_end ? TexelChoice{TexelType::u16, {{-1000, 3000}}} : TexelChoice{};
  TexelStream texels(std::move(file), choice, box);
  while (!texels.done()) texels.next(std::size_t(1) << 16);
}

}  // namespace

/// The first byte says which format, and which end is read.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Folder folder;
  if (size == 0) return 0;
  const std::span bytes = std::span(data, size).subspan(1);
  const std::string name = names[data[0] / 2 % names.size()];
  const std::string path = folder.write(name, bytes);
  if (name == "a.hdr") folder.write("a.img", bytes);
  try {
    read(path, folder.readable(), data[0] % 2 == 1);
  } catch (const FileError&) {
    // Not a volume.
  }
  return 0;
}
