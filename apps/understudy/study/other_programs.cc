// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/study/other_programs.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "apps/understudy/images/image.h"
#include "apps/understudy/processes/installation.h"
#include "apps/understudy/study/median.h"
#include "apps/understudy/study/viewer_command.h"
#include "volume/image.h"

namespace understudy::launcher::study {
namespace {

namespace fs = std::filesystem;

constexpr int viewer_frames = 9, frames_until_settled = 3, vtk_frames = 3;
constexpr const char* python = "/usr/bin/python3";  // the interpreter for which Debian's packages are installed

fs::path vtk_script() {
  return this_installation().data / "vtk_mappers.py";
}

}  // namespace

struct OtherPrograms::Drawn {
  double time_ms = 0;
  volume::Image image;
};

OtherPrograms::OtherPrograms(fs::path folder) : folder_(std::move(folder)) {
  fs::create_directories(folder_);
  if (!fs::exists(viewer_program()))
    absent_[Scheme::bare_viewer] =
        viewer_program().string() + " does not exist; build the target understudy-viewer";
  std::string vtk;
  if (!program_on_path("xvfb-run")) {
    vtk = "xvfb-run is not installed; apt install xvfb";
  } else if (!fs::exists(vtk_script())) {
    vtk = vtk_script().string() + " does not exist; build the target understudy";
  } else {
    try {
      output_of({python, "-c", "import vtk, numpy"}, folder_ / "vtk.txt");
    } catch (const std::runtime_error&) {
      vtk = "VTK or NumPy is not installed; apt install python3-vtk9 python3-numpy";
    }
  }
  if (!vtk.empty()) absent_[Scheme::vtk_gpu] = absent_[Scheme::vtk_fixed_point] = vtk;
}

OtherPrograms::~OtherPrograms() {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

std::optional<std::string> OtherPrograms::absence(Scheme scheme) const {
  const auto found = absent_.find(scheme);
  return found == absent_.end() ? std::nullopt : std::optional(found->second);
}

OtherPrograms::Drawn OtherPrograms::bare_viewer(const Scene& scene) const {
  const fs::path screenshot = folder_ / "viewer.png";
  std::vector<std::string> arguments = viewer_command(scene, folder_);
  const auto option = [&](const char* name, const std::string& value) {
    arguments.insert(arguments.end(), {name, value});
  };
  option("--frames", std::to_string(viewer_frames));
  option("--screenshot", screenshot.string());
  arguments.emplace_back("--print-times");
  std::istringstream lines(output_of(std::move(arguments), folder_ / "viewer.txt"));
  std::vector<double> times;
  for (std::string line; std::getline(lines, line);)
    if (const std::size_t colon = line.find(": "); line.starts_with("frame ") && colon != std::string::npos)
      times.push_back(std::stod(line.substr(colon + 2)));
  if (int(times.size()) != viewer_frames) throw std::runtime_error("understudy-viewer printed no times");
  times.erase(times.begin(), times.begin() + frames_until_settled);

  Drawn drawn{median(std::move(times)), volume::Image({0, 0, scene.edge(), scene.edge()})};
  const RgbaImage image = read_image(screenshot);
  if (image.width != scene.edge() || image.height != scene.edge())
    throw std::runtime_error("understudy-viewer's image has a wrong size");
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      std::copy_n(image.pixel(x, image.height - 1 - y), 4, drawn.image.at(x, y));
  return drawn;
}

OtherPrograms::Drawn OtherPrograms::vtk(const Scene& scene, const char* mapper) const {
  const fs::path floats = folder_ / "vtk.f32";
  const std::string text =
      output_of({"xvfb-run", "-a", python, "-B", vtk_script().string(), description_in(folder_).string(),
                 "--mapper", mapper, "--frames", fmt::format("{}", vtk_frames), "--image", floats.string()},
                folder_ / "vtk.txt");
  const auto figures = nlohmann::json::parse(text.substr(std::min(text.rfind('{'), text.size())));
  Drawn drawn{1000 * figures.at("wall_seconds").get<double>(),
              volume::Image({0, 0, scene.edge(), scene.edge()})};
  std::ifstream file(floats, std::ios::binary);
  if (!file.read(reinterpret_cast<char*>(drawn.image.rgba.data()),
                 std::streamsize(sizeof(float) * drawn.image.rgba.size())))
    throw std::runtime_error("VTK wrote no complete image");
  return drawn;
}

Point OtherPrograms::measure(const Scene& scene, const Setting& setting, Scene::Rays& rays) const {
  hand_out_to(folder_, scene);
  Drawn drawn;
  try {
    drawn = setting.scheme == Scheme::bare_viewer
                ? bare_viewer(scene)
                : vtk(scene, setting.scheme == Scheme::vtk_gpu ? "gpu" : "fixed-point");
  } catch (const nlohmann::json::exception& error) {
    throw std::runtime_error(error.what());
  } catch (const std::invalid_argument&) {
    throw std::runtime_error("a frame time is not a number");
  }
  Point point{setting};
  point.time_ms = drawn.time_ms;
  point.ns_per_ray = 1e6 * drawn.time_ms / (double(scene.edge()) * scene.edge());
  rays = scene.compared(drawn.image);
  const auto exact = scene.exact_of_first_camera();
  for (std::size_t i = 0; i < rays.size(); ++i) rays[i][3] = exact[i][3];
  point.error = difference(rays, exact);
  point.error.rms = point.error.colour;
  return point;
}

}  // namespace understudy::launcher::study
