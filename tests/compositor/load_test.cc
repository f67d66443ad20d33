// SPDX-License-Identifier: Apache-2.0
// What nodes read from files, what they report, and which files they refuse.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cstring>
#include <functional>

#include "compositor/service/load_protocol.h"
#include "tests/compositor/loading_group.h"
#include "volume/brick/brick_store.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/kd_tree.h"
#include "volume/request.h"

namespace understudy::compositor {
namespace {

using ::testing::HasSubstr;
using namespace testing;
using volume::TexelType;

using LoadTest = LoadingGroup;

TEST_F(LoadTest, RanksThatReadTheBricksOfOthersShowEveryVolumeAsSoonAsItIsThere) {
  const Texture lobes = some_texture(7), flat = some_texture(8, TexelType::u16);
  const auto sent = embedded_service();
  for (const Texture* texture : {&lobes, &flat}) upload(*sent, *texture);
  for (const Sort sort : {Sort::first, Sort::hybrid}) {
    const auto loading = service(4, {sort, 0, 0});
    for (int again = 0; again < 10; ++again)
      for (const Texture* texture : {&lobes, &flat}) {
        const TexelType type = texture->description.type;
        const std::string file = write("v_41x37x29_" + std::string(name_of(type)) + ".raw", texture->texels);
        load(*loading, {texture->description, file, {}, {}});
        const volume::RenderRequest request = some_request(*texture);
        EXPECT_LE(largest_difference(image_of(*loading, request), image_of(*sent, request)), 1e-5);
      }
    dismiss();
  }
}

TEST_F(LoadTest, WhatRanksReadGivesTheImageOfWhatIsSentAndEachReadsItsShare) {
  for (const TexelType type : {TexelType::u8, TexelType::u16, TexelType::f32}) {
    const Texture texture = some_texture(7, type);
    const std::string file = write("v_41x37x29_" + std::string(name_of(type)) + ".raw", texture.texels);
    const auto sent = embedded_service();
    upload(*sent, texture);
    const volume::RenderRequest request = some_request(texture);
    const volume::Image expected = image_of(*sent, request);
    ASSERT_GT(largest_difference(expected, volume::Image(request.window)), 0.05);
    for (const int ranks : {0, 1, 3, 4}) {
      const auto loading = service(ranks);
      const std::vector<RankLoad> figures = load(*loading, {texture.description, file, {}, {}});
      ASSERT_EQ(figures.size(), std::size_t(std::max(ranks, 1)));
      EXPECT_LE(largest_difference(image_of(*loading, request), expected), 1e-5) << ranks;
      const volume::KdTree tree(texture.description, std::max(ranks, 1));
      for (std::size_t rank = 0; rank < figures.size(); ++rank) {
        const std::uint64_t share =
            volume::texels_in(volume::BrickStore::texels_shown(texture.description, tree.box(int(rank))));
        EXPECT_EQ(figures[rank].texels_in_all, share);
        EXPECT_GE(figures[rank].bytes_read, share * volume::bytes_per_texel(type));
        EXPECT_LE(figures[rank].bytes_read, share * volume::bytes_per_texel(type) + 4)
            << "what formats are known by";
        EXPECT_GT(figures[rank].brick_bytes, share) << "bricks hold a texel more than once";
        EXPECT_GT(figures[rank].peak_bytes, figures[rank].brick_bytes);
        EXPECT_LE(figures[rank].low, figures[rank].high);
      }
      dismiss();
    }
  }
}

TEST_F(LoadTest, AVolumeIsNotCompleteBeforeAllRanksAre) {
  const auto loading = service(2);
  const Texture texture = some_texture(7, TexelType::u8);
  const LoadRequest request{texture.description, write("v_41x37x29_u8.raw", texture.texels), {}, {}};
  EXPECT_THROW(loading->continue_load(7), RequestRefused) << "nothing was begun";
  loading->begin_load(request);
  EXPECT_THROW(loading->render(some_request(texture)), RequestRefused);
  load(*loading, request);
  EXPECT_NO_THROW(loading->render(some_request(texture)));
  EXPECT_TRUE(loading->continue_load(7)[1].done()) << "the figures may be asked for again";
  loading->forget_volume(7);
  EXPECT_THROW(loading->continue_load(7), RequestRefused);
}

TEST_F(LoadTest, WhatIsWrongWithAFileComesBackAndTheServiceGoesOn) {
  const Texture texture = some_texture(7, TexelType::u8);
  const std::string good = write("v_41x37x29_u8.raw", texture.texels);
  for (const int ranks : {0, 3}) {
    const auto loading = service(ranks);
    const auto refusal = [&](const LoadRequest& request) -> std::string {
      try {
        load(*loading, request);
      } catch (const RequestRefused& error) {
        return error.what();
      }
      return "(loaded)";
    };
    LoadRequest request{texture.description, good + "x", {}, {}};
    EXPECT_THAT(refusal(request), HasSubstr("check the path"));
    request.file = good;
    request.volume.size = request.volume.stored.high = {41, 37, 28};
    EXPECT_THAT(refusal(request), HasSubstr("is not the volume of 41 x 37 x 28 texels"));
    // Half of a compressed file: only ranks that read its end can detect this.
    const std::string half =
        write("half_41x37x29_u8.raw", std::span(texture.texels).first(std::size_t(41 * 37 * 15)));
    ASSERT_EQ(std::system(("gzip -f " + half).c_str()), 0);
    request = {texture.description, half + ".gz", {}, {}};
    EXPECT_THAT(refusal(request), HasSubstr("truncated"));
    EXPECT_THROW(loading->render(some_request(texture)), RequestRefused) << "it is known to none";
    request.file = good;
    load(*loading, request);
    EXPECT_GT(loading->render(some_request(texture)).counts.samples_taken, 0U);
    dismiss();
  }
}

TEST_F(LoadTest, EveryTexelIsCountedOnceByHoweverManyRanks) {
  for (const TexelType type : {TexelType::u8, TexelType::u16, TexelType::f32}) {
    const Texture texture = some_texture(7, type);
    const std::string file = write("v_41x37x29_" + std::string(name_of(type)) + ".raw", texture.texels);
    const volume::HistogramBins bins{0.2, 0.7, 100};
    std::vector<std::uint64_t> expected(100);
    std::uint64_t inside = 0;
    const std::size_t size = volume::bytes_per_texel(type);
    for (std::size_t at = 0; at < texture.texels.size(); at += size) {
      double value = 0;
      if (type == TexelType::f32) {
        float texel = 0;
        std::memcpy(&texel, &texture.texels[at], size);
        value = double(texel);
      } else {
        std::uint16_t texel = 0;  // for u8, the lower half
        std::memcpy(&texel, &texture.texels[at], size);
        value = texel / (type == TexelType::u8 ? 255.0 : 65535.0);
      }
      if (value < 0.2 || value > 0.7) continue;
      ++expected[std::min<std::size_t>(99, std::size_t((value - 0.2) * (100 / (0.7 - 0.2))))];
      ++inside;
    }
    ASSERT_GT(inside, 10000U);
    ASSERT_LT(inside, 41U * 37U * 29U);
    for (const int ranks : {0, 1, 3, 5}) {
      const auto loading = service(ranks);
      EXPECT_THROW(loading->histogram(7, bins), RequestRefused) << "there is no volume";
      load(*loading, {texture.description, file, {}, {}});
      EXPECT_EQ(loading->histogram(7, bins), expected) << ranks << " ranks, " << name_of(type);
      dismiss();
    }
  }
}

TEST_F(LoadTest, RanksTellTheirCellsAndWhatTheLastImageTook) {
  const auto loading = service(3);
  const Texture texture = some_texture(7, TexelType::u8);
  load(*loading, {texture.description, write("v_41x37x29_u8.raw", texture.texels), {}, {}});
  const volume::KdTree tree(texture.description, 3);
  const volume::FrameCounts counts = loading->render(some_request(texture)).counts;
  const std::vector<RankLoad> ranks = loading->continue_load(7);
  ASSERT_EQ(ranks.size(), 3U);
  std::uint64_t samples = 0;
  double slowest = 0;
  for (std::size_t rank = 0; rank < ranks.size(); ++rank) {
    EXPECT_EQ(ranks[rank].cells, tree.box(int(rank)));
    samples += ranks[rank].image_samples;
    slowest = std::max(slowest, ranks[rank].image_ms);
  }
  EXPECT_EQ(samples, counts.samples_taken);
  EXPECT_EQ(slowest, counts.render_ms);
}

TEST(LoadProtocol, MessagesComeBackAsTheyWereAndCutOnesAreMalformed) {
  LoadRequest request{some_texture().description, "/a/b_41x37x29.raw", {}, {}};
  for (const bool told : {false, true}) {
    if (told) {
      request.hints = {{{41, 37, 29}}, volume::ScalarType::f64, true, 2, 7, 3};
      request.texels = {TexelType::u16, {{-1.5, 2e300}}};
    }
    const std::vector<std::byte> bytes = encode(request);
    const LoadRequest back = decode_load_request(bytes);
    EXPECT_EQ(back.volume, request.volume);
    EXPECT_EQ(back.file, request.file);
    EXPECT_EQ(back.hints, request.hints);
    EXPECT_EQ(back.texels, request.texels);
    for (std::size_t cut = 0; cut < bytes.size(); ++cut)
      EXPECT_THROW(decode_load_request(std::span(bytes).first(cut)), MalformedMessage) << cut;
  }
  request.file = std::string("a\0b", 3);
  EXPECT_THROW(decode_load_request(encode(request)), MalformedMessage);
  request.file = std::string(5000, 'x');
  EXPECT_THROW(decode_load_request(encode(request)), MalformedMessage);

  const std::vector<RankLoad> ranks{{1, 2, 3, 4, 5, -6.5, 7, 8, 9}, {}};
  const std::vector<std::byte> bytes = encode(ranks);
  const std::vector<RankLoad> back = decode_loads(bytes);
  ASSERT_EQ(back.size(), 2U);
  EXPECT_EQ(encode(back), bytes);
  EXPECT_EQ(back[0].low, -6.5);
  EXPECT_EQ(back[0].not_numbers, 9U);
  for (std::size_t cut = 0; cut < bytes.size(); ++cut)
    EXPECT_THROW(decode_loads(std::span(bytes).first(cut)), MalformedMessage) << cut;
}

}  // namespace
}  // namespace understudy::compositor
