// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/file_scene/scene_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <span>
#include <system_error>
#include <utility>
#include <vector>

#include "compositor/service.h"
#include "compositor/service/limits.h"
#include "volume/file/file_error.h"
#include "volume/texel_box.h"

namespace understudy::launcher {
namespace {

[[noreturn]] void fail_scene(const std::filesystem::path& path, const std::string& what) {
  throw volume::FileError(fmt::format("{}: {}", path.string(), what));
}

std::string text_of(const std::filesystem::path& path) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) fail_scene(path, error.message());
  if (size > compositor::max_scene_bytes)
    fail_scene(path, fmt::format("it is longer than {} MiB, the most that a scene has",
                                 compositor::max_scene_bytes >> 20U));
  std::string text(std::size_t(size), ' ');
  std::ifstream file(path, std::ios::binary);
  if (!file.read(text.data(), std::streamsize(text.size()))) fail_scene(path, "it cannot be read");
  return text;
}

std::uint64_t slice_bytes(const volume::VolumeDescription& volume) {
  return std::uint64_t(volume.size[0]) * std::uint64_t(volume.size[1]) * volume::bytes_per_texel(volume.type);
}

void check_size(const std::filesystem::path& texels, const volume::VolumeDescription& volume) {
  if (slice_bytes(volume) > compositor::limits::max_slice_bytes)
    fail_scene(texels,
               fmt::format("a slice of {} x {} texels takes more than {} MiB, the most that is rendered",
                           volume.size[0], volume.size[1], compositor::limits::max_slice_bytes >> 20U));
  const std::uint64_t wanted = slice_bytes(volume) * std::uint64_t(volume.size[2]);
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(texels, error);
  if (error) fail_scene(texels, error.message());
  if (size != wanted)
    fail_scene(
        texels,
        fmt::format("it has {} bytes, and the scene's volume of {} x {} x {} texels takes {}; export the "
                    "scene again",
                    size, volume.size[0], volume.size[1], volume.size[2], wanted));
}

}  // namespace

bool is_scene_file(const std::string& name) {
  return std::filesystem::path(name).extension() == ".json";
}

SceneFile read_scene_file(const std::filesystem::path& path) {
  SceneFile file;
  try {
    file.scene = compositor::scene_in(text_of(path));
  } catch (const compositor::SceneError& error) {
    fail_scene(path, error.what());
  }
  file.texels = path.parent_path() / file.scene.texels;
  check_size(file.texels, file.scene.volume);
  return file;
}

void send_scene(const SceneFile& file, compositor::RenderService& service) {
  const volume::VolumeDescription& volume = file.scene.volume;
  const volume::TexelBox& stored = volume.stored;
  const std::uint64_t slice = slice_bytes(volume);
  const std::size_t texel = volume::bytes_per_texel(volume.type);
  const int slices = int(std::clamp<std::uint64_t>(compositor::limits::max_slice_range_bytes / slice, 1,
                                                   std::uint64_t(volume.size[2])));
  std::ifstream in(file.texels, std::ios::binary);
  in.seekg(std::streamoff(slice * std::uint64_t(stored.low[2])));
  service.begin_volume(volume);
  std::vector<std::byte> read;
  std::vector<std::byte> sent;
  volume::TexelBox range = stored;
  for (; range.low[2] < stored.high[2]; range.low[2] = range.high[2]) {
    range.high[2] = std::min(range.low[2] + slices, stored.high[2]);
    const volume::TexelBox whole{{0, 0, range.low[2]}, {volume.size[0], volume.size[1], range.high[2]}};
    read.resize(volume::texels_in(whole) * texel);
    if (!in.read(reinterpret_cast<char*>(read.data()), std::streamsize(read.size())))
      fail_scene(file.texels, "it cannot be read");
    sent.resize(volume::texels_in(range) * texel);
    volume::copy_texels(range, texel, whole, read, range, sent);
    service.add_texels(volume.id, {&range, 1}, sent);
  }
  service.end_volume(volume.id);
}

}  // namespace understudy::launcher
