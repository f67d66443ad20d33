// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/scene_export/scene_files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "compositor/scene/colour_map.h"
#include "compositor/service/limits.h"
#include "volume/file/nrrd_header.h"
#include "volume/file/part_file.h"

namespace understudy::spu {
namespace {

using volume::PartFile;

void write(const std::filesystem::path& path, std::string_view contents) {
  PartFile file(path.string(), PartFile::Meanwhile::named);
  file.append(std::as_bytes(std::span(contents)));
  file.finish();
}

std::string mark_of(const std::string& folder, const std::string& run, int number) {
  return fmt::format("{}/.scene_{}.{}", folder, number, std::filesystem::path(run).filename().string());
}

void write_texels(const std::filesystem::path& path, const volume::VolumeDescription& volume,
                  TexelSource& source) {
  PartFile file(path.string(), PartFile::Meanwhile::named);
  volume::TexelBox range{{0, 0, 0}, volume.size};
  const std::size_t slice =
      std::size_t(volume.size[0]) * std::size_t(volume.size[1]) * volume::bytes_per_texel(volume.type);
  const int slices = int(std::clamp<std::size_t>(compositor::limits::max_slice_range_bytes / slice, 1,
                                                 std::size_t(volume.size[2])));
  std::vector<std::byte> texels;
  for (; range.low[2] < volume.size[2]; range.low[2] = range.high[2]) {
    range.high[2] = std::min(range.low[2] + slices, volume.size[2]);
    texels.resize(slice * std::size_t(range.high[2] - range.low[2]));
    source.read(range, texels);
    file.append(texels);
  }
  file.finish();
}

}  // namespace

SceneFiles scene_files(int number) {
  const std::string after = number == 1 ? "" : fmt::format("_{}", number);
  return {fmt::format("scene{}.json", after), fmt::format("volume{}.nhdr", after),
          fmt::format("volume{}.raw", after), fmt::format("transfer_function{}.json", after),
          fmt::format("image{}.pfm", after),  fmt::format("image{}_alpha.pfm", after)};
}

bool claim_scene(const std::string& folder, const std::string& run, int number) {
  if (run.empty()) return true;
  const int descriptor =
      ::open(mark_of(folder, run, number).c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0600);
  // Other errors are those of the files that follow.
  if (descriptor < 0) return errno != EEXIST;
  ::close(descriptor);
  return true;
}

bool withdraw_claim(const std::string& folder, const std::string& run, int number) {
  std::error_code none;
  return std::filesystem::remove(mark_of(folder, run, number), none);
}

void write_scene(const std::string& folder, const SceneFiles& files, compositor::ExportedScene scene,
                 TexelSource& source, const FloatMaps& image) {
  namespace fs = std::filesystem;
  const fs::path in = folder;
  scene.texels = files.texels;
  const std::string text = compositor::scene_text(scene);
  fs::create_directories(in);
  // A scene of an earlier run must not name the texels of this one, nor a colour map stay that it had.
  fs::remove(in / files.scene);
  fs::remove(in / files.colour_map);
  write_texels(in / files.texels, scene.volume, source);
  write(in / files.header, volume::nrrd_header(scene.volume.size, scene.volume.type, files.texels));
  if (const auto map = compositor::paraview_colour_map(scene.request.classification, scene.volume.type))
    write(in / files.colour_map, *map);
  write(in / files.image, image.colour);
  write(in / files.alpha, image.alpha);
  write(in / files.scene, text);
}

}  // namespace understudy::spu
