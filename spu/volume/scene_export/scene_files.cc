// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/scene_export/scene_files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "compositor/scene/colour_map.h"
#include "compositor/service/limits.h"
#include "volume/file/file_error.h"
#include "volume/file/nrrd_header.h"
#include "volume/file/part_file.h"

namespace understudy::spu {
namespace {

using volume::PartFile;

/// Beyond the limit, the kernel would send SIGXFSZ.
void check_file_limit(const std::filesystem::path& path, std::uint64_t bytes) {
  rlimit limit{};
  if (getrlimit(RLIMIT_FSIZE, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY || bytes <= limit.rlim_cur)
    return;
  throw volume::FileError(
      fmt::format("{}: takes {} bytes, and this process may write files of {} bytes at most; raise the limit "
                  "with ulimit -f",
                  path.string(), bytes, std::uint64_t(limit.rlim_cur)));
}

void write(const std::filesystem::path& path, std::string_view contents) {
  check_file_limit(path, contents.size());
  PartFile file(path.string(), PartFile::Meanwhile::named);
  file.append(std::as_bytes(std::span(contents)));
  file.finish();
}

/// Returns what is wrong; empty if neither file is there now.
std::string remove_earlier(const std::filesystem::path& folder, const SceneFiles& files) {
  for (const std::string& name : {files.scene, files.colour_map}) {
    const std::filesystem::path path = folder / name;
    std::error_code error;
    std::filesystem::remove(path, error);
    if (error)
      return fmt::format("{}: of an earlier run, cannot be removed: {}; check the folder's permissions",
                         path.string(), error.message());
  }
  return {};
}

std::string mark_of(const std::string& folder, const std::string& run, int number) {
  return fmt::format("{}/.scene_{}.{}", folder, number, std::filesystem::path(run).filename().string());
}

void write_texels(const std::filesystem::path& path, const volume::VolumeDescription& volume,
                  TexelSource& source) {
  volume::TexelBox range{{0, 0, 0}, volume.size};
  check_file_limit(path, std::uint64_t(volume::texels_in(range)) * volume::bytes_per_texel(volume.type));
  PartFile file(path.string(), PartFile::Meanwhile::named);
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
  if (!run.empty()) {
    const int descriptor =
        ::open(mark_of(folder, run, number).c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0600);
    // Other errors are those of the files that follow.
    if (descriptor < 0 && errno == EEXIST) return false;
    if (descriptor >= 0) ::close(descriptor);
  }
  if (const std::string wrong = remove_earlier(folder, scene_files(number)); !wrong.empty()) {
    // The launcher reports a scene if it finds a mark and the file.
    if (!run.empty()) withdraw_claim(folder, run, number);
    throw volume::FileError(wrong);
  }
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
  write_texels(in / files.texels, scene.volume, source);
  write(in / files.header, volume::nrrd_header(scene.volume.size, scene.volume.type, files.texels));
  if (const auto map = compositor::paraview_colour_map(scene.request.classification, scene.volume.type))
    write(in / files.colour_map, *map);
  write(in / files.image, image.colour);
  write(in / files.alpha, image.alpha);
  write(in / files.scene, text);
}

}  // namespace understudy::spu
