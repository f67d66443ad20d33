// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/study/viewer_command.h"

#include <fmt/format.h>

#include <fstream>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "apps/understudy/processes/child_process.h"
#include "apps/understudy/processes/installation.h"
#include "volume/texture_space.h"

namespace understudy::launcher::study {
namespace {

namespace fs = std::filesystem;

constexpr int patience_ms = 180000;

fs::path texels_in(const fs::path& folder) {
  return folder / "texels.raw";
}

}  // namespace

fs::path viewer_program() {
  return this_installation().programs / "understudy-viewer";
}

fs::path description_in(const fs::path& folder) {
  return folder / "scene.json";
}

void hand_out_to(const fs::path& folder, const Scene& scene) {
  scene.hand_out(texels_in(folder), description_in(folder));
}

std::vector<std::string> viewer_command(const Scene& scene, const fs::path& folder) {
  std::vector<std::string> arguments{viewer_program().string(), texels_in(folder).string()};
  const auto option = [&](const char* name, const auto&... values) {
    arguments.emplace_back(name);
    (arguments.push_back(fmt::format("{}", values)), ...);
  };
  const auto& size = scene.size();
  const volume::Vec3& spacing = scene.spacing();
  option("--size", size[0], size[1], size[2]);
  option("--type", scene.texel_type());
  option("--spacing", spacing[0], spacing[1], spacing[2]);
  option("--table", description_in(folder).string());
  const volume::OrbitCamera& camera = Scene::cameras().front();
  option("--azimuth", camera.azimuth);
  option("--elevation", camera.elevation);
  option("--distance", camera.distance / 2);  // the viewer takes whole diagonals
  option("--window-size", scene.edge(), scene.edge());
  for (const char* flag : {"--offscreen", "--no-frame"}) arguments.emplace_back(flag);
  return arguments;
}

std::string output_of(std::vector<std::string> arguments, const fs::path& log) {
  const std::string name = fs::path(arguments.front()).filename().string();
  fs::remove(log);  // child processes append to it
  Environment environment = current_environment();
  environment["LIBGL_ALWAYS_SOFTWARE"] = std::string("1");
  environment["UNDERSTUDY_CONFIG"] = "";  // ignores the user's defaults
  std::optional<Ending> ending;
  try {
    ChildProcess child({std::move(arguments), std::move(environment), log, true});
    ending = child.wait_for_ending(patience_ms);
  } catch (const std::system_error& error) {
    throw std::runtime_error(error.what());
  }
  std::ifstream file(log);
  std::string text(std::istreambuf_iterator<char>(file), {});
  if (!ending) throw std::runtime_error(fmt::format("{} took more than {} s", name, patience_ms / 1000));
  if (ending->exit_status() != 0) {
    constexpr std::size_t last_words = 300;
    if (text.size() > last_words) text = text.substr(text.size() - last_words);
    throw std::runtime_error(fmt::format("{} {}: {}", name, ending->text(), text));
  }
  return text;
}

}  // namespace understudy::launcher::study
