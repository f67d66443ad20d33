// SPDX-License-Identifier: Apache-2.0
// Images that are composited while they are drawn.
#include "compositor/node/overlap.h"

#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "compositor/exchange/thread_communicator.h"
#include "compositor/rendered.h"
#include "tests/compositor/node_group.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/request.h"

namespace understudy::compositor {
namespace {

using namespace testing;
using volume::Image;
using volume::Rect;

TEST(Bands, CoverARectangleFromTheBottomUp) {
  for (const Rect& rect : {Rect{0, 0, 1, 1}, Rect{-7, 5, 640, 480}, Rect{3, 3, 100000, 1},
                           Rect{0, 0, 16, 65536}, Rect{1, 1, 4096, 4096}, Rect{0, 9, 1000, 131}}) {
    const std::vector<Rect> bands = bands_of(rect);
    ASSERT_FALSE(bands.empty());
    EXPECT_LE(bands.size(), 8U);
    int y = rect.y;
    for (const Rect& band : bands) {
      EXPECT_EQ(band.x, rect.x);
      EXPECT_EQ(band.width, rect.width);
      EXPECT_EQ(band.y, y);
      EXPECT_EQ((band.y - rect.y) % 16, 0);
      EXPECT_GT(band.height, 0);
      y += band.height;
    }
    EXPECT_EQ(y, rect.y + rect.height);
  }
  EXPECT_EQ(bands_of({0, 0, 255, 255}).size(), 1U) << "too few pixels for more";
  EXPECT_EQ(bands_of({0, 0, 1024, 1024}).size(), 8U);
  EXPECT_EQ(bands_of({}).size(), 1U) << "all ranks still agree on an empty image";
}

TEST_F(NodeGroupTest, ImagesAreTheSameWhenTheyAreCompositedWhileTheyAreDrawn) {
  const Texture texture = some_texture();
  std::vector<volume::RenderRequest> requests;
  for (const volume::Operator op : {volume::Operator::over, volume::Operator::max, volume::Operator::min,
                                    volume::Operator::add, volume::Operator::first_hit}) {
    requests.push_back(
        volume::testing::request_for(texture, volume::testing::usual_camera(640, 480), 640, 480, 50));
    requests.back().op = op;
  }
  requests.push_back(requests.front());
  requests.back().optimizations.footprints = false;
  requests.push_back(requests.front());
  requests.back().window = {100, 50, 480, 400};
  for (const int ranks : {2, 3, 5}) {
    std::vector<Image> images;
    std::vector<volume::FrameCounts> counts;
    for (const Overlap overlap : {Overlap::off, Overlap::on}) {
      const Group& group =
          start(ranks, limits::stall_patience, {}, {Algorithm::direct_send, {}, Gather::direct, overlap});
      const auto linked = connect();
      upload(*linked, texture);
      for (std::size_t i = 0; i < requests.size(); ++i) {
        SCOPED_TRACE(::testing::Message() << ranks << " ranks, request " << i);
        const Rendered rendered = linked->render(requests[i]);
        const Image image = whole_image(rendered, requests[i]);
        if (overlap == Overlap::off) {
          images.push_back(image);
          counts.push_back(rendered.counts);
          continue;
        }
        EXPECT_EQ(image.rgba, images[i].rgba);
        EXPECT_EQ(rendered.counts.samples, counts[i].samples);
        EXPECT_EQ(rendered.counts.rays, counts[i].rays);
        EXPECT_EQ(rendered.counts.blocks, counts[i].blocks);
        EXPECT_EQ(rendered.counts.blocks_empty, counts[i].blocks_empty);
        EXPECT_GT(rendered.counts.messages, counts[i].messages) << "for every band";
        // An image that all ranks refuse leaves the group in step.
        volume::RenderRequest wrong = requests[i];
        wrong.version = 99;
        EXPECT_THROW(linked->render(wrong), RequestRefused);
      }
      launcher_->ask([](Broker& b) { b.dismiss_node_group(); });
      EXPECT_TRUE(eventually([&] { return group.ended(); }));
    }
  }
}

TEST(Overlap, ARankThatCannotGoOnEndsTheImageOnAllRanksAfterTheSameBand) {
  constexpr Rect whole{0, 0, 512, 512};
  constexpr int ranks = 3;
  const std::size_t bands = bands_of(whole).size();
  ASSERT_GT(bands, 3U);
  // Rank 1 fails in each of the bands, cannot begin, or draws all of them.
  for (std::size_t failing = 0; failing <= bands + 1; ++failing) {
    std::vector<float> memory(4 * whole.pixels(), -1);
    run_ranks(ranks, [&](Communicator& communicator) {
      Compositing compositing(communicator, {});
      compositing.prepare();
      const ImageTask task{1, volume::Operator::over, whole, Layout::rgba32f, true, {0, 1, 2}};
      ImageBuffers::Memory mine{memory.size(), {}, {true, false, false}};
      if (communicator.rank() == 0) mine.here = memory;
      const auto make_image = [&](bool may_fail) {
        std::size_t drawn = 0;
        volume::FrameCounts travelled;
        const bool there = draw_and_composite(
            communicator, compositing, task, mine, whole,
            [&](const Rect& band) -> std::optional<Image> {
              if (may_fail && communicator.rank() == 1 && drawn == failing) return std::nullopt;
              ++drawn;
              Image image(band);
              std::ranges::fill(image.rgba, 0.25F * float(communicator.rank() + 1));
              return image;
            },
            travelled);
        if (there) {
          EXPECT_EQ(drawn, bands);
        }
        return there;
      };
      if (failing == bands + 1 && communicator.rank() == 1) {
        refuse_to_draw(communicator);
      } else {
        EXPECT_EQ(make_image(true), failing == bands);
      }
      EXPECT_TRUE(make_image(false)) << "the next image";
    });
    // 1/4 over 1/2 over 3/4.
    constexpr float expected = 0.25F + 0.75F * (0.5F + 0.5F * 0.75F);
    EXPECT_EQ(std::ranges::count(memory, expected), std::ptrdiff_t(memory.size()));
  }
}

TEST(OverlapChoice, IsWhatWasWishedFor) {
  OverlapChoice on(Overlap::on), off(Overlap::off);
  for (int i = 0; i < 200; ++i) {
    EXPECT_TRUE(on.next());
    EXPECT_FALSE(off.next());
    on.took(true, 100, 1, 0);
    off.took(false, 100, 1, 0.9);
  }
}

TEST(OverlapChoice, IsWhatWasFasterForTheSamplesThatWereDrawn) {
  for (const bool overlap_is_faster : {true, false}) {
    OverlapChoice choice(Overlap::automatic);
    EXPECT_FALSE(choice.next()) << "first it must be known what drawing first takes";
    int overlapped = 0;
    for (int i = 0; i < 1000; ++i) {
      const bool overlap = choice.next();
      overlapped += int(overlap);
      // Views with more samples take longer, overlapped or not.
      const std::uint64_t samples = 1000 + 37 * std::uint64_t(i % 11);
      const double seconds = double(samples) * (overlap == overlap_is_faster ? 1e-6 : 1.3e-6);
      choice.took(overlap, samples, seconds, 0.3 * seconds);
    }
    if (overlap_is_faster) {
      EXPECT_GT(overlapped, 970);
    } else {
      EXPECT_LT(overlapped, 30);
    }
    EXPECT_GT(overlapped, 0) << "it is tried";
    EXPECT_LT(overlapped, 1000) << "and so is drawing first, again";
  }
}

TEST(OverlapChoice, IsNotTriedWhereCompositingTakesNextToNoTime) {
  OverlapChoice choice(Overlap::automatic);
  for (int i = 0; i < 300; ++i) {
    ASSERT_FALSE(choice.next());
    choice.took(false, 1000, 1e-3, 1e-5);
  }
}

}  // namespace
}  // namespace understudy::compositor
