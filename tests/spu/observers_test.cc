// SPDX-License-Identifier: Apache-2.0
// The units that observe every call, perf and print, above a mock driver.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

#include "dispatch/call_words.h"
#include "spu/registry/assemble.h"
#include "spu/report/counters.h"
#include "spu/track/share_group.h"
#include "tests/spu/mock_driver.h"

namespace understudy::spu {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::install;
using testing::installed;
using testing::MockCall;
using testing::MockDriver;

class Observers : public ::testing::Test {
 protected:
  // A process has one table per file, so every test has files of its own.
  Observers() : folder_(fs::path(::testing::TempDir()) / ("observers-" + name())) {
    fs::create_directories(folder_);
  }
  ~Observers() override {
    chain_.reset();
    fs::remove_all(folder_);
  }

  static std::string name() { return ::testing::UnitTest::GetInstance()->current_test_info()->name(); }

  Chain& use(const std::string& text) {
    chain_ = std::make_unique<Chain>(mock_.table(), std::make_shared<ShareGroup>(), install);
    EXPECT_EQ(assemble(*chain_, text, nullptr).value_or(""), "");
    chain_->make_current();
    return *chain_;
  }
  std::string file(const std::string& file_name) const { return folder_ / file_name; }
  std::string contents(const std::string& file_name) const {
    std::ifstream stream(file(file_name));
    return {std::istreambuf_iterator<char>(stream), {}};
  }

  const fs::path folder_;
  MockDriver mock_;
  std::unique_ptr<Chain> chain_;
};

TEST_F(Observers, HandOnEveryCallWithItsArgumentsAndItsResult) {
  use("perf(file=" + file("p.txt") + ") print(file=" + file("t.txt") + ") driver");
  mock_.answers(CallId::GetUniformLocation, std::uint64_t(-1));
  mock_.answers(CallId::IsTexture, GL_TRUE);
  installed().Vertex3d(1, -2, 0.5);
  installed().TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_BASE_LEVEL, -3);
  EXPECT_EQ(installed().GetUniformLocation(5, "x"), -1);
  EXPECT_EQ(installed().IsTexture(4), GL_TRUE);
  ASSERT_EQ(mock_.calls().size(), 4U);
  EXPECT_EQ(mock_.calls()[0].words[2], 0x3fe0000000000000U);
  EXPECT_EQ(mock_.calls()[1],
            (MockCall{CallId::TexParameteri, {GL_TEXTURE_2D, GL_TEXTURE_BASE_LEVEL, std::uint64_t(-3)}}));
}

// Passes every command of the registry through both units.
TEST_F(Observers, ChangeNoCall) {
  use("perf(file=" + file("p.txt") + ") print(file=" + file("t.txt") + ", calls=glNone) driver");
  const std::array<std::uint64_t, max_parameters> zeros{};
  for (std::size_t i = 0; i < call_count; ++i) {
    mock_.forget();
    mock_.answers(CallId(i), 1);
    EXPECT_EQ(
        invoke(installed(), CallId(i), zeros.data()),
        call_shape(CallId(i)).result == ValueType::none && call_shape(CallId(i)).result_pointer == 0 ? 0U : 1U)
        << call_name(CallId(i));
    ASSERT_THAT(mock_.called(), ElementsAre(CallId(i)));
  }
}

TEST_F(Observers, PerfCountsCallsBytesAndFrames) {
  Chain& chain = use("perf(file=" + file("p.json") + ") driver");
  const std::array<GLfloat, 16> matrix{};
  const std::array<std::byte, 256> pixels{};
  for (int frame = 0; frame < 3; ++frame) {
    for (int i = 0; i <= frame; ++i) installed().LoadMatrixf(matrix.data());
    installed().TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA, 8, 8, 0, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
    chain.frame_ended(FrameEnd::wait);
    chain.frame_ended(FrameEnd::swap);
  }
  installed().Finish();
  EXPECT_TRUE(fs::exists(file("p.json"))) << "a viewer that is killed leaves its figures";
  chain.abandon();
  const auto json = nlohmann::json::parse(contents("p.json"));
  EXPECT_EQ(json["calls"]["glLoadMatrixf"]["calls"], 6);
  EXPECT_EQ(json["calls"]["glLoadMatrixf"]["bytes"], 6 * 64);
  EXPECT_EQ(json["calls"]["glTexImage2D"]["bytes"], 3 * 256);
  EXPECT_EQ(json["calls"]["glFinish"]["calls"], 1);
  EXPECT_EQ(json["calls"].size(), 3U) << "calls that were not made are not listed";
  EXPECT_EQ(json["all"]["calls"], 10);
  EXPECT_EQ(json["all"]["round_trips"], 0);
  EXPECT_EQ(json["frames"], 3);
  EXPECT_EQ(json["frame_mean"]["calls"], 3);
  EXPECT_EQ(json["frame_largest"]["calls"], 4);
  EXPECT_EQ(json["frame_largest"]["bytes"], 3 * 64 + 256);
  EXPECT_GE(json["all"]["time_ms"], 0);
}

TEST_F(Observers, PerfCountsRoundTripsWithTheCallsThatWait) {
  Chain& chain = use("perf(file=" + file("p.json") + ") driver");
  mock_.slots().GetError = []() -> GLenum {
    process_counters().remote.round_trips += 2;
    return GL_NO_ERROR;
  };
  chain.refill();
  installed().Finish();
  for (int i = 0; i < 3; ++i) installed().GetError();
  chain.frame_ended(FrameEnd::swap);
  chain.abandon();
  const auto json = nlohmann::json::parse(contents("p.json"));
  EXPECT_EQ(json["calls"]["glGetError"]["round_trips"], 6);
  EXPECT_EQ(json["calls"]["glFinish"]["round_trips"], 0);
  EXPECT_EQ(json["frame_mean"]["round_trips"], 6);
}

