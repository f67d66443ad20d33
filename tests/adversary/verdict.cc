// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

namespace adversary {
namespace {

std::string contents(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Returns the first line that differs from the bare run, with both versions; empty if none does.
std::string first_difference(const std::filesystem::path& bare, const std::filesystem::path& under) {
  std::ifstream before(bare), after(under);
  std::string expected, told;
  while (true) {
    const bool more_before = static_cast<bool>(std::getline(before, expected));
    const bool more_after = static_cast<bool>(std::getline(after, told));
    if (!more_before && !more_after) return {};
    if (!more_before || !more_after || expected != told)
      return fmt::format("\"{}\", bare \"{}\"", more_after ? told : "", more_before ? expected : "");
  }
}

/// Returns the numbers of the frames that were substituted.
std::vector<int> substituted_frames(const std::filesystem::path& report) {
  std::vector<int> frames;
  const nlohmann::json json = nlohmann::json::parse(contents(report));
  for (const auto& frame : json.at("frames_detail"))
    if (frame.at("substituted").get<int>() > 0) frames.push_back(frame.at("frame").get<int>());
  return frames;
}

int compared_images(const std::filesystem::path& report) {
  int images = 0;
  const nlohmann::json json = nlohmann::json::parse(contents(report));
  for (const auto& volume : json.at("volumes")) images += volume.at("verify").at("frames").get<int>();
  return images;
}

bool is_key(const Scenario& scenario, int frame) {
  return std::find(scenario.key_frames.begin(), scenario.key_frames.end(), frame) != scenario.key_frames.end();
}

}  // namespace

Verdict judge(const std::filesystem::path& folder, int frames) {
  const std::vector<int> substituted = substituted_frames(folder / "report.json");
  const std::filesystem::path exact = folder / (exists(folder / "exact") ? "exact" : "bare");
  Verdict verdict{.frames = frames,
                  .substituted = static_cast<int>(substituted.size()),
                  .compared = compared_images(folder / "report.json")};
  for (int frame = 0; frame < frames; ++frame) {
    const std::string name = fmt::format("frame_{:04}.pam", frame);
    const TileScore tile = worst_tile(read_image(folder / "under" / name), read_image(folder / "bare" / name),
                                      read_image(exact / name));
    if (frame == 0 || tile.excess > verdict.worst.excess) verdict.worst = tile, verdict.worst_frame = frame;
    if (tile.excess <= tile_bound) continue;
    verdict.wrong_frames.push_back(frame);
    verdict.wrong_substituted += std::find(substituted.begin(), substituted.end(), frame) != substituted.end();
  }
  verdict.other_fact = first_difference(folder / "bare" / "facts.txt", folder / "under" / "facts.txt");
  return verdict;
}

bool keeps_images() {
  return std::getenv("ADVERSARY_KEEP_IMAGES") != nullptr;
}

Verdict judge_drawing_exactly_where_needed(const std::filesystem::path& folder, int frames,
                                           const std::function<void()>& draw_exact) {
  if (!keeps_images()) {
    Verdict without = judge(folder, frames);
    if (without.wrong_frames.empty()) return without;
  }
  draw_exact();
  return judge(folder, frames);
}

std::string what_is_not_met(const Scenario& scenario, const Verdict& verdict) {
  if (!verdict.other_fact.empty()) return "OpenGL told the program: " + verdict.other_fact;
  if (verdict.wrong_frames.size() > 1) return "more than one frame is wrong";
  for (const int frame : verdict.wrong_frames)
    if (is_key(scenario, frame))
      return fmt::format("frame {} is wrong, where the program changed something", frame);
  if (scenario.expectation == Expectation::must_be_substituted && 2 * verdict.substituted < verdict.frames)
    return "fewer than half of the frames were substituted";
  if (scenario.expectation == Expectation::must_be_left && verdict.substituted > 0)
    return "frames were substituted, whose drawing has effects beside the image";
  if (scenario.most_compared && verdict.compared > *scenario.most_compared)
    return fmt::format("{} images were compared whole, of which {} are allowed", verdict.compared,
                       *scenario.most_compared);
  return {};
}

std::string line_about(const NamedScenario& scenario, const Verdict& verdict) {
  const std::string failure = what_is_not_met(scenario.scenario, verdict);
  return fmt::format(
      "{} | {} | {} of {} substituted | {} wrong ({} of them substituted) [{}] | worst tile {}/255 in frame {} "
      "at ({}, {}) | {}",
      scenario.name, text_of(scenario.scenario.expectation), verdict.substituted, verdict.frames,
      verdict.wrong_frames.size(), verdict.wrong_substituted, fmt::join(verdict.wrong_frames, " "),
      verdict.worst.excess, verdict.worst_frame, verdict.worst.x, verdict.worst.y,
      failure.empty() ? "met" : failure);
}

}  // namespace adversary
