// SPDX-License-Identifier: Apache-2.0
#include "tests/clients/command_test.h"

#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "tests/compositor/group_resources.h"

namespace clients {
namespace {

namespace fs = std::filesystem;
using understudy::compositor::testing::abandoned_shared_memory;

constexpr const char* engine_path = "usr/share/doc/tachyon/examples/scenes/vol/engine.256x256x110";

bool on_path(const std::string& program) {
  const char* path = std::getenv("PATH");
  if (path == nullptr) return false;
  std::istringstream folders(path);
  for (std::string folder; std::getline(folders, folder, ':');)
    if (access((fs::path(folder) / program).c_str(), X_OK) == 0) return true;
  return false;
}

bool is_here(Need need) {
  switch (need) {
    case Need::engine:
      return fs::exists(engine_file());
    case Need::mpi:
      return on_path("mpirun") && fs::exists(programs / "understudy-node");
    case Need::x_server:
      return on_path("Xvfb");
    case Need::osgvolume:
      return on_path("osgvolume");
    case Need::imagemagick:
      return on_path("import");
    case Need::apitrace:
      return on_path("apitrace") && fs::exists(system_libraries / "apitrace/wrappers/egltrace.so");
    case Need::piglit:
      return on_path("piglit");
  }
  return false;
}

const char* remedy(Need need) {
  switch (need) {
    case Need::engine:
      return "the CT of an engine is not here (apt install tachyon-doc, or run ./run demo once)";
    case Need::mpi:
      return "there is no MPI (apt install openmpi-bin libopenmpi-dev)";
    case Need::x_server:
      return "there is no Xvfb (apt install xvfb)";
    case Need::osgvolume:
      return "there is no osgvolume (apt install openscenegraph)";
    case Need::imagemagick:
      return "there is no import (apt install imagemagick)";
    case Need::apitrace:
      return "there is no apitrace (apt install apitrace)";
    case Need::piglit:
      return "there is no piglit (apt install piglit)";
  }
  return "";
}

/// All process ids of this machine.
std::vector<pid_t> all_processes() {
  std::vector<pid_t> found;
  std::error_code gone;
  for (const auto& entry : fs::directory_iterator("/proc", gone)) {
    const std::string name = entry.path().filename();
    pid_t pid = 0;
    if (std::from_chars(name.data(), name.data() + name.size(), pid).ptr == name.data() + name.size())
      found.push_back(pid);
  }
  return found;
}

fs::path proc(pid_t pid, const char* file) {
  return fs::path("/proc") / std::to_string(pid) / file;
}

}  // namespace

Words operator+(Words first, const Words& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

std::string missing(std::initializer_list<Need> needs) {
  std::string sentence;
  for (const Need need : needs)
    if (!is_here(need)) sentence += (sentence.empty() ? "" : "; ") + std::string(remedy(need));
  return sentence;
}

fs::path engine_file() {
  const fs::path installed = fs::path("/") / engine_path;
  // Slim images omit /usr/share/doc when they install a package; the demo then unpacks the file itself.
  return fs::exists(installed) ? installed : fs::path(SOURCE_FOLDER) / "out/data" / engine_path;
}

Words under(const Words& options) {
  return Words{(programs / "understudy").string(), "run"} + options + Words{"--"};
}

Words engine_viewer(const std::string& mode, const Words& options) {
  return Words{(programs / "understudy-viewer").string(),
               engine_file().string(),
               "--mode",
               mode,
               "--offscreen",
               "--window-size",
               "256",
               "256"} +
         options;
}

viewer_test::Difference told(const std::string& what, const viewer_test::Image& a,
                             const viewer_test::Image& b) {
  const viewer_test::Difference difference = viewer_test::difference(a, b);
  fmt::print("{}: max {:.0f} of 255, RMS {:.3f}, PSNR {:.2f} dB\n", what, difference.max, difference.rms,
             difference.psnr);
  return difference;
}

int substituted(const nlohmann::json& report) {
  int runs = 0;
  for (const auto& volume : report.at("volumes")) runs += volume.at("draws").at("substituted").get<int>();
  return runs;
}

CommandTest::CommandTest() : runtime_(folder_.file("runtime")), abandoned_before_(abandoned_shared_memory()) {
  fs::create_directory(runtime_);
}

Command CommandTest::command_of(const Words& words, std::map<std::string, std::string> environment) const {
  environment.emplace("XDG_RUNTIME_DIR", runtime_.string());
  // Results must not depend on other load of this machine.
  environment.emplace("UNDERSTUDY_SPEED_GUARD", "off");
  return {words, environment};
}

Outcome CommandTest::run(const Words& words, const std::map<std::string, std::string>& environment) const {
  return Child(command_of(words, environment), file("")).finish();
}

Outcome CommandTest::run_well(const Words& words, const std::map<std::string, std::string>& environment) const {
  Outcome outcome = run(words, environment);
  EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
  return outcome;
}

nlohmann::json CommandTest::json(const std::string& name) const {
  return nlohmann::json::parse(contents(file(name)));
}

std::vector<pid_t> CommandTest::processes(const std::string& program) const {
  // All descendants of a test, even orphans, have the folder's name in their environment.
  const std::string mark = "XDG_RUNTIME_DIR=" + runtime_.string();
  std::vector<pid_t> found;
  for (const pid_t pid : all_processes()) {
    const std::string environment = '\0' + contents(proc(pid, "environ"));
    if (environment.find('\0' + mark + '\0') == std::string::npos) continue;
    // The kernel truncates names to 15 bytes.
    if (program.empty() || contents(proc(pid, "comm")) == program.substr(0, 15) + "\n") found.push_back(pid);
  }
  return found;
}

std::string CommandTest::leftovers() const {
  std::string left;
  comes_true([&] { return processes().empty(); });
  for (const pid_t pid : processes()) {
    std::string line = contents(proc(pid, "cmdline"));
    std::replace(line.begin(), line.end(), '\0', ' ');
    left += fmt::format("process {}: {}\n", pid, line);
  }
  for (const auto& entry : fs::recursive_directory_iterator(runtime_)) left += entry.path().string() + "\n";
  // Concurrent tests may be about to map shared memory that they have just created.
  std::set<std::string> abandoned = abandoned_shared_memory();
  std::erase_if(abandoned, [&](const std::string& name) { return abandoned_before_.contains(name); });
  comes_true([&] {
    const std::set<std::string> now = abandoned_shared_memory();
    std::erase_if(abandoned, [&](const std::string& name) { return !now.contains(name); });
    return abandoned.empty();
  });
  for (const std::string& name : abandoned) left += name + "\n";
  return left;
}

}  // namespace clients
