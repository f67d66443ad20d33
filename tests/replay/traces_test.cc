// SPDX-License-Identifier: Apache-2.0
// Kept traces: every version of this program must play them and recognise the same volume in them.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "apps/understudy/cli/compare.h"
#include "apps/understudy/cli/play.h"
#include "apps/understudy/cli/trim.h"
#include "apps/understudy/images/image.h"
#include "live_application.h"
#include "spu/stream/trace_file.h"
#include "tests/all_cases.h"
#include "tests/emulation/precision.h"
#include "tests/emulation/viewer_frame.h"

namespace understudy::replay_test {
namespace {

namespace fs = std::filesystem;
using ::testing::IsEmpty;

/// The traces and the expected images were made with this driver.
constexpr const char* expected_driver = "llvmpipe (LLVM 15.0.6, 256 bits)";

struct Trace {
  std::string name;
  int frames;
  /// The viewer's arguments in addition to JUDGED in record_traces.py; empty: the emulation does not support
  /// this case, and images are compared with the kept native ones.
  std::string way;
  bool substituted = true;  ///< false: not substituted, as in a live run
};

const std::vector<Trace>& traces() {
  static const std::vector<Trace> all = {{"rgba", 3, ""},
                                         {"table", 3, ""},
                                         {"core", 3, ""},
                                         {"version_1", 3, ""},
                                         {"under", 2, "--mode table --operator under"},
                                         {"max", 2, "--mode core --operator max"},
                                         {"min", 2, "--mode rgba --operator min"},
                                         {"add", 2, "--mode table --operator add"},
                                         {"opaque", 2, "--mode core --opaque"},
                                         {"second", 2, "--mode rgba --second"},
                                         {"stacks", 2, ""},
                                         {"time", 2, "--mode time"},
                                         {"bricks", 2, ""},
                                         {"preint", 2, ""},
                                         {"lit", 2, "", false}};
  return all;
}

fs::path trace_file(const std::string& name) {
  return fs::path(TRACES) / (name + ".ust");
}

launcher::RgbaImage expected(const std::string& name, int frame) {
  return launcher::read_image(fs::path(EXPECTED) / (name + "_" + std::to_string(frame) + ".png"));
}

bool is_expected_driver() {
  launcher::EglContexts windows;
  windows.create(compatibility_context(1));
  windows.make_current(1, 0, {16, 16});
  const auto* name = reinterpret_cast<const char*>(windows.driver().GetString(GL_RENDERER));
  return name != nullptr && std::string(name) == expected_driver;
}

class Folder {
 public:
  Folder() : path_(trace_of_this_test().replace_extension("")) { fs::create_directories(path_); }
  ~Folder() { fs::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// Runs the command and returns its exit status.
int run_program(const std::string& command) {
  const int status = std::system((command + " >/dev/null 2>&1").c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

int understudy(const std::string& arguments) {
  // Sanitized programs need suppressions of Mesa's leaks.
  return run_program("LSAN_OPTIONS=print_suppressions=0:suppressions=" MESA_LEAKS " " PROGRAMS "/understudy " +
                     arguments);
}

launcher::RgbaImage saved(const fs::path& folder, int frame) {
  return launcher::read_image(folder / ("frame_000" + std::to_string(frame) + ".png"));
}

class Kept : public testing::TestWithParam<Trace> {};

TEST_P(Kept, TracesShowTheSameImagesNatively) {
  const Folder folder;
  spu::Options options;
  options.speed_guard = false;
  options.chain = "driver";
  const launcher::Played played =
      launcher::play({.trace = trace_file(GetParam().name), .save_frames = folder.path()}, options);
  EXPECT_EQ(played.frames, std::uint64_t(GetParam().frames));
  EXPECT_EQ(played.errors, 0U);
  const bool exact = is_expected_driver();
  for (int frame = 1; frame <= GetParam().frames; ++frame) {
    const auto difference = launcher::difference(saved(folder.path(), frame), expected(GetParam().name, frame));
    if (exact) {
      EXPECT_EQ(difference.max, 0) << "frame " << frame;
    } else {
      EXPECT_GE(difference.psnr(), 50) << "frame " << frame;
    }
  }
}

/// The frame described by the viewer when it is called with the arguments of the trace.
emulation::Frame meant(const Trace& trace, int frame, const fs::path& folder) {
  const fs::path description = folder / "description.json";
  const std::string arguments =
      TRACES "/judged.14x14x14 " + trace.way +
      " --preset engine --no-frame --background 0.2 0.4 0.6 --window-size 96 80 --slices 20"
      " --offscreen --orbit 25 --frames " +
      std::to_string(frame) + " --describe " + description.string();
  // Leaks at the viewer's end are Mesa's, which is unloaded by then and cannot be suppressed by name.
  if (run_program("ASAN_OPTIONS=detect_leaks=0 " PROGRAMS "/understudy-viewer " + arguments) != 0)
    throw std::runtime_error("understudy-viewer failed; call it yourself: understudy-viewer " + arguments);
  return emulation::viewer_frame(nlohmann::json::parse(std::ifstream(description)));
}

std::vector<double> colours(const launcher::RgbaImage& image) {
  std::vector<double> channels;
  for (std::size_t i = 0; i < image.rgba.size(); ++i)
    if (i % 4 != 3) channels.push_back(image.rgba[i]);
  return channels;
}

constexpr emulation::Rounding bytes = emulation::normalised(8, 8);

void expect_judged_well(const emulation::Image& meant, const launcher::RgbaImage& image,
                        const std::string& what) {
  const emulation::Verdict verdict = emulation::judge(meant, colours(image), 3, emulation::ray_termination);
  fmt::print("{}: RMS {:.2e}, max {:.2e}, beyond the bounds by {:.2e}, RMS of the bounds {:.2e}\n", what,
             verdict.rms, verdict.max, verdict.beyond, verdict.width);
  EXPECT_EQ(verdict.outside, 0) << what;
}

/// Replays with `nodes` ranks; 0: in the player's process.
void expect_substituted(const Trace& trace, int nodes) {
  const Folder folder;
  const fs::path report = folder.path() / "report.json";
  const std::string ranks = nodes > 0 ? "-n " + std::to_string(nodes) : "";
  ASSERT_EQ(understudy("replay " + ranks + " --report " + report.string() + " --save-frames " +
                       folder.path().string() + " " + trace_file(trace.name).string()),
            0);
  const auto figures = nlohmann::json::parse(std::ifstream(report));
  EXPECT_EQ(figures.at("frames_substituted"), trace.substituted ? trace.frames : 0) << figures.dump(1);
  EXPECT_EQ(figures.at("frames_left"), trace.substituted ? 0 : trace.frames);
  for (int frame = 1; frame <= trace.frames; ++frame) {
    const launcher::RgbaImage shown = saved(folder.path(), frame);
    if (trace.way.empty()) {
      EXPECT_GE(launcher::difference(shown, expected(trace.name, frame)).psnr(), 35) << "frame " << frame;
    } else {
      const emulation::Rounding none;
      expect_judged_well(emulation::draw(meant(trace, frame, folder.path()), emulation::ours, none,
                                         emulation::presented(bytes)),
                         shown, fmt::format("{}, frame {}, {} ranks", trace.name, frame, nodes));
    }
  }
}

TEST_P(Kept, TracesAreSubstitutedInThePlayer) {
  expect_substituted(GetParam(), 0);
}

TEST_P(Kept, TracesAreSubstitutedOnRanks) {
  if (!fs::exists(fs::path(PROGRAMS) / "understudy-node"))
    GTEST_SKIP() << "understudy-node is not built: no MPI";
  for (const int nodes : {1, 2, 4}) expect_substituted(GetParam(), nodes);
}

TEST_P(Kept, NativeImagesAreWhatTheViewerDescribes) {
  if (GetParam().way.empty()) GTEST_SKIP() << "its volume is not kept";
  const Folder folder;
  for (int frame = 1; frame <= GetParam().frames; ++frame)
    expect_judged_well(emulation::draw(meant(GetParam(), frame, folder.path()), emulation::drivers, bytes, {}),
                       expected(GetParam().name, frame), fmt::format("{}, frame {}", GetParam().name, frame));
}

INSTANTIATE_TEST_SUITE_P(, Kept, testing::ValuesIn(traces()), [](const auto& info) { return info.param.name; });

std::vector<std::byte> contents(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::vector<char> text{std::istreambuf_iterator<char>(file), {}};
  const auto* first = reinterpret_cast<const std::byte*>(text.data());
  return {first, first + text.size()};
}

void write(const fs::path& path, std::span<const std::byte> bytes) {
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
}

TEST(CutOff, TracesPlayToTheirLastWholeBlock) {
  const Folder folder;
  const fs::path whole = trace_file("rgba");
  const auto bytes = contents(whole);
  std::vector<std::uint64_t> starts;
  {
    spu::TraceReader reader(whole);
    while (const auto block = reader.next()) starts.push_back(block->file_offset);
  }
  constexpr int frames = 3;
  ASSERT_GE(starts.size(), std::size_t(frames));
  starts.push_back(bytes.size());
  spu::Options options;
  options.speed_guard = false;
  options.chain = "driver";
  for (std::size_t block = 0; block + 1 < starts.size(); ++block) {
    // Within the block's header, within its data, and one byte before its end.
    for (const std::uint64_t end :
         {starts[block] + 5, (starts[block] + starts[block + 1]) / 2, starts[block + 1] - 1}) {
      const fs::path cut = folder.path() / "cut.ust";
      write(cut, std::span(bytes).first(end));
      testing::internal::CaptureStderr();
      const launcher::Played played = launcher::play({.trace = cut}, options);
      EXPECT_THAT(testing::internal::GetCapturedStderr(), testing::HasSubstr("was cut off"));
      EXPECT_EQ(played.frames, std::min<std::uint64_t>(block, frames)) << "cut at byte " << end;
      if (takes_all_cases() || end == starts[block] + 5) {
        EXPECT_EQ(understudy("replay --native " + cut.string()), 0);
      }
    }
  }
}

TEST(Damaged, TracesEndPlayingWithBlockAndOffset) {
  const Folder folder;
  auto bytes = contents(trace_file("rgba"));
  bytes[bytes.size() / 2] ^= std::byte(0xff);
  const fs::path damaged = folder.path() / "damaged.ust";
  write(damaged, bytes);
  EXPECT_EQ(understudy("replay --native " + damaged.string()), 1);
  spu::Options options;
  options.speed_guard = false;
  options.chain = "driver";
  try {
    launcher::play({.trace = damaged}, options);
    FAIL() << "damage was not noticed";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), testing::ContainsRegex("block [0-9]+ at byte [0-9]+"));
  }
}

TEST(Ranges, OfFramesArePlayedToTheirEndAndSavedFromTheirBegin) {
  const Folder folder;
  ASSERT_EQ(understudy("replay --native --frames 2-2 --save-frames " + folder.path().string() + " --report " +
                       (folder.path() / "report.json").string() + " " + trace_file("core").string()),
            0);
  EXPECT_FALSE(fs::exists(folder.path() / "frame_0001.png"));
  EXPECT_FALSE(fs::exists(folder.path() / "frame_0003.png"));
  EXPECT_GE(launcher::difference(saved(folder.path(), 2), expected("core", 2)).psnr(), 50);
  const auto figures = nlohmann::json::parse(std::ifstream(folder.path() / "report.json"));
  EXPECT_EQ(figures.at("frames"), 1) << figures.dump(1);
  EXPECT_THROW(launcher::parse_frame_range("3-2"), std::runtime_error);
  EXPECT_THROW(launcher::parse_frame_range("0-2"), std::runtime_error);
  EXPECT_THROW(launcher::parse_frame_range("a"), std::runtime_error);
  EXPECT_EQ(launcher::parse_frame_range("4").last, 4U);
  EXPECT_TRUE(launcher::parse_frame_range("4-").contains(1'000'000));
}

/// Frames that depend on earlier drawing, uploads and compiled lists.
TEST(Trimmed, TracesShowTheSameFramesBitForBit) {
  const fs::path trace = trace_of_this_test();
  LiveApplication application(trace);
  application.add(compatibility_context(1));
  const auto& gl = application.gl();
  std::array<GLuint, 3> textures{};
  GLuint framebuffer = 0;
  GLuint buffer = 0;
  gl.GenTextures(3, textures.data());
  gl.GenFramebuffers(1, &framebuffer);
  gl.GenBuffers(1, &buffer);
  const GLuint list = gl.GenLists(2);
  std::vector<std::uint8_t> texels(16 * 16 * 4);
  for (int frame = 0; frame < 4; ++frame) {
    gl.ClearColor(0.1F, 0, 0.1F, 1);
    gl.Clear(GL_COLOR_BUFFER_BIT);
    for (std::size_t i = 0; i < texels.size(); ++i) texels[i] = std::uint8_t(i * std::size_t(frame + 3));
    // Replaced completely in every frame.
    gl.BindTexture(GL_TEXTURE_2D, textures[0]);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, 16, 16, 0, GL_RGBA, GL_UNSIGNED_BYTE, texels.data());
    // Made once, and changed in a different place by every frame.
    gl.BindTexture(GL_TEXTURE_2D, textures[1]);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    if (frame == 0)
      gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, 16, 16, 0, GL_RGBA, GL_UNSIGNED_BYTE, texels.data());
    gl.TexSubImage2D(GL_TEXTURE_2D, 0, 4 * frame, 0, 4, 8, GL_RGBA, GL_UNSIGNED_BYTE, texels.data());
    // Drawn into by every frame, cleared only in the first.
    gl.BindTexture(GL_TEXTURE_2D, textures[2]);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    if (frame == 0) gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, 16, 16, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
    gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, textures[2], 0);
    gl.Viewport(0, 0, 16, 16);
    if (frame == 0) gl.Clear(GL_COLOR_BUFFER_BIT);
    gl.Disable(GL_TEXTURE_2D);
    gl.Color3f(0.2F + 0.2F * float(frame), 1, 0.3F);
    gl.Rectf(-1 + 0.5F * float(frame), -1, -0.6F + 0.5F * float(frame), 1);
    gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
    gl.Viewport(0, 0, extent.width, extent.height);
    // A list that draws and changes the current colour.
    if (frame == 0) {
      gl.NewList(list, GL_COMPILE);
      gl.Begin(GL_TRIANGLES);
      gl.Vertex2f(0.6F, -1);
      gl.Color3f(1, 0.8F, 0.1F);
      gl.Vertex2f(1, -1);
      gl.Vertex2f(1, -0.5F);
      gl.End();
      gl.EndList();
      gl.NewList(list + 1, GL_COMPILE);
      gl.CallList(list);
      gl.Translatef(0, 0.1F, 0);
      gl.EndList();
    }
    gl.CallList(list + 1);
    gl.Rectf(0.6F, 0.6F, 0.9F, 0.9F);
    gl.Enable(GL_TEXTURE_2D);
    gl.Color3f(1, 1, 1);
    for (int i = 0; i < 3; ++i) {
      gl.BindTexture(GL_TEXTURE_2D, textures[std::size_t(i)]);
      gl.Begin(GL_QUADS);
      for (const auto& [s, t] : {std::pair(0.0F, 0.0F), {1.0F, 0.0F}, {1.0F, 1.0F}, {0.0F, 1.0F}}) {
        gl.TexCoord2f(s, t);
        gl.Vertex2f(-0.9F + 0.5F * float(i) + 0.4F * s, -0.8F + 0.8F * t);
      }
      gl.End();
    }
    application.show();
  }
  application.end();
  const fs::path shorter = fs::path(trace).replace_extension(".short.ust");
  launcher::trim({.trace = trace, .frames = {2, 3}, .out = shorter});
  const Played played = play_back(shorter);
  EXPECT_THAT(played.errors, IsEmpty());
  ASSERT_EQ(played.frames.size(), 2U);
  EXPECT_TRUE(played.frames[0] == application.shown()[1]);
  EXPECT_TRUE(played.frames[1] == application.shown()[2]);
  fs::remove(shorter);
}

TEST(Trimmed, TracesOfTheViewerAreShorterAndShowTheSame) {
  const Folder folder;
  for (const Trace& trace : traces()) {
    const fs::path shorter = folder.path() / "short.ust";
    const auto last = std::uint64_t(trace.frames);
    launcher::trim({.trace = trace_file(trace.name), .frames = {last, last}, .out = shorter});
    EXPECT_LE(fs::file_size(shorter), fs::file_size(trace_file(trace.name))) << trace.name;
    const Played whole = play_back(trace_file(trace.name));
    const Played part = play_back(shorter);
    ASSERT_EQ(part.frames.size(), 1U);
    EXPECT_TRUE(part.frames[0] == whole.frames.back()) << trace.name;
  }
}

}  // namespace
}  // namespace understudy::replay_test
