// SPDX-License-Identifier: Apache-2.0
// Viewers with remote OpenGL that show what they draw without a swap, write text with the X server's fonts, use
// both window systems, or call unsupported functions.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "tests/clients/remote_viewer.h"

namespace clients {
namespace {

using Colour = std::array<int, 3>;
constexpr Colour green{0, 255, 0};
constexpr Colour blue{0, 0, 255};
/// Width and height of the programs' windows, which lie in the upper left corner.
constexpr int window_size = 128;

class RemoteFront : public RemoteViewer {
 protected:
  void SetUp() override { start_display({Need::x_server, Need::imagemagick}); }

  Words remotely() const { return under({"--remote", "--report", file("report.json")}) + without_opengl(); }

  static Colour at(const viewer_test::Image& image, int x, int y) {
    const std::size_t first = (std::size_t(y) * std::size_t(image.width) + std::size_t(x)) * 3;
    return {image.rgb[first], image.rgb[first + 1], image.rgb[first + 2]};
  }

  /// Whether the window's left half is `left` everywhere, and its right half `right`.
  static bool has_halves(const viewer_test::Image& image, Colour left, Colour right) {
    for (int y = 0; y < window_size; ++y)
      for (int x = 0; x < window_size; ++x)
        if (at(image, x, y) != (x < window_size / 2 ? left : right)) return false;
    return true;
  }

  /// What the screen shows some time after the program has drawn everything; then ends the program.
  viewer_test::Image rests_at(const Words& command, const std::function<bool(const viewer_test::Image&)>& as) {
    Child child(command_of(command, on_display()), file(""));
    EXPECT_TRUE(comes_true([&] { return !child.running() || child.out().find("drawn") != std::string::npos; }));
    viewer_test::Image last;
    EXPECT_TRUE(comes_true([&] {
      last = screen().value_or(last);
      return !child.running() || (!last.rgb.empty() && as(last));
    })) << child.err();
    EXPECT_TRUE(child.running()) << child.out() << child.err();
    // Nothing else may be shown afterwards.
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    last = screen().value_or(last);
    child.signal(SIGTERM);
    EXPECT_EQ(child.finish().status, 128 + SIGTERM);
    return last;
  }

  void expect_halves(const std::string& way, Colour left, Colour right) {
    const auto as_drawn = [&](const viewer_test::Image& image) { return has_halves(image, left, right); };
    EXPECT_TRUE(as_drawn(rests_at(remotely() + Words{DRAWS_IN_FRONT, way}, as_drawn))) << way;
  }
  double frames() const { return json("report.json").at("server_connection").at("frames").get<double>(); }

  /// Expects the same glyphs as with a driver's GLX.
  void expect_same_text(const std::string& font, const std::string& first, const std::string& count) {
    const Words writes = {WRITES_TEXT, font, first, count};
    const auto has_text = [](const viewer_test::Image& image) {
      return std::count(image.rgb.begin(), image.rgb.end(), 128) > 0;
    };
    const viewer_test::Image local = rests_at(under() + writes, has_text);
    std::size_t lit = 0;
    for (int y = 0; y < window_size; ++y)
      for (int x = 0; x < window_size; ++x) lit += at(local, x, y) == Colour{255, 255, 0} ? 1 : 0;
    EXPECT_GT(lit, 400U) << font;
    const viewer_test::Image remote = rests_at(remotely() + writes, has_text);
    EXPECT_TRUE(remote.rgb == local.rgb) << font;
  }
};

TEST_F(RemoteFront, AWindowWithOneBufferIsShownByFlush) {
  expect_halves("one_buffer", green, blue);
  EXPECT_EQ(frames(), 1);
  EXPECT_EQ(leftovers(), "");
}

TEST_F(RemoteFront, FlushesDoNotWaitForImages) {
  expect_halves("many_flushes", green, blue);
  EXPECT_GE(frames(), 2);
  EXPECT_LT(frames(), 2048) << "of 4096 flushes";
}

TEST_F(RemoteFront, TheFrontBufferIsShownWithoutASwap) {
  for (const char* way : {"flushed", "finished", "waited_for", "released"}) {
    expect_halves(way, green, blue);
    EXPECT_EQ(frames(), 2) << way;
  }
}

TEST_F(RemoteFront, WhatIsThenDrawnIntoTheBackBufferIsNotShown) {
  expect_halves("drawn_over", green, blue);
  EXPECT_EQ(frames(), 2);
}

TEST_F(RemoteFront, ADisplayListMayChooseTheFrontBuffer) {
  expect_halves("by_list", green, blue);
  EXPECT_EQ(frames(), 2);
}

TEST_F(RemoteFront, HalfAFrameIsNotShownByFlush) {
  expect_halves("back_buffer", blue, blue);
  EXPECT_EQ(frames(), 5) << "its swaps";
}

TEST_F(RemoteFront, TextIsThatOfTheXServersFonts) {
  // Existing characters, missing ones, and glyphs that extend beyond their origin.
  expect_same_text("fixed", "33", "80");
  expect_same_text("6x13", "210", "46");
  expect_same_text("cursor", "0", "40");
}

TEST_F(RemoteFront, ASpaceMovesOn) {
  // Differs from Mesa's own glXUseXFont, for which a glyph without pixels is an error.
  Child child(command_of(remotely() + Words{WRITES_TEXT, "fixed", "32", "1"}, on_display()), file(""));
  EXPECT_TRUE(comes_true([&] { return !child.running() || child.out().find("drawn") != std::string::npos; }));
  EXPECT_NE(child.out().find("moves by 6.00"), std::string::npos) << child.out() << child.err();
}

TEST_F(RemoteFront, GlxAndEglAnswerEachForItself) {
  const Outcome outcome = run_well(remotely() + Words{MIXES_GLX_AND_EGL}, on_display());
  EXPECT_EQ(outcome.out, "all right\n") << outcome.err;
}

TEST_F(RemoteFront, WhatIsLeftOutIsSaidOnceAndDoesNoHarm) {
  const Outcome outcome = run_well(remotely() + Words{LEAVES_OUT}, on_display());
  const std::string said = "the viewer calls glXCopyContext, which run --remote does not offer";
  const std::size_t first = outcome.err.find(said);
  ASSERT_NE(first, std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find(said, first + 1), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.out.find("told 0 times"), std::string::npos) << outcome.out;
  EXPECT_EQ(frames(), 1);
}

}  // namespace
}  // namespace clients
