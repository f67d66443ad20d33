// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/doctor/deep_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>

#include "apps/understudy/launch/run_folder.h"
#include "apps/understudy/processes/child_process.h"
#include "apps/understudy/processes/environment.h"
#include "apps/understudy/processes/installation.h"
#include "apps/understudy/processes/last_line.h"

namespace understudy::launcher {

namespace {

constexpr int patience_ms = 20'000;
constexpr int edge = 24;  // edge of the volume, in voxels

struct Way {
  const char* name;
  std::vector<std::string> options;
  const char* fix;
};

std::vector<Way> ways() {
  constexpr const char* loader = "use another injection method; docs/install.md lists what each intercepts";
  return {{"run, audit", {"--injection", "audit"}, loader},
          {"run, preload", {"--injection", "preload"}, loader},
          {"run, folder", {"--injection", "folder"}, loader},
          {"run, two nodes", {"-n", "2"}, "see the lines MPI and nodes above"},
          {"run, GL server", {"--remote"}, "apt install libegl1 libegl-mesa0 libgl1-mesa-dri"}};
}

/// Writes a ball that is densest in its centre, as raw bytes; returns its path.
std::filesystem::path written_volume(const std::filesystem::path& folder) {
  std::filesystem::path path = folder / fmt::format("ball.{0}x{0}x{0}.raw", edge);
  std::ofstream file(path, std::ios::binary);
  for (int z = 0; z < edge; ++z)
    for (int y = 0; y < edge; ++y)
      for (int x = 0; x < edge; ++x) {
        const auto square = [](int at) { return (2 * at - edge) * (2 * at - edge); };
        file.put(
            static_cast<char>(std::max(0, 255 - 255 * (square(x) + square(y) + square(z)) / (edge * edge))));
      }
  return path;
}

Finding tried(const Way& way, const std::filesystem::path& volume, const std::filesystem::path& log) {
  const Installation here = this_installation();
  Command command;
  command.arguments = {here.programs / "understudy", "run", "--require", "--speed-guard", "off"};
  command.arguments.insert(command.arguments.end(), way.options.begin(), way.options.end());
  for (const std::string& word :
       {std::string("--"), (here.programs / "understudy-viewer").string(), volume.string(),
        std::string("--offscreen"), std::string("--frames"), std::string("3"), std::string("--window-size"),
        std::string("64"), std::string("64")})
    command.arguments.push_back(word);
  command.environment = current_environment();
  command.environment["UNDERSTUDY_CONFIG"] = "";
  command.output = log;
  command.own_group = true;
  const auto start = std::chrono::steady_clock::now();
  ChildProcess run(command);
  const auto ending = run.wait_for_ending(patience_ms);
  if (!ending) return {false, fmt::format("did not end within {} s", patience_ms / 1000)};
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  const std::string said = last_line(log);
  if (ending->exit_status() != 0) return {false, fmt::format("{}: {}", ending->text(), said)};
  return {true, fmt::format("a volume was substituted ({:.1f} s)", took.count())};
}

}  // namespace

std::vector<NamedFinding> deep_findings(const std::function<void(const NamedFinding&)>& told) {
  const RunFolder folder;
  const std::filesystem::path volume = written_volume(folder.path());
  std::vector<NamedFinding> findings;
  for (const Way& way : ways()) {
    findings.push_back({way.name, tried(way, volume, folder.path() / "log"), way.fix});
    told(findings.back());
  }
  return findings;
}

}  // namespace understudy::launcher
