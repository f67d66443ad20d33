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

/// A folder of this process; nothing outside it is read, whatever paths the files contain.
class Folder {
 public:
  Folder() : path_((std::filesystem::temp_directory_path() / "volume_file_fuzzer.XXXXXX").string()) {
    if (::mkdtemp(path_.data()) == nullptr) std::abort();
    readable_ = ReadableFiles(std::array{path_});
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  /// `name` may contain a subfolder.
  std::string write(const std::string& name, std::span<const std::uint8_t> bytes) const {
    const std::filesystem::path path = std::filesystem::path(path_) / name;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
    return path;
  }
  const std::string& path() const { return path_; }
  const ReadableFiles& readable() const { return readable_; }

 private:
  std::string path_;
  ReadableFiles readable_;
};

/// Most formats are identified by these names. The .img of a .hdr has the same bytes. A DICOM file has a
/// separate folder, because neighbouring files may belong to its series.
constexpr std::array<const char*, 13> names = {"a.nrrd",
                                               "a.nhdr",
                                               "a.nii",
                                               "a.nii.gz",
                                               "a.hdr",
                                               "a.vti",
                                               "a.vti.gz",
                                               "a_3x4x5_int16be.raw",
                                               "a_3x4x5_f32.raw.gz",
                                               "a.uvol",
                                               "a.mha",
                                               "dicom/a.dcm",
                                               "a.tif"};

/// A volume that is a folder: its name and its files.
struct ChunkedNames {
  const char* folder;
  std::vector<const char*> files;
};
const std::array<ChunkedNames, 3> chunked = {{{"zarr_2", {".zarray", "0.0.0"}},
                                              {"zarr_3", {"zarr.json", "c/0/0/0"}},
                                              {"image", {"zarr.json", "0/zarr.json", "0/c/0/0/0/0"}}}};

/// The bytes up to the first 0 are those of the first file, and so on; the remaining bytes are those of the
/// last file, a chunk.
std::string write_chunked(const Folder& folder, const ChunkedNames& names,
                          std::span<const std::uint8_t> bytes) {
  for (const char* const file : names.files) {
    const bool is_chunk = file == names.files.back();
    const auto end = is_chunk ? bytes.end() : std::ranges::find(bytes, std::uint8_t{0});
    const std::size_t length = std::size_t(end - bytes.begin());
    folder.write(std::string(names.folder) + "/" + file, bytes.first(length));
    bytes = bytes.subspan(std::min(bytes.size(), length + 1));
  }
  return folder.path() + "/" + names.folder;
}

std::string write_volume(const Folder& folder, std::size_t kind, std::span<const std::uint8_t> bytes) {
  if (kind >= names.size()) return write_chunked(folder, chunked[kind - names.size()], bytes);
  const std::string name = names[kind];
  if (name == "a.hdr") folder.write("a.img", bytes);
  return folder.write(name, bytes);
}

void read(const std::string& path, const ReadableFiles& files, bool at_end) {
  FileHints hints;
  hints.channel = 0;  // the only or the first channel
  std::unique_ptr<VolumeFile> file = open_volume(path, hints, files);
  if (at_end && (file->description().time_steps > 1 || file->description().channels > 1)) {
    hints.channel = file->description().channels - 1;
    hints.time_step = file->description().time_steps - 1;
    file = open_volume(path, hints, files);
  }
  const std::array<int, 3> size = file->description().size;
  TexelBox box{{0, 0, 0}, size};
  // A few thousand texels are enough.
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

/// The first byte chooses the format and which end is read.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Folder folder;
  if (size == 0) return 0;
  const std::span bytes = std::span(data, size).subspan(1);
  const std::string path = write_volume(folder, data[0] / 2 % (names.size() + chunked.size()), bytes);
  try {
    read(path, folder.readable(), data[0] % 2 == 1);
  } catch (const FileError&) {
    // Not a volume.
  }
  return 0;
}
