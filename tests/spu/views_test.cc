// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "spu/volume/views/drawn_views.h"
#include "spu/volume/views/shown_windows.h"

namespace understudy::spu {
namespace {

constexpr View one{.texture = 1, .window = 7, .viewport = {0, 0, 9, 9}};
constexpr View other{.texture = 1, .window = 7, .viewport = {9, 0, 9, 9}};

TEST(DrawnViews, StandAloneFromTheSecondFrameOn) {
  DrawnViews views;
  EXPECT_FALSE(views.stands_alone(one, 1)) << "not drawn";
  views.drawn(one, 1);
  EXPECT_FALSE(views.stands_alone(one, 1)) << "not drawn in the frame before";
  for (std::uint64_t frame = 2; frame < 5; ++frame) {
    views.drawn(one, frame);
    views.drawn(other, frame);
    EXPECT_TRUE(views.stands_alone(one, frame)) << frame;
    EXPECT_EQ(views.stands_alone(other, frame), frame > 2) << frame;
  }
  views.drawn(one, 6);
  EXPECT_FALSE(views.stands_alone(one, 6)) << "frame 5 is missing";
}

TEST(DrawnViews, DoNotStandAloneIfDrawnTwiceInAFrame) {
  DrawnViews views;
  std::uint64_t frame = 1;
  for (; frame < 5; ++frame)
    for (int eye = 0; eye < 2; ++eye) {
      views.drawn(one, frame);
      EXPECT_FALSE(views.stands_alone(one, frame)) << frame;
    }
  const std::uint64_t last_twice = frame - 1;
  for (; frame < last_twice + 200; ++frame) {
    views.drawn(one, frame);
    if (views.stands_alone(one, frame)) break;
  }
  EXPECT_GT(frame, last_twice + 10);
  EXPECT_LT(frame, last_twice + 100) << "some day it is believed to be one view";
}

TEST(DrawnViews, DoNotStandAloneWhereTheApplicationDrewTheVolumeToo) {
  DrawnViews views;
  views.draws_into(one.window);
  for (std::uint64_t frame = 1; frame < 4; ++frame) views.drawn(one, frame);
  EXPECT_TRUE(views.stands_alone(one, 3));
  views.drawn_somewhere(one.texture + 1, 3);
  EXPECT_TRUE(views.stands_alone(one, 3)) << "another volume";
  views.drawn_somewhere(one.texture, 3);
  EXPECT_FALSE(views.stands_alone(one, 3));
  views.drawn(one, 4);
  EXPECT_FALSE(views.stands_alone(one, 4)) << "that may have been this view";
  views.drawn(one, 5);
  EXPECT_TRUE(views.stands_alone(one, 5));
}

TEST(DrawnViews, NeverStandAloneWithoutEndsOfFrames) {
  DrawnViews views;
  for (int draw = 0; draw < 5; ++draw) {
    views.drawn(one, 0);
    EXPECT_FALSE(views.stands_alone(one, 0));
  }
}

TEST(ShownWindows, CountFramesOfEachWindow) {
  ShownWindows windows;
  EXPECT_EQ(windows.frame(7), 0U);
  EXPECT_FALSE(windows.can_be_redrawn(7));
  windows.frame_ended(7, true);
  windows.frame_ended(8, false);
  const std::uint64_t frame = windows.frame(7);
  windows.frame_ended(8, false);
  EXPECT_EQ(windows.frame(7), frame);
  windows.frame_ended(7, true);
  EXPECT_EQ(windows.frame(7), frame + 1);
  EXPECT_TRUE(windows.can_be_redrawn(7));
  EXPECT_FALSE(windows.can_be_redrawn(8));
  windows.frame_ended(0, true);
  EXPECT_EQ(windows.frame(0), 0U);
}

TEST(ShownWindows, ContinueNoFramesOfAWindowThatWasForgotten) {
  ShownWindows windows;
  windows.frame_ended(7, true);
  windows.frame_ended(7, true);
  const std::uint64_t frame = windows.frame(7);
  for (std::uintptr_t window = 100; window < 300; ++window) windows.frame_ended(window, true);
  EXPECT_EQ(windows.frame(7), 0U);
  windows.frame_ended(7, true);
  EXPECT_GT(windows.frame(7), frame + 1);
}

TEST(ShownWindows, AreLateUntilEveryViewIsRight) {
  ShownWindows windows;
  windows.frame_ended(7, true);
  windows.shown(one, true);
  windows.shown(other, true);
  EXPECT_EQ(windows.frame_ended(8, true), LateViews::none) << "another window";
  EXPECT_EQ(windows.frame_ended(7, true), LateViews::of_this_frame);
  windows.shown(one, false);
  EXPECT_EQ(windows.frame_ended(7, true), LateViews::of_earlier_frames) << "the other view was not drawn";
  windows.shown(one, true);
  EXPECT_EQ(windows.frame_ended(7, true), LateViews::of_earlier_frames);
  windows.shown(one, false);
  windows.shown(other, false);
  EXPECT_EQ(windows.frame_ended(7, true), LateViews::none);
}

TEST(ShownWindows, ForgetViewsThatAreNotDrawnWhenAsked) {
  ShownWindows windows;
  windows.frame_ended(7, true);
  windows.shown(one, true);
  windows.frame_ended(7, true);
  EXPECT_EQ(windows.frame_ended(7, true), LateViews::of_earlier_frames);
  windows.asked(7);
  EXPECT_EQ(windows.frame_ended(7, true), LateViews::of_earlier_frames) << "it may have been under way";
  windows.asked(7);
  EXPECT_EQ(windows.frame_ended(7, true), LateViews::none) << "the volume is no longer drawn";
}

}  // namespace
}  // namespace understudy::spu
