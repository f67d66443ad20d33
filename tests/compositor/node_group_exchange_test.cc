// SPDX-License-Identifier: Apache-2.0
// What the ranks of whole node groups send each other.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "compositor/exchange/schedule.h"
#include "compositor/exchange/settings.h"
#include "compositor/rendered.h"
#include "tests/compositor/node_group.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/request.h"

namespace understudy::compositor {
namespace {

using namespace testing;

/// For all images of a test: the cheapest exchange may take more messages, or bytes, for smaller parts.
constexpr ExchangeSettings one_exchange{Algorithm::direct_send, Layout::rgba32f, Gather::direct, Overlap::off,
                                        false};

TEST_F(NodeGroupTest, RanksWithNothingToShowAreIdleAndExchangeNothing) {
  start(3);
  const auto linked = connect();
  const Texture texture = some_texture();
  upload(*linked, texture);
  volume::RenderRequest request = some_request(texture);
  std::ranges::fill(std::get<volume::TransferFunction>(request.classification).entries, volume::Rgba{});
  const Rendered rendered = linked->render(request);
  EXPECT_TRUE(rendered.image.rect.empty());
  EXPECT_EQ(rendered.counts.nodes_idle, 3U);
  EXPECT_EQ(rendered.counts.bytes_exchanged, 0U);
}

TEST_F(NodeGroupTest, FootprintsLeaveOutWhatWholeWindowsWouldCost) {
  start(3, limits::stall_patience, {}, one_exchange);
  const auto linked = connect();
  const Texture texture = some_texture();
  upload(*linked, texture);
  volume::RenderRequest request = some_request(texture);
  const Rendered usual = linked->render(request);
  const volume::FrameCounts counts = usual.counts;
  const volume::Image image = whole_image(usual, request);
  request.optimizations.footprints = false;
  const Rendered whole = linked->render(request);
  EXPECT_EQ(whole.image.rect, request.window);
  EXPECT_LE(largest_difference(whole_image(whole, request), image), 4e-6);
  EXPECT_EQ(whole.counts.bytes_exchanged, counts.bytes_of_whole_windows) << "as was said before";
  EXPECT_EQ(whole.counts.messages, counts.messages_of_whole_windows);
  EXPECT_LT(counts.bytes_exchanged, counts.bytes_of_whole_windows);
  EXPECT_LE(counts.messages, counts.messages_of_whole_windows);
  EXPECT_GT(counts.messages, 0U);
}

TEST_F(NodeGroupTest, PartsAreGatheredDirectlyOrByTheRoot) {
  const Texture texture = some_texture();
  const volume::RenderRequest request = some_request(texture);
  const auto rendered_by = [&](const ExchangeSettings& settings, std::uint64_t& bytes) {
    const Group& group = start(3, limits::stall_patience, {}, settings);
    const auto linked = connect();
    upload(*linked, texture);
    const Rendered rendered = linked->render(request);
    bytes = rendered.counts.bytes_exchanged;
    EXPECT_GT(rendered.counts.bytes_of_whole_windows, bytes);
    volume::Image image = whole_image(rendered, request);
    // Larger images need another buffer, which the ranks must map too.
    volume::RenderRequest larger = request;
    larger.viewport = larger.window = {0, 0, 480, 360};
    EXPECT_GT(linked->render(larger).image.rect.pixels(), 4 * rendered.image.rect.pixels());
    EXPECT_EQ(whole_image(linked->render(request), request).rgba, image.rgba);
    launcher_->ask([](Broker& b) { b.dismiss_node_group(); });
    EXPECT_TRUE(eventually([&] { return group.ended(); }));
    return image;
  };
  for (const Algorithm algorithm : {Algorithm::serial, Algorithm::tree, Algorithm::direct_send,
                                    Algorithm::binary_swap, Algorithm::radix_k}) {
    std::uint64_t direct = 0, gathered = 0;
    EXPECT_EQ(rendered_by({algorithm, Layout::rgba32f, Gather::direct, Overlap::off, false}, direct).rgba,
              rendered_by({algorithm, Layout::rgba32f, Gather::root, Overlap::off, false}, gathered).rgba);
    std::printf("%s: %llu bytes directly, %llu gathered\n", std::string(name_of(algorithm)).c_str(),
                static_cast<unsigned long long>(direct), static_cast<unsigned long long>(gathered));
    // With a tree, one rank ends with the whole image, and that may be rank 0.
    if (algorithm == Algorithm::serial || algorithm == Algorithm::tree) {
      EXPECT_LE(direct, gathered);
    } else {
      EXPECT_LT(direct, gathered);
    }
  }
}

TEST_F(NodeGroupTest, WhatIsBehindOpaqueTilesIsNotSent) {
  const Texture texture = some_texture();
  volume::RenderRequest request =
      volume::testing::request_for(texture, volume::testing::usual_camera(640, 480), 640, 480, 50);
  for (volume::Rgba& entry : std::get<volume::TransferFunction>(request.classification).entries)
    entry[3] = 0.9F;
  for (const int ranks : {3, 5}) {
    const Group& group = start(ranks, limits::stall_patience, {}, one_exchange);
    const auto linked = connect();
    upload(*linked, texture);
    request.termination = 0;
    const Rendered all = linked->render(request);
    const std::uint64_t bytes = all.counts.bytes_exchanged, samples = all.counts.samples;
    const volume::Image complete = whole_image(all, request);
    request.termination = 5e-6F;
    std::optional<volume::Image> first;
    for (int i = 0; i < 5; ++i) {
      const Rendered rendered = linked->render(request);
      EXPECT_LT(rendered.counts.bytes_exchanged, bytes);
      EXPECT_EQ(rendered.counts.samples, samples);
      EXPECT_GT(rendered.counts.samples_hidden, 0U);
      const volume::Image image = whole_image(rendered, request);
      EXPECT_LE(largest_difference(image, complete), 1e-5);
      if (!first) first = image;
      EXPECT_EQ(image.rgba, first->rgba) << "whenever control messages come";
      // A refused image leaves no control message that counts.
      volume::RenderRequest wrong = request;
      wrong.version = 99;
      EXPECT_THROW(linked->render(wrong), RequestRefused);
    }
    launcher_->ask([](Broker& b) { b.dismiss_node_group(); });
    EXPECT_TRUE(eventually([&] { return group.ended(); }));
  }
}

TEST_F(NodeGroupTest, PartsMayTravelAsHalves) {
  start(3);
  const auto linked = connect();
  const Texture texture = some_texture();
  upload(*linked, texture);
  volume::RenderRequest request = some_request(texture);
  const Rendered floats = linked->render(request);
  const std::uint64_t bytes = floats.counts.bytes_exchanged;
  const volume::Image image = whole_image(floats, request);
  request.may_travel_as_halves = true;
  const Rendered halves = linked->render(request);
  EXPECT_LT(double(halves.counts.bytes_exchanged), 0.6 * double(bytes));
  const double off = largest_difference(whole_image(halves, request), image);
  EXPECT_GT(off, 0);
  EXPECT_LE(off, 3.0 / 2048) << "three parts, each rounded";
}

TEST_F(NodeGroupTest, ExactImagesAndBoundsTravelAsFloatsWhateverTheNodesWereTold) {
  const Texture texture = texture_for_bounds();
  const volume::RenderRequest bounds = request_for_bounds(texture);
  volume::RenderRequest any = bounds;
  any.bound_of.reset();
  const volume::RenderRequest exact = volume::exactly(any);
  const auto images_in = [&](Layout layout) {
    ExchangeSettings settings = one_exchange;
    settings.layout = layout;
    const Group& group = start(3, limits::stall_patience, {}, settings);
    const auto linked = connect();
    upload(*linked, texture);
    std::vector<std::vector<float>> images;
    for (const volume::RenderRequest& request : {any, exact, bounds})
      images.push_back(image_of(*linked, request).rgba);
    launcher_->ask([](Broker& b) { b.dismiss_node_group(); });
    EXPECT_TRUE(eventually([&] { return group.ended(); }));
    return images;
  };
  const auto floats = images_in(Layout::rgba32f);
  EXPECT_EQ(floats[1], floats[0]);
  EXPECT_NE(floats[2], floats[0]);
  for (const Layout layout : {Layout::rgba16f, Layout::rgba8}) {
    const auto images = images_in(layout);
    EXPECT_NE(images[0], floats[0]) << "it was rounded";
    EXPECT_EQ(images[1], floats[1]);
    EXPECT_EQ(images[2], floats[2]);
  }
}

}  // namespace
}  // namespace understudy::compositor
