// SPDX-License-Identifier: Apache-2.0
#include "tests/apps/viewer/run_viewer.h"

#include <fcntl.h>
#include <png.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "tests/apps/viewer/temporary_folder.h"

extern char** environ;

namespace viewer_test {

namespace {

std::string contents(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<char*> pointers(std::vector<std::string>& texts) {
  std::vector<char*> result;
  result.reserve(texts.size() + 1);
  for (std::string& text : texts) result.push_back(text.data());
  result.push_back(nullptr);
  return result;
}

// The system's graphics libraries keep memory until the process ends, so leaks are not checked here.
std::vector<std::string> viewer_environment(const std::string& display) {
  std::vector<std::string> result = {"LIBGL_ALWAYS_SOFTWARE=1", "ASAN_OPTIONS=detect_leaks=0"};
  if (!display.empty()) result.push_back("DISPLAY=" + display);
  constexpr std::string_view replaced[] = {
      "LIBGL_ALWAYS_SOFTWARE=", "ASAN_OPTIONS=", "DISPLAY=", "LD_PRELOAD=", "LD_AUDIT="};
  for (char** variable = environ; *variable; ++variable)
    if (std::none_of(std::begin(replaced), std::end(replaced),
                     [&](std::string_view name) { return std::string_view(*variable).starts_with(name); }))
      result.emplace_back(*variable);
  return result;
}

}  // namespace

Outcome run_program(const std::vector<std::string>& command, const std::string& display) {
  const TemporaryFolder folder;
  const std::string out = folder.file("out"), err = folder.file("err");
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(), O_WRONLY | O_CREAT, 0600);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err.c_str(), O_WRONLY | O_CREAT, 0600);
  std::vector<std::string> arguments = command, environment = viewer_environment(display);
  pid_t child = 0;
  const int failed = posix_spawnp(&child, command.front().c_str(), &actions, nullptr,
                                  pointers(arguments).data(), pointers(environment).data());
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) throw std::runtime_error("cannot run " + command.front());
  int status = 0;
  waitpid(child, &status, 0);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, contents(out), contents(err)};
}

Outcome run_viewer(const std::vector<std::string>& arguments, const std::string& display) {
  std::vector<std::string> command = {VIEWER_PROGRAM};
  command.insert(command.end(), arguments.begin(), arguments.end());
  return run_program(command, display);
}

Image read_png(const std::string& path) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_file(&png, path.c_str()))
    throw std::runtime_error(path + ": " + std::string(png.message));
  png.format = PNG_FORMAT_RGB;
  Image image{static_cast<int>(png.width), static_cast<int>(png.height), {}};
  image.rgb.resize(PNG_IMAGE_SIZE(png));
  if (!png_image_finish_read(&png, nullptr, image.rgb.data(), 0, nullptr))
    throw std::runtime_error(path + ": " + std::string(png.message));
  return image;
}

Difference difference(const std::vector<double>& a, const std::vector<double>& b) {
  if (a.size() != b.size() || a.empty()) throw std::runtime_error("images of different sizes");
  Difference result;
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double d = std::abs(a[i] - b[i]);
    result.max = std::max(result.max, d);
    sum += d * d;
  }
  result.rms = std::sqrt(sum / static_cast<double>(a.size()));
  result.psnr = result.rms > 0 ? 20 * std::log10(255 / result.rms) : std::numeric_limits<double>::infinity();
  return result;
}

Difference difference(const Image& a, const Image& b) {
  return difference(std::vector<double>(a.rgb.begin(), a.rgb.end()),
                    std::vector<double>(b.rgb.begin(), b.rgb.end()));
}

}  // namespace viewer_test
