// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/launch/exported_scenes.h"

#include <fmt/format.h>

#include <exception>
#include <set>
#include <string>
#include <vector>

#include "apps/understudy/images/image.h"
#include "apps/understudy/launch/say.h"
#include "spu/report/volume_report.h"
#include "spu/volume/scene_export/scene_files.h"
#include "volume/file/part_file.h"

namespace understudy::launcher {
namespace {

void write_png_of(const std::filesystem::path& float_image) {
  RgbaImage image = read_image(float_image);
  // Premultiplied colours over black are the colours themselves.
  image.has_alpha = false;
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) image.rgba[i] = 1;
  std::filesystem::path png = float_image;
  png.replace_extension(".png");
  volume::PartFile file(png.string());
  file.append(png_bytes(image));
  file.finish();
}

std::set<std::string> reasons_in(spu::Processes processes) {
  std::set<std::string> reasons;
  for (const spu::ProcessCounters* const process : processes) {
    for (const spu::VolumeCounters& volume : process->volume) {
      if (const std::string reason = spu::text_in(volume.not_exported); !reason.empty()) reasons.insert(reason);
    }
  }
  return reasons;
}

}  // namespace

void complete_exported_scenes(const std::filesystem::path& folder, const std::filesystem::path& run,
                              spu::Processes processes) {
  namespace fs = std::filesystem;
  int scenes = 0;
  for (int number = 1; number <= spu::max_exported_scenes; ++number) {
    const spu::SceneFiles files = spu::scene_files(number);
    std::error_code unknown;
    if (!spu::withdraw_claim(folder, run, number) || !fs::exists(folder / files.scene, unknown)) continue;
    ++scenes;
    try {
      write_png_of(folder / files.image);
    } catch (const std::exception& error) {
      say(fmt::format("--export: {}", error.what()));
    }
  }
  if (scenes > 0) return;
  const std::set<std::string> reasons = reasons_in(processes);
  std::string why;
  for (const std::string& reason : reasons) why += (why.empty() ? "" : "; ") + reason;
  say(fmt::format("--export: no scene was exported: {}",
                  why.empty() ? "no volume was substituted and found right" : why));
}

}  // namespace understudy::launcher
