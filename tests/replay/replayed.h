// SPDX-License-Identifier: Apache-2.0
// A test that draws with a recorded program, and expects its trace to draw the same images.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "live_application.h"

namespace understudy::replay_test {

class Replayed : public testing::Test {
 protected:
  explicit Replayed(const spu::RecordedContext& context = compatibility_context(1))
      : trace(trace_of_this_test()), application(trace) {
    application.add(context);
  }

  const spu::DispatchTable& gl() const { return application.gl(); }

  /// Shows the last frame, ends the application, and plays its trace.
  void expect_same_images() {
    application.show();
    application.end();
    const Pixels& last = application.shown().back();
    EXPECT_GE(std::set<std::uint8_t>(last.begin(), last.end()).size(), 3U) << "next to nothing was drawn";
    for (const char* chain : {"driver", "pack unpack driver"}) {
      const Played played = play_back(trace, chain);
      EXPECT_THAT(played.errors, testing::IsEmpty());
      EXPECT_TRUE(played.frames == application.shown()) << "other images on the chain " << chain;
    }
  }

  std::filesystem::path trace;
  LiveApplication application;
};

}  // namespace understudy::replay_test
