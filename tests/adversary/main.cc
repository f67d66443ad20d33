// SPDX-License-Identifier: Apache-2.0
// adversary list
// adversary run NAME FOLDER [--frames N] [--edge N] [--exact]
// adversary show random_SEED
//
// Runs one scenario (random_SEED: a randomly generated one) and saves what it showed: FOLDER/frame_NNNN.pam
// (8-bit RGBA, rows bottom up) and facts.txt.
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>

#include "tests/adversary/random_scenario.h"
#include "tests/adversary/scenario.h"

namespace adversary {
namespace {

struct Arguments {
  std::string name;
  std::filesystem::path folder;
  int frames = 30;
  int edge = 256;
  Precision precision = Precision::viewer;
};

void list() {
  for (const auto& [name, scenario] : all_scenarios())
    std::cout << name << "\t" << text_of(scenario.expectation) << "\t" << scenario.sentence << "\n";
}

/// Returns the seed of `random_SEED`; null for other names.
std::optional<unsigned> seed_of(const std::string& name) {
  if (!name.starts_with("random_")) return std::nullopt;
  return static_cast<unsigned>(std::stoul(name.substr(7)));
}

Scenario find(const std::string& name) {
  if (const auto seed = seed_of(name)) return random_scenario(*seed).scenario;
  for (const NamedScenario& each : all_scenarios())
    if (each.name == name) return each.scenario;
  throw std::runtime_error("there is no scenario " + name + "; `adversary list` names all");
}

void save(const Canvas& canvas, const std::filesystem::path& path) {
  const auto pixels = canvas.read();
  std::ofstream file(path, std::ios::binary);
  file << "P7\nWIDTH " << canvas.width() << "\nHEIGHT " << canvas.height()
       << "\nDEPTH 4\nMAXVAL 255\nTUPLTYPE RGB_ALPHA\nENDHDR\n";
  file.write(reinterpret_cast<const char*>(pixels.data()), static_cast<std::streamsize>(pixels.size()));
  if (!file) throw std::runtime_error("cannot write " + path.string());
}

void show_frame(Canvas& canvas, const DrawFrame& draw, int frame, const std::filesystem::path& folder) {
  draw(frame);
  char name[32];
  std::snprintf(name, sizeof(name), "frame_%04d.pam", frame);
  save(canvas, folder / name);
  canvas.swap();
  if (const GLenum error = canvas.gl.GetError(); error != GL_NO_ERROR)
    canvas.note("OpenGL error " + std::to_string(error) + " in frame " + std::to_string(frame));
}

void run(const Arguments& arguments) {
  const Scenario scenario = find(arguments.name);
  std::filesystem::create_directories(arguments.folder);
  Canvas canvas(scenario.profile, arguments.precision, arguments.edge, arguments.edge);
  const DrawFrame draw = scenario.start(canvas);
  for (int frame = 0; frame < arguments.frames; ++frame) show_frame(canvas, draw, frame, arguments.folder);
  std::ofstream facts(arguments.folder / "facts.txt");
  for (const std::string& fact : canvas.facts()) facts << fact << "\n";
}

Arguments parsed(std::span<char*> words) {
  if (words.size() < 4 || std::string(words[1]) != "run")
    throw std::runtime_error(
        "usage: adversary list | run NAME FOLDER [--frames N] [--edge N] [--exact] | show random_SEED");
  Arguments arguments{.name = words[2], .folder = words[3]};
  for (std::size_t i = 4; i < words.size(); ++i) {
    const std::string word = words[i];
    if (word == "--exact")
      arguments.precision = Precision::exact;
    else if (word == "--frames" && i + 1 < words.size())
      arguments.frames = std::stoi(words[++i]);
    else if (word == "--edge" && i + 1 < words.size())
      arguments.edge = std::stoi(words[++i]);
    else
      throw std::runtime_error("unknown option " + word);
  }
  return arguments;
}

void show(const std::string& name) {
  const auto seed = seed_of(name);
  if (!seed) throw std::runtime_error("only the programs of random_SEED can be shown, and not " + name);
  std::cout << random_fragment_shader(*seed);
}

}  // namespace
}  // namespace adversary

int main(int count, char** words) {
  try {
    if (count == 2 && std::string(words[1]) == "list")
      adversary::list();
    else if (count == 3 && std::string(words[1]) == "show")
      adversary::show(words[2]);
    else
      adversary::run(adversary::parsed({words, static_cast<std::size_t>(count)}));
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "adversary: " << error.what() << "\n";
    return 1;
  }
}
