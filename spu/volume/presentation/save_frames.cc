// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/presentation/save_frames.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <vector>

namespace understudy::spu {
namespace {

std::string pfm(const char* kind, const volume::Rect& size, const std::vector<float>& values) {
  // A negative scale means little-endian; rows are bottom up, as in the framebuffer.
  std::string file = fmt::format("{}\n{} {}\n-1.0\n", kind, size.width, size.height);
  file.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
  return file;
}

std::string write(const std::string& path, const std::string& contents) {
  std::ofstream file(path, std::ios::binary);
  file.write(contents.data(), std::streamsize(contents.size()));
  file.close();
  if (file) return {};
  return fmt::format("cannot write {}: {}; check that the folder exists and has room", path,
                     std::strerror(errno));
}

}  // namespace

FloatMaps float_maps(const volume::Rect& viewport, const volume::ImageView& image, float outside) {
  std::vector<float> colour(3 * viewport.pixels(), outside);
  std::vector<float> alpha(viewport.pixels(), outside);
  const volume::Rect shared = intersection(viewport, image.rect);
  for (int y = shared.y; y < shared.y + shared.height; ++y) {
    for (int x = shared.x; x < shared.x + shared.width; ++x) {
      const std::size_t from =
          std::size_t(y - image.rect.y) * std::size_t(image.rect.width) + std::size_t(x - image.rect.x);
      const std::size_t to =
          std::size_t(y - viewport.y) * std::size_t(viewport.width) + std::size_t(x - viewport.x);
      for (std::size_t c = 0; c < 3; ++c) colour[3 * to + c] = image.rgba[4 * from + c];
      alpha[to] = image.rgba[4 * from + 3];
    }
  }
  return {pfm("PF", viewport, colour), pfm("Pf", viewport, alpha)};
}

std::string save_frame(const std::string& folder, std::uint64_t number, const volume::Rect& viewport,
                       const volume::ImageView& image, float outside) {
  const FloatMaps maps = float_maps(viewport, image, outside);
  const std::string stem = fmt::format("{}/frame_{:04}", folder, number);
  const std::string trouble = write(stem + ".pfm", maps.colour);
  return trouble.empty() ? write(stem + "_alpha.pfm", maps.alpha) : trouble;
}

}  // namespace understudy::spu
