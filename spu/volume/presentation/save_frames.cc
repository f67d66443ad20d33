// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/presentation/save_frames.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <vector>

namespace understudy::spu {
namespace {

std::string write_pfm(const std::string& path, const char* kind, const volume::Rect& size,
                      const std::vector<float>& values) {
  std::ofstream file(path, std::ios::binary);
  // A negative scale means little-endian; rows are bottom up, as in the framebuffer.
  file << kind << '\n' << size.width << ' ' << size.height << "\n-1.0\n";
  file.write(reinterpret_cast<const char*>(values.data()), std::streamsize(values.size() * sizeof(float)));
  file.close();
  if (file) return {};
  return fmt::format("cannot write {}: {}; check that the folder exists and has room", path,
                     std::strerror(errno));
}

}  // namespace

std::string save_frame(const std::string& folder, std::uint64_t number, const volume::Rect& viewport,
                       const volume::ImageView& image, float outside) {
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
  const std::string stem = fmt::format("{}/frame_{:04}", folder, number);
  const std::string trouble = write_pfm(stem + ".pfm", "PF", viewport, colour);
  return trouble.empty() ? write_pfm(stem + "_alpha.pfm", "Pf", viewport, alpha) : trouble;
}

}  // namespace understudy::spu
