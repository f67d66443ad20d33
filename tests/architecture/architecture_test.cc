// SPDX-License-Identifier: Apache-2.0
// The rules of the architecture, checked in the source files: who may include whom, and what folders hold.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "tests/architecture/project_files.h"

namespace understudy::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::IsEmpty;

/// Lowest first: a module may include itself and those before it.
constexpr std::array<std::string_view, 6> modules{"volume",      "compositor", "spu",
                                                  "interceptor", "apps",       "tests"};

/// Folders of spu/, lowest first: a folder may include itself and those before it, so there are no cycles.
constexpr auto spu_folders = std::to_array<std::string_view>({

    "spu/report", "spu", "spu/control", "spu/stream", "spu/window_system",
    // units
    "spu/driver", "spu/null", "spu/pass", "spu/perf", "spu/print", "spu/track", "spu/pack", "spu/unpack",
    "spu/trace", "spu/remote", "spu/tiles", "spu/plugin",
    // the volume unit: shared by all its stages
    "spu/volume/program", "spu/volume/refusal", "spu/volume/context", "spu/volume/views", "spu/volume/pipeline",
    "spu/volume/timing", "spu/volume/session", "spu/volume/texture", "spu/volume/budget",
    // its stages
    "spu/volume/observation", "spu/volume/depth", "spu/volume/geometry", "spu/volume/verification",
    "spu/volume/program_check", "spu/volume/classification", "spu/volume/upload", "spu/volume/request",
    "spu/volume/slices", "spu/volume/proxy", "spu/volume/recognition", "spu/volume/known_volumes",
    "spu/volume/presentation", "spu/volume/merging", "spu/volume/scene_export", "spu/volume",
    // what uses all units
    "spu/registry", "spu/player", "spu/trim", "spu/dispatch"});

constexpr std::uintmax_t max_source_bytes = 40'000;

bool is_code(const SourceFile& file) {
  return file.path.ends_with(".h") || file.path.ends_with(".cc");
}

std::string_view module_of(std::string_view path) {
  return path.substr(0, path.find('/'));
}

std::size_t height_of(std::string_view module) {
  return static_cast<std::size_t>(std::find(modules.begin(), modules.end(), module) - modules.begin());
}

/// Returns the headers that the include lines name.
std::vector<std::string> includes_of(const SourceFile& file) {
  static const std::regex line(R"re((?:^|\n)[ \t]*#[ \t]*include[ \t]*[<"]([^>"\n]+)[>"])re");
  std::vector<std::string> found;
  for (std::sregex_iterator match(file.text.begin(), file.text.end(), line), end; match != end; ++match) {
    found.push_back((*match)[1]);
  }
  return found;
}

/// Returns "path includes header" for every include for which `forbidden(file, header)` is true.
template <typename Forbidden>
std::vector<std::string> includes_where(Forbidden forbidden) {
  std::vector<std::string> found;
  for (const SourceFile& file : project_files()) {
    if (!is_code(file)) continue;
    for (const std::string& header : includes_of(file)) {
      if (forbidden(file, header)) found.push_back(file.path + " includes " + header);
    }
  }
  return found;
}

TEST(Architecture, HasFilesInEveryModule) {
  for (const std::string_view module : modules) {
    EXPECT_TRUE(std::any_of(project_files().begin(), project_files().end(), [&](const SourceFile& file) {
      return is_code(file) && module_of(file.path) == module;
    })) << module;
  }
}

TEST(Architecture, NoModuleIncludesAModuleAboveIt) {
  EXPECT_THAT(includes_where([](const SourceFile& file, const std::string& header) {
                const std::string_view target = module_of(header);
                return header.find('/') != std::string::npos && height_of(target) < modules.size() &&
                       height_of(target) > height_of(module_of(file.path));
              }),
              IsEmpty());
}

std::size_t height_in_spu(std::string_view path) {
  const std::string_view folder = path.substr(0, path.rfind('/'));
  return std::size_t(std::find(spu_folders.begin(), spu_folders.end(), folder) - spu_folders.begin());
}