TEST_F(Observers, PerfSumsOverTheContextsOfItsFile) {
  const std::string text = "perf(file=" + file("p.json") + ") driver";
  Chain& first = use(text);
  installed().Finish();
  {
    Chain second(mock_.table(), std::make_shared<ShareGroup>(), install);
    ASSERT_EQ(assemble(second, text, nullptr).value_or(""), "");
    second.make_current();
    installed().Finish();
    installed().Flush();
    second.process_ends();
    EXPECT_EQ(nlohmann::json::parse(contents("p.json"))["all"]["calls"], 3);
  }
  first.make_current();
  installed().Flush();
  first.process_ends();
  const auto json = nlohmann::json::parse(contents("p.json"));
  EXPECT_EQ(json["calls"]["glFinish"]["calls"], 2);
  EXPECT_EQ(json["calls"]["glFlush"]["calls"], 2) << "the second context's are kept";
}

TEST_F(Observers, PerfPrintsATableAtTheEndWithoutAFile) {
  ::testing::internal::CaptureStderr();
  Chain& chain = use("perf driver");
  installed().Finish();
  installed().Finish();
  chain.frame_ended(FrameEnd::swap);
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "") << "not before the end";
  ::testing::internal::CaptureStderr();
  chain.abandon();
  chain_.reset();
  const std::string table = ::testing::internal::GetCapturedStderr();
  EXPECT_THAT(table, HasSubstr("glFinish                                            2"));
  EXPECT_THAT(table, HasSubstr("1 frames of "));
  EXPECT_EQ(table.find("glFinish"), table.rfind("glFinish")) << "once";
}

TEST_F(Observers, PerfSaysOnceThatItCannotWrite) {
  ::testing::internal::CaptureStderr();
  Chain& chain = use("perf(file=" + file("none/p.txt") + ") driver");
  installed().Finish();
  chain.process_ends();
  installed().Finish();
  chain.process_ends();
  const std::string said = ::testing::internal::GetCapturedStderr();
  EXPECT_THAT(said, HasSubstr("none/p.txt: No such file or directory; name another file"));
  EXPECT_EQ(said.find("understudy"), said.rfind("understudy"));
}

TEST_F(Observers, PrintWritesALineACall) {
  Chain& chain = use("print(file=" + file("t.txt") + ") driver");
  mock_.slots().GenTextures = [](GLsizei, GLuint* names) { *names = 12; };
  chain.refill();
  GLuint name = 0;
  installed().GenTextures(1, &name);
  installed().BindTexture(GL_TEXTURE_3D, name);
  EXPECT_EQ(installed().GetError(), 0U);
  chain.frame_ended(FrameEnd::swap);
  EXPECT_EQ(contents("t.txt"),
            "glGenTextures(n = 1, textures = {12})\n"
            "glBindTexture(target = GL_TEXTURE_3D, texture = 12)\n"
            "glGetError() = GL_NO_ERROR\n"
            "// frame 1 ends\n");
}

TEST_F(Observers, PrintTakesTheFramesAndCallsThatWereAskedFor) {
  Chain& chain = use("print(file=" + file("t.txt") + ", frames=2-3, calls=\"glTex* *Clear\") driver");
  for (int frame = 1; frame <= 4; ++frame) {
    const bool printed = frame == 2 || frame == 3;
    EXPECT_EQ(installed().Clear != mock_.table().Clear, printed) << "what is not printed costs nothing";
    EXPECT_EQ(installed().Finish, mock_.table().Finish);
    installed().Clear(GL_COLOR_BUFFER_BIT);
    installed().Finish();
    installed().TexCoord1f(float(frame));
    chain.frame_ended(FrameEnd::swap);
  }
  EXPECT_EQ(contents("t.txt"),
            "glClear(mask = GL_COLOR_BUFFER_BIT)\nglTexCoord1f(s = 2)\n// frame 2 ends\n"
            "glClear(mask = GL_COLOR_BUFFER_BIT)\nglTexCoord1f(s = 3)\n// frame 3 ends\n");
  EXPECT_EQ(mock_.calls().size(), 12U);
}

TEST_F(Observers, PrintTellsContextsApart) {
  const std::string text = "print(file=" + file("t.txt") + ") driver";
  use(text);
  Chain second(mock_.table(), std::make_shared<ShareGroup>(), install);
  ASSERT_EQ(assemble(second, text, nullptr).value_or(""), "");
  installed().Finish();
  second.make_current();
  installed().Flush();
  EXPECT_EQ(contents("t.txt"), "glFinish()\n[context 2] glFlush()\n");
}

TEST_F(Observers, PrintSaysWhenItCannotWrite) {
  ::testing::internal::CaptureStderr();
  use("print(file=" + file("none/t.txt") + ") driver");
  installed().Finish();
  const std::string said = ::testing::internal::GetCapturedStderr();
  EXPECT_THAT(said, HasSubstr("cannot write " + file("none/t.txt") + ": No such file or directory"));
  EXPECT_THAT(said, HasSubstr("glFinish()\n"));
}

}  // namespace
}  // namespace understudy::spu
