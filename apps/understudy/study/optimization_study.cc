// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/study/optimization_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <system_error>

#include "apps/understudy/images/image.h"
#include "apps/understudy/processes/installation.h"
#include "apps/understudy/study/median.h"
#include "apps/understudy/study/viewer_command.h"
#include "spu/report/optimization.h"

namespace understudy::launcher::study {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;
using spu::Optimization;

constexpr int frames = 15, frames_that_settle = 5;

/// How to show the scene so that the optimization has an effect.
struct Show {
  Optimization optimization;
  Words viewer;
  Words run = {};
  bool rising = false;  ///< with colours that increase with the value
};

const std::array shows{
    Show{Optimization::empty_bricks, {"--orbit", "3"}},
    Show{Optimization::hidden_samples, {"--orbit", "3"}},
    Show{Optimization::dominated_samples, {"--orbit", "3", "--operator", "max"}, {}, true},
    Show{Optimization::footprints, {"--orbit", "3"}, {"-n", "3", "--sort", "last"}},
    Show{Optimization::unchanged_images, {}},
    Show{Optimization::unchanged_texels, {"--orbit", "3"}},
    Show{Optimization::known_colours, {"--orbit", "3"}},
    Show{Optimization::absent_depth, {"--orbit", "3"}},
    Show{Optimization::unseen_depth, {"--orbit", "3", "--write-depth"}},
};

/// A maximum projection skips dominated samples if colours increase with the value.
constexpr const char* rising_table = R"({"knots": [{"at": 0, "colour": [0, 0, 0], "opacity": 0},
                                                  {"at": 1, "colour": [1, 1, 1], "opacity": 1}]})";

fs::path rising_in(const fs::path& folder) {
  return folder / "rising.json";
}

struct Shown {
  double ms = 0;
  std::uint64_t left_out = 0, done = 0;
  fs::path images;
};

Shown show(const Scene& scene, const Show& how, const fs::path& folder, bool nevertheless) {
  const char* const item = spu::text_of(how.optimization).name;
  const fs::path report = folder / "report.json";
  Shown shown;
  shown.images = folder / (nevertheless ? "without" : "with");
  fs::remove_all(shown.images);
  Words words{(this_installation().programs / "understudy").string(),
              "run",
              "--report",
              report.string(),
              "--save-frames",
              shown.images.string()};
  if (nevertheless) words.insert(words.end(), {"--disable-optimization", item});
  words.insert(words.end(), how.run.begin(), how.run.end());
  words.emplace_back("--");
  Words viewer = viewer_command(scene, folder);
  if (how.rising) std::ranges::replace(viewer, description_in(folder).string(), rising_in(folder).string());
  words.insert(words.end(), viewer.begin(), viewer.end());
  words.insert(words.end(), how.viewer.begin(), how.viewer.end());
  words.insert(words.end(), {"--mode", "core", "--frames", std::to_string(frames)});
  output_of(std::move(words), folder / "viewer.txt");

  std::ifstream file(report);
  const auto json = nlohmann::json::parse(file);
  const auto& figures = json.at("left_out").at("items").at(item);
  shown.left_out = figures.at("left_out");
  shown.done = figures.at("done");
  std::vector<double> times;
  for (const auto& frame : json.at("frames_detail"))
    if (frame.at("substituted") > 0) times.push_back(frame.at("time_ms"));
  if (int(times.size()) != frames) throw std::runtime_error("not every frame was substituted");
  times.erase(times.begin(), times.begin() + frames_that_settle);
  shown.ms = median(std::move(times));
  return shown;
}

double largest_difference(const fs::path& a, const fs::path& b) {
  double most = 0;
  int compared = 0;
  for (const auto& entry : fs::directory_iterator(a)) {
    const std::string name = entry.path().filename().string();
    if (name.find("_alpha") != std::string::npos) continue;
    const RgbaImage one = read_image(entry.path()), other = read_image(b / name);
    ++compared;
    if (one.rgba.size() != other.rgba.size()) throw std::runtime_error("the images differ in size");
    for (std::size_t i = 0; i < one.rgba.size(); ++i)
      most = std::max(most, std::abs(double(one.rgba[i]) - double(other.rgba[i])));
  }
  if (compared != frames) throw std::runtime_error(fmt::format("{} images instead of {}", compared, frames));
  return most;
}

}  // namespace

std::vector<Saving> savings_of(const Scene& scene, const fs::path& folder,
                               const std::function<void(const std::string& item)>& progress) {
  fs::create_directories(folder);
  hand_out_to(folder, scene);
  std::ofstream(rising_in(folder)) << rising_table;
  std::vector<Saving> savings;
  for (const Show& how : shows) {
    const spu::OptimizationText& about = spu::text_of(how.optimization);
    progress(about.name);
    Saving saving{about.name, about.unit, fmt::format("{}", fmt::join(how.viewer, " "))};
    if (how.rising) saving.shown += " in rising grey";
    if (!how.run.empty()) saving.shown += fmt::format(", run {}", fmt::join(how.run, " "));
    saving.tolerance = about.tolerance;
    try {
      const Shown usual = show(scene, how, folder, false), nevertheless = show(scene, how, folder, true);
      saving.left_out = usual.left_out;
      saving.all = usual.left_out + usual.done;
      saving.ms = usual.ms;
      saving.ms_without = nevertheless.ms;
      saving.difference = largest_difference(usual.images, nevertheless.images);
    } catch (const std::exception& error) {
      saving.absent = error.what();
    }
    savings.push_back(std::move(saving));
  }
  std::error_code ignored;
  fs::remove_all(folder, ignored);
  return savings;
}

}  // namespace understudy::launcher::study