TEST(Architecture, EveryFolderOfSpuHasItsPlace) {
  for (const SourceFile& file : project_files()) {
    if (!is_code(file) || module_of(file.path) != "spu") continue;
    EXPECT_LT(height_in_spu(file.path), spu_folders.size()) << file.path << ": put its folder into the table";
  }
}

TEST(Architecture, NoFolderOfSpuIncludesAFolderAboveIt) {
  EXPECT_THAT(includes_where([](const SourceFile& file, const std::string& header) {
                return module_of(file.path) == "spu" && module_of(header) == "spu" &&
                       height_in_spu(header) > height_in_spu(file.path);
              }),
              IsEmpty());
}

std::string folder_of(const std::string& path) {
  return path.substr(0, path.rfind('/'));
}

/// By folder: the other folders whose headers it includes, each with the first include found.
std::map<std::string, std::map<std::string, std::string>> folders_included() {
  std::set<std::string> paths;
  for (const SourceFile& file : project_files()) paths.insert(file.path);
  std::map<std::string, std::map<std::string, std::string>> included;
  for (const SourceFile& file : project_files()) {
    if (!is_code(file) || module_of(file.path) == "tests") continue;
    for (const std::string& header : includes_of(file)) {
      if (paths.contains(header) && folder_of(header) != folder_of(file.path))
        included[folder_of(file.path)].try_emplace(folder_of(header), file.path + " includes " + header);
    }
  }
  return included;
}

TEST(Architecture, NoFoldersIncludeEachOtherInACycle) {
  // Folders that include none of those left are removed until no folder is left, or only cycles.
  auto left = folders_included();
  bool fewer = true;
  while (fewer) {
    fewer =
        std::erase_if(left, [&](const auto& folder) {
          return std::ranges::none_of(folder.second, [&](const auto& to) { return left.contains(to.first); });
        }) > 0;
  }
  std::string cycles;
  for (const auto& [folder, targets] : left) {
    for (const auto& [target, place] : targets) {
      if (left.contains(target)) cycles += place + "\n";
    }
  }
  EXPECT_EQ(cycles, "");
}

TEST(Architecture, EveryFolderOfTheVolumeUnitSaysWhatItIs) {
  const fs::path root = fs::path(UNDERSTUDY_SOURCE_DIR) / "spu/volume";
  EXPECT_TRUE(fs::exists(root / "README.md"));
  for (const auto& entry : fs::directory_iterator(root)) {
    EXPECT_TRUE(!entry.is_directory() || fs::exists(entry.path() / "README.md")) << entry.path();
  }
}

TEST(Architecture, TheBundledViewerIncludesNothingOfUnderstudy) {
  EXPECT_THAT(includes_where([](const SourceFile& file, const std::string& header) {
                return file.path.starts_with("apps/viewer/") && !header.starts_with("apps/viewer/") &&
                       height_of(module_of(header)) < modules.size();
              }),
              IsEmpty());
}

TEST(Architecture, OnlyTheCompositorTheNodesAndBenchmarksKnowMpi) {
  EXPECT_THAT(includes_where([](const SourceFile& file, const std::string& header) {
                return header == "mpi.h" && module_of(file.path) != "compositor" &&
                       module_of(file.path) != "tests" && !file.path.starts_with("apps/node/") &&
                       !file.path.starts_with("apps/bench/");
              }),
              IsEmpty());
}

TEST(Architecture, VolumeAndCompositorKnowNoOpenGlStream) {
  EXPECT_THAT(includes_where([](const SourceFile& file, const std::string& header) {
                return (module_of(file.path) == "volume" || module_of(file.path) == "compositor") &&
                       ((header.starts_with("GL/") && !file.path.starts_with("volume/glsl/") &&
                         !file.path.starts_with("volume/offscreen/")) ||
                        header.starts_with("dispatch/"));
              }),
              IsEmpty());
}

// interceptor/ exports the same functions; the bundled viewer and the benchmark of calls act as applications.
TEST(Architecture, ContextsWithoutAWindowAreMadeInOneFolder) {
  EXPECT_THAT(includes_where([](const SourceFile& file, const std::string& header) {
                return (header.starts_with("EGL/") || header == "GL/osmesa.h") &&
                       !file.path.starts_with("volume/offscreen/") && module_of(file.path) != "interceptor" &&
                       module_of(file.path) != "tests" && !file.path.starts_with("apps/viewer/") &&
                       file.path != "apps/bench/calls.cc";
              }),
              IsEmpty());
}

