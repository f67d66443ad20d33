// SPDX-License-Identifier: Apache-2.0
#include "compositor/node/opaque_tiles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <latch>
#include <mutex>
#include <vector>

#include "compositor/exchange/exchange.h"
#include "compositor/exchange/thread_communicator.h"
#include "compositor/service/rank_renderer.h"
#include "tests/compositor/group_scene.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/request.h"

namespace understudy::compositor {
namespace {

using namespace testing;
using volume::Image;
using volume::Rect;
using volume::RenderRequest;

RenderRequest wide_request(int width, int height) {
  RenderRequest request;
  request.window = request.viewport = {0, 0, width, height};
  return request;
}

Image opaque_image(const Rect& rect) {
  Image image(rect);
  std::ranges::fill(image.rgba, 1.0F);
  return image;
}

bool is_clear(const Image& image, const Rect& rect) {
  for (int y = rect.y; y < rect.y + rect.height; ++y)
    if (std::any_of(image.at(rect.x, y), image.at(rect.x, y) + 4 * rect.width, [](float v) { return v != 0; }))
      return false;
  return true;
}

TEST(OpaqueTiles, WhatIsBehindThemIsCleared) {
  // Rank 2 is nearest and covers two tiles and a bit; rank 0 has drawn everything; rank 1 lies elsewhere.
  const RenderRequest request = wide_request(200, 90);
  const std::array<Rank, 3> order{2, 1, 0};
  const std::array<Rect, 3> footprints{Rect{0, 0, 200, 90}, Rect{128, 64, 20, 20}, Rect{0, 0, 70, 40}};
  run_ranks(3, [&](Communicator& communicator) {
    OpaqueTiles tiles(communicator, 1, request, order, footprints);
    Image image = opaque_image(footprints[std::size_t(communicator.rank())]);
    cover_opaque_tiles(image, request, tiles);
    std::uint32_t mine = tiles.tell_rest();
    std::vector<std::uint32_t> control_messages(3);
    communicator.gather_to_all(bytes_of(mine), std::as_writable_bytes(std::span(control_messages)));
    tiles.clear_hidden(image, control_messages);
    if (communicator.rank() == 0) {
      EXPECT_EQ(control_messages, (std::vector<std::uint32_t>{0, 0, 1}))
          << "nobody is behind rank 0, and rank 1 covers no tile";
      EXPECT_TRUE(is_clear(image, {0, 0, 64, 32}));
      EXPECT_FALSE(is_clear(image, {64, 0, 1, 1})) << "a tile that is covered in part";
      EXPECT_FALSE(is_clear(image, {0, 32, 1, 1}));
    } else {
      EXPECT_FALSE(is_clear(image, {image.rect.x, image.rect.y, 1, 1}));
    }
  });
}

TEST(OpaqueTiles, WindowsMayBeginLeftOfAndBelowTheOrigin) {
  RenderRequest request;
  request.window = request.viewport = {-50, -40, 120, 100};
  const std::array<Rank, 2> order{1, 0};
  const std::array<Rect, 2> footprints{request.window, Rect{-50, -40, 50, 40}};
  run_ranks(2, [&](Communicator& communicator) {
    OpaqueTiles tiles(communicator, 1, request, order, footprints);
    Image image = opaque_image(footprints[std::size_t(communicator.rank())]);
    cover_opaque_tiles(image, request, tiles);
    std::uint32_t mine = tiles.tell_rest();
    std::vector<std::uint32_t> control_messages(2);
    communicator.gather_to_all(bytes_of(mine), std::as_writable_bytes(std::span(control_messages)));
    tiles.clear_hidden(image, control_messages);
    if (communicator.rank() == 0) {
      EXPECT_TRUE(is_clear(image, footprints[1]));
      EXPECT_FALSE(is_clear(image, {0, -40, 1, 1}));
      EXPECT_FALSE(is_clear(image, {-50, 0, 1, 1}));
    }
  });
}

TEST(OpaqueTiles, TilesEndAtTheWindow) {
  // The window's last tiles are 8 pixels wide and 26 high.
  const RenderRequest request = wide_request(200, 90);
  const std::array<Rank, 2> order{0, 1};
  const std::array<Rect, 2> footprints{Rect{192, 64, 8, 26}, Rect{0, 0, 200, 90}};
  run_ranks(2, [&](Communicator& communicator) {
    OpaqueTiles tiles(communicator, 1, request, order, footprints);
    Image image = opaque_image(footprints[std::size_t(communicator.rank())]);
    cover_opaque_tiles(image, request, tiles);
    std::uint32_t mine = tiles.tell_rest();
    std::vector<std::uint32_t> control_messages(2);
    communicator.gather_to_all(bytes_of(mine), std::as_writable_bytes(std::span(control_messages)));
    tiles.clear_hidden(image, control_messages);
    if (communicator.rank() == 1) {
      EXPECT_TRUE(is_clear(image, footprints[0]));
      EXPECT_FALSE(is_clear(image, {191, 64, 1, 26}));
    }
  });
}

TEST(OpaqueTiles, ControlMessagesOfOtherImagesCountForNothing) {
  const RenderRequest request = wide_request(64, 64);
  const std::array<Rank, 2> order{0, 1};
  const std::array<Rect, 2> footprints{request.window, request.window};
  run_ranks(2, [&](Communicator& communicator) {
    {
      // Some rank refuses this image: no rank reads these control messages.
      OpaqueTiles tiles(communicator, 7, request, order, footprints);
      if (communicator.rank() == 0) tiles.cover(request.window);
      tiles.tell_rest();
    }
    OpaqueTiles tiles(communicator, 8, request, order, footprints);
    if (communicator.rank() == 0) tiles.cover({0, 0, 32, 64});
    std::uint32_t mine = tiles.tell_rest();
    std::vector<std::uint32_t> control_messages(2);
    communicator.gather_to_all(bytes_of(mine), std::as_writable_bytes(std::span(control_messages)));
    Image image = opaque_image(request.window);
    tiles.clear_hidden(image, control_messages);
    if (communicator.rank() == 1) {
      EXPECT_TRUE(is_clear(image, {0, 0, 32, 64}));
      EXPECT_FALSE(is_clear(image, {32, 0, 1, 1}));
    }
  });
}

TEST(OpaqueTiles, MoreThanAControlMessageHolds) {
  const RenderRequest request = wide_request(16384, 16384);
  const std::array<Rank, 2> order{1, 0};
  const std::array<Rect, 2> footprints{Rect{0, 0, 64, 64}, request.window};
  run_ranks(2, [&](Communicator& communicator) {
    OpaqueTiles tiles(communicator, 1, request, order, footprints);
    if (communicator.rank() == 1) tiles.cover(request.window);
    std::uint32_t mine = tiles.tell_rest();
    std::vector<std::uint32_t> control_messages(2);
    communicator.gather_to_all(bytes_of(mine), std::as_writable_bytes(std::span(control_messages)));
    Image image = opaque_image(footprints[0]);
    tiles.clear_hidden(image, control_messages);
    if (communicator.rank() == 0) {
      EXPECT_GT(control_messages[1], 1U);
      EXPECT_TRUE(is_clear(image, image.rect));
    }
  });
}

/// Two ranks, of which the farther one begins when the nearer one has told it of all its opaque tiles.
struct Drawn {
  Image image;
  std::array<volume::FrameCounts, 2> counts;  ///< of the nearer and the farther one
  std::uint64_t bytes = 0;
};

Drawn drawn(const Texture& texture, const RenderRequest& request, bool with_occlusion = true) {
  Drawn result;
  std::latch told(1);
  std::mutex mutex;
  run_ranks(2, [&](Communicator& communicator) {
    RankRenderer renderer(communicator.rank(), 2);
    renderer.begin(1, texture.description);
    const VolumeKey key{1, texture.description.id};
    const std::vector<volume::TexelBox> shares =
        renderer.shares(key, {&texture.description.stored, 1}, communicator.rank());
    std::vector<std::byte> texels(volume::texels_in(shares[0]));
    volume::copy_texels(shares[0], 1, texture.description.stored, texture.texels, shares[0], texels);
    renderer.add_texels(key, shares, texels);
    renderer.end(key);

    const std::vector<int> order = renderer.visibility_order(1, request);
    const bool nearer = order[0] == communicator.rank();
    OpaqueTiles tiles(communicator, 1, request, order, renderer.footprints(1, request));
    volume::FrameCounts counts;
    if (!nearer) {
      told.wait();
      // Only this thread reads control messages, and on a busy machine other threads draw before it does.
      tiles.hides(request.viewport);
    }
    Image image = renderer.render(1, request, counts, with_occlusion ? &tiles : nullptr);
    std::uint32_t mine = tiles.tell_rest();
    if (nearer) told.count_down();
    std::vector<std::uint32_t> control_messages(2);
    communicator.gather_to_all(bytes_of(mine), std::as_writable_bytes(std::span(control_messages)));
    tiles.clear_hidden(image, control_messages);

    Rect footprint = image.rect;
    std::vector<Rect> footprints(2);
    communicator.gather_to_all(bytes_of(footprint), std::as_writable_bytes(std::span(footprints)));
    Exchanged exchanged = exchange(std::move(image), schedule(Algorithm::direct_send, order, footprints),
                                   request.op, Layout::rgba32f, communicator);
    const std::lock_guard lock(mutex);
    result.counts[nearer ? 0 : 1] = counts;
    if (communicator.rank() != 0) return;
    result.bytes = exchanged.bytes;
    result.image = whole_image({exchanged.image.view(), {}}, request);
  });
  return result;
}

TEST(OpaqueTiles, WhatIsBehindThemIsNeitherDrawnNorSent) {
  const Texture texture = some_texture();
  RenderRequest request =
      volume::testing::request_for(texture, volume::testing::usual_camera(640, 480), 640, 480, 50);
  for (volume::Rgba& entry : std::get<volume::TransferFunction>(request.classification).entries)
    entry[3] = 0.9F;
  const Drawn all = drawn(texture, request);
  request.termination = 5e-6F;
  const Drawn usual = drawn(texture, request);
  EXPECT_LE(largest_difference(usual.image, all.image), 1e-5);
  ASSERT_EQ(usual.counts[1].samples, all.counts[1].samples);
  std::printf("the farther rank takes %llu of %llu samples, and %llu bytes travel instead of %llu\n",
              static_cast<unsigned long long>(usual.counts[1].samples_taken),
              static_cast<unsigned long long>(usual.counts[1].samples),
              static_cast<unsigned long long>(usual.bytes), static_cast<unsigned long long>(all.bytes));
  EXPECT_EQ(usual.counts[1].samples_taken + usual.counts[1].samples_hidden, usual.counts[1].samples);
  const Drawn by_itself = drawn(texture, request, false);
  EXPECT_LT(double(usual.counts[1].samples_taken), 0.8 * double(by_itself.counts[1].samples_taken));
  EXPECT_LT(double(usual.bytes), 0.9 * double(by_itself.bytes));
  request.op = volume::Operator::add;
  EXPECT_EQ(drawn(texture, request).counts[1].samples_hidden, 0U) << "sums hide nothing";
}

}  // namespace
}  // namespace understudy::compositor
