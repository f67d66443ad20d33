// SPDX-License-Identifier: Apache-2.0
#include "apps/viewer/frames.h"

#include <GL/glew.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>

#include "apps/viewer/description.h"
#include "apps/viewer/model/error.h"
#include "apps/viewer/screenshot.h"

namespace viewer {

namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

std::string frame_file(const std::string& folder, int frame) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error)
    throw Error(ExitCode::bad_file,
                fmt::format("{}: the folder cannot be created: {}; give another folder to --screenshot-frames",
                            folder, error.message()));
  return (std::filesystem::path(folder) / fmt::format("frame_{:04}.png", frame)).string();
}

}  // namespace

void Frames::draw_next(Camera camera, int width, int height, const std::function<void()>& present) {
  const int index = drawn_++;
  camera.azimuth += index * options_.orbit;

  auto start = Clock::now();
  const DrawnFrame frame = scene_.draw(camera, width, height);
  glFinish();
  double time = milliseconds_since(start);

  // Read between drawing and swapping, while the back buffer is still defined; not
  // included in the frame's time.
  const bool wanted = finished() && !options_.screenshot.empty();
  if (wanted || !options_.screenshot_folder.empty()) {
    const Image image = read_back(width, height);
    if (wanted) write_png(image, options_.screenshot);
    if (!options_.screenshot_folder.empty()) write_png(image, frame_file(options_.screenshot_folder, index));
  }

  start = Clock::now();
  present();
  time += milliseconds_since(start);

  if (options_.print_times) {
    milliseconds_.push_back(time);
    fmt::print("frame {}: {:.2f} ms\n", index, time);
    std::fflush(stdout);
  }
  if (finished() && !options_.description.empty())
    write_description(options_.description, options_, scene_, frame, index);
}

void Frames::print_median() const {
  if (milliseconds_.empty()) return;
  std::vector<double> sorted = milliseconds_;
  std::sort(sorted.begin(), sorted.end());
  const std::size_t middle = sorted.size() / 2;
  const double median = sorted.size() % 2 == 1 ? sorted[middle] : 0.5 * (sorted[middle - 1] + sorted[middle]);
  fmt::print("median: {:.2f} ms\n", median);
}

}  // namespace viewer