TEST(Architecture, TransportKnowsNothingOfWhatItCarries) {
  EXPECT_THAT(includes_where([](const SourceFile& file, const std::string& header) {
                return file.path.starts_with("compositor/transport/") &&
                       !header.starts_with("compositor/transport/") &&
                       (height_of(module_of(header)) < modules.size() || header.starts_with("GL/") ||
                        header.starts_with("EGL/") || header == "mpi.h");
              }),
              IsEmpty());
}

TEST(Architecture, LoggingKnowsNoOtherFolder) {
  EXPECT_THAT(includes_where([](const SourceFile& file, const std::string& header) {
                return file.path.starts_with("compositor/logging/") &&
                       !header.starts_with("compositor/logging/") &&
                       height_of(module_of(header)) < modules.size();
              }),
              IsEmpty());
}

// In a program with more rights than its user, the user's environment cannot be trusted.
TEST(Architecture, WhatLivesInAViewerReadsItsEnvironmentSecurely) {
  const std::regex insecure(
      "(^|[^_a-z])"
      "getenv"
      "[^a-z_]");
  for (const SourceFile& file : project_files()) {
    const std::string_view module = module_of(file.path);
    if (!is_code(file) || module == "apps" || module == "tests") continue;
    EXPECT_FALSE(std::regex_search(file.text, insecure)) << file.path << ": use secure_getenv()";
  }
}

TEST(Architecture, EveryModuleAndEveryProgramSaysWhatItIs) {
  const fs::path root = UNDERSTUDY_SOURCE_DIR;
  for (const std::string_view module : modules) EXPECT_TRUE(fs::exists(root / module / "README.md")) << module;
  for (const auto& entry : fs::directory_iterator(root / "apps")) {
    if (entry.is_directory() && entry.path().filename() != "__pycache__") {
      EXPECT_TRUE(fs::exists(entry.path() / "README.md")) << entry.path();
    }
  }
}

TEST(Architecture, NoSourceFileIsTooLongToRead) {
  for (const SourceFile& file : project_files()) {
    if (is_code(file) || file.path.ends_with(".py")) {
      EXPECT_LE(file.text.size(), max_source_bytes) << file.path;
    }
  }
}

// The patterns are composed here, so that this file does not match them.
TEST(Architecture, HoldsNoGeneratedFile) {
  const std::regex mark(
      std::string("(do not ") + "edit|generated " + "by|@" + "generated|auto-?" + "generated)",
      std::regex::icase);
  for (const SourceFile& file : project_files()) {
    if (!is_code(file)) continue;
    const std::string head = file.text.substr(0, 400);
    EXPECT_FALSE(std::regex_search(head, mark)) << file.path;
  }
}

TEST(Architecture, EveryFileNamesItsLicence) {
  constexpr std::array endings{".h", ".cc", ".py", ".js", ".css", ".html", ".sh", ".cmake", "/CMakeLists.txt"};
  for (const SourceFile& file : project_files()) {
    const std::string path = "/" + file.path;
    const bool needs_one =
        path == "/run" ||
        std::any_of(endings.begin(), endings.end(), [&](const char* ending) { return path.ends_with(ending); });
    if (!needs_one) continue;
    EXPECT_NE(file.text.substr(0, 300).find("SPDX-License-Identifier: Apache-2.0"), std::string::npos)
        << file.path << ": tests/architecture/license_lines.py adds it";
  }
}

TEST(Architecture, HoldsNoPathOfTheMachineItWasWrittenOn) {
  const std::regex path(std::string("(/") + "work/|/" + "root/|/" + "home/[a-z])");
  for (const SourceFile& file : project_files()) {
    std::smatch found;
    EXPECT_FALSE(std::regex_search(file.text, found, path)) << file.path << ": " << found.str();
  }
}

}  // namespace
}  // namespace understudy::testing
