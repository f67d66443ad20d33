// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstring>
#include <functional>
#include <random>

#include "compositor/service/integral_parts.h"
#include "compositor/service/limits.h"
#include "compositor/service/load_protocol.h"
#include "compositor/service/node_protocol.h"
#include "compositor/service/request_message.h"
#include "compositor/service/service_protocols.h"
#include "compositor/transport/tcp/line_protocol.h"
#include "volume/frame_counts.h"
#include "volume/raycast/pre_integration_lookup.h"
#include "volume/raycast/ray_caster.h"
#include "volume/request.h"

namespace understudy::compositor {
namespace {

using namespace volume;

VolumeDescription some_volume() {
  VolumeDescription v;
  v.id = 0xfedcba9876543210;
  v.version = 3;
  v.size = {64, 33, 17};
  v.type = TexelType::u16;
  v.wrap = {Wrap::edge, Wrap::border, Wrap::repeat};
  v.border = {0.1F, 0.2F, 0.3F, 0.4F};
  v.stored = {{1, 2, 3}, {60, 33, 17}};
  v.ghost_layer = 8;
  return v;
}

RenderRequest some_request(bool colours, bool depth) {
  RenderRequest r;
  r.volume = 17;
  r.version = 4;
  for (std::size_t i = 0; i < 16; ++i) r.texture_to_clip[i] = 0.1 * double(i) - 0.3;
  r.viewport = {-5, 6, 700, 500};
  r.window = {0, 6, 300, 20};
  r.depth_range = {0.25, 0.75};
  r.planes = {{0.1, -0.2, 0.3}, -1.5, 1.0 / 512, 999};
  r.steps = RaySteps{{1, 2, 3, 4, 5, 6, 7, 8, 10}, 0.5, true, 0.25, 2};
  r.steps->counted_without_offsets = depth;
  if (depth) r.steps->offsets = RayOffsets{3, 2, {0, 0.5F, 0.25F, 0.125F, 1, 2}};
  r.op = Operator::min;
  r.filter = Filter::nearest;
  r.region = {{0.1, 0.2, 0.3}, {0.4, 0.5, 0.6}};
  r.clip_planes = {{{1, 0, 0}, -0.5}, {{0, 1, 2}, 0.25}};
  if (colours) {
    LinearMap map;
    for (std::size_t i = 0; i < 16; ++i) map.matrix[i] = float(i) / 7;
    map.multiply_by_alpha = false;
    map.alpha_above = 0.02F;
    r.classification = map;
  } else {
    r.classification = TransferFunction{-0.5F, 2.5F, {{0, 0, 0, 0}, {0.1F, 0.2F, 0.3F, 0.4F}, {9, 9, 9, 1}}};
  }
  if (!colours) {
    r.method = Method::pre_integrated;
    r.surfaces = {{0.25, {0.1F, 0.2F, 0.3F, 0.4F}}, {-7.5, {1, 0.5F, 0, 1}}};
    r.light = Light{{1, 2, 3, 4, 5, 6, 7, 8, 10},
                    {0.5, -1, 2},
                    {0.1F, 0.2F, 0.3F},
                    {0.4F, 0.5F, 0.6F},
                    {0.7F, 0.8F, 0.9F},
                    12,
                    false,
                    false};
  }
  if (!colours) r.fog = Fog{{0.5, -0.25, 2}, 0.125, {{0, 0, 0, 1}, {0.1F, 0.2F, 0.3F, 0.5F}}};
  r.termination = 1e-5F;
  r.may_travel_as_halves = depth;
  r.optimizations = {true, !colours, depth};
  if (depth) r.depth = DepthImage{{2, 7, 3, 1}, {0.5F, 0.25F, 1.0F}, true};
  return r;
}

RenderRequest some_request_for_slice_segments() {
  RenderRequest r = some_request(true, false);
  PreIntegrationTable pairs{-0.5F, 2.5F, 3, {}, false};
  for (int i = 0; i < 9; ++i) pairs.entries.push_back({float(i), 0.5F, 0.25F, 0.125F});
  r.classification = pairs;
  r.slice_segment = SliceSegment{1, {0.1, -0.2, 0.3}, {0.15, 0.25, 0.35}};
  return r;
}

/// Among the tables that the nodes keep, the one of some_request_for_slice_segments() is at this place, and no
/// other is.
constexpr int kept_place = 1;
std::array<PreIntegrationTable, 3> some_kept_tables() {
  return {PreIntegrationTable{},
          std::get<PreIntegrationTable>(some_request_for_slice_segments().classification),
          PreIntegrationTable{}};
}

FrameCounts some_counts() {
  return {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14.5, 15.25};
}

// Every kind of message, and how it is read.
struct Kind {
  const char* name;
  std::vector<std::byte> bytes;
  std::function<std::vector<std::byte>(std::span<const std::byte>)> read_and_write_again;
};

std::vector<std::byte> texels_message(const Texels& texels) {
  std::vector<std::byte> bytes = encode_texels_head(texels);
  bytes.insert(bytes.end(), texels.texels.begin(), texels.texels.end());
  bytes.resize((bytes.size() + 7) / 8 * 8);
  return bytes;
}

std::vector<Kind> all_kinds() {
  static const std::array<std::byte, 13> texels{std::byte(1), std::byte(2), std::byte(3)};
  const auto request = [](std::span<const std::byte> b) { return encode(decode_request(b)); };
  return {
      {"hello", encode(Hello{7}), [](auto b) { return encode(decode_hello(b)); }},
      {"alive", encode(Alive{1500}), [](auto b) { return encode(decode_alive(b)); }},
      {"volume", encode(some_volume()), [](auto b) { return encode(decode_volume(b)); }},
      {"change", encode(Change{4, 2}), [](auto b) { return encode(decode_change(b)); }},
      {"texels", texels_message({4, {{{1, 2, 3}, {2, 4, 5}}, {{0, 0, 0}, {3, 3, 1}}}, texels}),
       [](auto b) { return texels_message(decode_texels(b)); }},
      {"request with a table", encode(some_request(false, false)), request},
      {"request for segments", encode(some_request_for_slice_segments()), request},
      {"request for segments by a kept table", encode(some_request_for_slice_segments(), kept_place),
       [](auto b) { return encode(decode_request(b, some_kept_tables()), kept_place); }},
      {"pre-integration table", encode(KeptPreIntegrationTable{kept_place, some_kept_tables()[kept_place]}),
       [](auto b) { return encode(decode_pre_integration_table(b)); }},
      {"request with a map and depth", encode(some_request(true, true)), request},
      {"rendered", encode(RenderedReply{{1, 2, 3, 4}, some_counts()}),
       [](auto b) { return encode(decode_rendered(b)); }},
      {"integrals",
       encode(some_request(false, false), std::array{volume::Pixel{3, -4}, volume::Pixel{70000, 5}}, 12.5),
       [](auto b) {
         const IntegralQuestion question = decode_integral_question(b);
         return encode(question.request, question.pixels, question.most_ms);
       }},
      {"integrated", encode(std::array{volume::PixelIntegral{0.25, 0.5, 1.5, 1}, volume::PixelIntegral{}}),
       [](auto b) { return encode(decode_integrals(b)); }},
      {"loads",
       encode(std::vector<RankLoad>{{1, 2, 3, 4, 5, -6.5, 7, 8, 9, {{-1, 0, 1}, {2, 3, 4}}, 10.5, 11}, {}}),
       [](auto b) { return encode(decode_loads(b)); }},
      {"histogram", encode(HistogramQuestion{7, {-0.5, 1.5, 200}}),
       [](auto b) { return encode(decode_histogram_question(b)); }},
      {"counted", encode_histogram(std::array<std::uint64_t, 3>{1, 0, ~std::uint64_t(0)}),
       [](auto b) { return encode_histogram(decode_histogram(b)); }},
      {"id", encode_id(~std::uint64_t(0)), [](auto b) { return encode_id(decode_id(b)); }},
      {"size", encode_size(4096), [](auto b) { return encode_size(decode_size(b)); }},
      {"text", encode_text("why not"), [](auto b) { return encode_text(decode_text(b)); }},
  };
}

TEST(Protocol, EveryMessageReadsBackAsWritten) {
  for (const Kind& kind : all_kinds()) {
    EXPECT_EQ(kind.read_and_write_again(kind.bytes), kind.bytes) << kind.name;
    EXPECT_EQ(kind.bytes.size() % 8, 0U) << kind.name;
  }
  EXPECT_EQ(decode_volume(encode(some_volume())), some_volume());
}

TEST(Protocol, EveryFieldOfARequestArrives) {
  const RenderRequest sent = some_request(false, true), got = decode_request(encode(sent));
  EXPECT_EQ(got.volume, sent.volume);
  EXPECT_EQ(got.version, sent.version);
  EXPECT_EQ(got.texture_to_clip, sent.texture_to_clip);
  EXPECT_EQ(got.viewport, sent.viewport);
  EXPECT_EQ(got.window, sent.window);
  EXPECT_EQ(got.depth_range, sent.depth_range);
  EXPECT_EQ(got.planes.normal, sent.planes.normal);
  EXPECT_EQ(got.planes.first, sent.planes.first);
  EXPECT_EQ(got.planes.spacing, sent.planes.spacing);
  EXPECT_EQ(got.planes.count, sent.planes.count);
  ASSERT_TRUE(got.steps.has_value());
  EXPECT_EQ(got.steps->metric, sent.steps->metric);
  EXPECT_EQ(got.steps->first, sent.steps->first);
  EXPECT_EQ(got.steps->divided, sent.steps->divided);
  EXPECT_EQ(got.steps->rounding, sent.steps->rounding);
  EXPECT_EQ(got.steps->past_depth, sent.steps->past_depth);
  EXPECT_EQ(got.steps->counted_without_offsets, sent.steps->counted_without_offsets);
  ASSERT_TRUE(got.steps->offsets.has_value());
  EXPECT_EQ(got.steps->offsets->width, sent.steps->offsets->width);
  EXPECT_EQ(got.steps->offsets->height, sent.steps->offsets->height);
  EXPECT_EQ(got.steps->offsets->steps, sent.steps->offsets->steps);
  EXPECT_EQ(got.op, sent.op);
  EXPECT_EQ(got.filter, sent.filter);
  EXPECT_EQ(got.region.low, sent.region.low);
  EXPECT_EQ(got.region.high, sent.region.high);
  ASSERT_EQ(got.clip_planes.size(), 2U);
  EXPECT_EQ(got.clip_planes[1].normal, sent.clip_planes[1].normal);
  EXPECT_EQ(got.clip_planes[1].offset, sent.clip_planes[1].offset);
  EXPECT_EQ(got.classification, sent.classification);
  EXPECT_EQ(got.method, sent.method);
  EXPECT_EQ(got.surfaces, sent.surfaces);
  EXPECT_EQ(got.light, sent.light);
  EXPECT_FALSE(decode_request(encode(some_request(true, false))).light.has_value());
  EXPECT_EQ(got.termination, sent.termination);
  ASSERT_TRUE(got.fog.has_value());
  EXPECT_EQ(got.fog->normal, sent.fog->normal);
  EXPECT_EQ(got.fog->offset, sent.fog->offset);
  EXPECT_EQ(got.fog->entries, sent.fog->entries);
  ASSERT_TRUE(got.depth.has_value());
  EXPECT_EQ(got.depth->rect, sent.depth->rect);
  EXPECT_EQ(got.depth->depth, sent.depth->depth);
  EXPECT_EQ(got.depth->or_equal, sent.depth->or_equal);
  EXPECT_EQ(decode_request(encode(some_request(true, false))).classification,
            some_request(true, false).classification);
}

TEST(Protocol, SliceRangesArrive) {
  const RenderRequest sent = some_request_for_slice_segments(), got = decode_request(encode(sent));
  EXPECT_EQ(got.classification, sent.classification);
  ASSERT_TRUE(got.slice_segment.has_value());
  EXPECT_EQ(got.slice_segment->planes, sent.slice_segment->planes);
  EXPECT_EQ(got.slice_segment->offset, sent.slice_segment->offset);
  EXPECT_EQ(got.slice_segment->reach, sent.slice_segment->reach);
}

TEST(Protocol, AKeptTableIsNamedAndNotSent) {
  RenderRequest sent = some_request_for_slice_segments();
  PreIntegrationTable& pairs = std::get<PreIntegrationTable>(sent.classification);
  pairs.edge = 256;
  pairs.entries.resize(std::size_t(256) * 256, Rgba{0.5F, 0.25F, 0.125F, 1});
  const KeptPreIntegrationTable kept = decode_pre_integration_table(encode(KeptPreIntegrationTable{3, pairs}));
  EXPECT_EQ(kept.place, 3);
  EXPECT_EQ(kept.table, pairs);

  const std::vector<std::byte> whole = encode(sent), named = encode(sent, 3);
  std::printf("%zu bytes with the table, %zu with its place\n", whole.size(), named.size());
  EXPECT_GT(whole.size(), sizeof(Rgba) * pairs.entries.size());
  EXPECT_LT(named.size(), 1000U);
  std::array<PreIntegrationTable, 4> tables{PreIntegrationTable{}, PreIntegrationTable{}, PreIntegrationTable{},
                                            pairs};
  EXPECT_EQ(encode(decode_request(named, tables)), whole);

  EXPECT_THROW(decode_request(named), MalformedMessage) << "none is kept";
  EXPECT_THROW(decode_request(encode(sent, 2), tables), MalformedMessage) << "none is kept at this place";
  EXPECT_THROW(decode_request(encode(sent, 4), tables), MalformedMessage) << "there is no such place";
  EXPECT_THROW(decode_request(encode(sent, -1), tables), MalformedMessage);
  EXPECT_THROW(decode_pre_integration_table(
                   encode(KeptPreIntegrationTable{limits::max_kept_pre_integration_tables, pairs})),
               MalformedMessage);
  pairs.entries.pop_back();
  EXPECT_THROW(decode_pre_integration_table(encode(KeptPreIntegrationTable{0, pairs})), MalformedMessage);
}

TEST(Protocol, AMessageCutAnywhereIsRefusedWithFieldAndOffset) {
  for (const Kind& kind : all_kinds())
    for (std::size_t size = 0; size < kind.bytes.size(); ++size) {
      // A copy of just that size, so that reading on is seen by the sanitizer.
      const std::vector<std::byte> cut(kind.bytes.begin(), kind.bytes.begin() + std::ptrdiff_t(size));
      try {
        kind.read_and_write_again(cut);
        ADD_FAILURE() << kind.name << " cut at " << size << " was believed";
      } catch (const MalformedMessage& error) {
        EXPECT_NE(std::string(error.what()).find("offset"), std::string::npos) << error.what();
        EXPECT_NE(std::string(error.what()).find("field '"), std::string::npos) << error.what();
      }
    }
}

TEST(Protocol, BytesLeftOverAreRefused) {
  for (const Kind& kind : all_kinds()) {
    std::vector<std::byte> longer = kind.bytes;
    longer.resize(longer.size() + 8);
    EXPECT_THROW(kind.read_and_write_again(longer), MalformedMessage) << kind.name;
  }
}

TEST(Protocol, AbsurdValuesInAnyPlaceNeverGetPast) {
  // Each eight bytes in turn become a huge, a negative and a boundary value: refused, or harmless (a
  // coordinate, an id), never a crash or a large allocation.
  int refused = 0, harmless = 0;
  for (const Kind& kind : all_kinds())
    for (std::size_t at = 0; at + 8 <= kind.bytes.size(); at += 8)
      for (const std::uint64_t value : {~std::uint64_t(0), std::uint64_t(1) << 63, std::uint64_t(1) << 40,
                                        std::uint64_t(0x7fffffff), ~std::uint64_t(0) - 6}) {
        std::vector<std::byte> bytes = kind.bytes;
        std::memcpy(bytes.data() + at, &value, sizeof value);
        try {
          kind.read_and_write_again(bytes);
          ++harmless;
        } catch (const MalformedMessage&) {
          ++refused;
        }
      }
  std::printf("%d refused, %d harmless\n", refused, harmless);
  EXPECT_GT(refused, 100);
}

TEST(Protocol, RandomDamageNeverGetsPast) {
  const unsigned seed = 4711;
  std::printf("seed %u\n", seed);
  std::mt19937 random(seed);
  for (const Kind& kind : all_kinds())
    for (int trial = 0; trial < 3000; ++trial) {
      std::vector<std::byte> bytes = kind.bytes;
      for (unsigned i = 1 + random() % 4; i > 0; --i) bytes[random() % bytes.size()] = std::byte(random());
      if (random() % 4 == 0) bytes.resize(random() % bytes.size());
      try {
        kind.read_and_write_again(bytes);
      } catch (const MalformedMessage&) {
        continue;  // anything else fails the test
      }
    }
}

// The limits that a message can cross, each crossed by one.
TEST(Protocol, LimitsAreKept) {
  const auto refused = [](const RenderRequest& r) {
    EXPECT_THROW(decode_request(encode(r)), MalformedMessage);
  };
  RenderRequest r = some_request(false, false);
  r.planes.count = max_planes;
  EXPECT_NO_THROW(decode_request(encode(r)));
  r.planes.count = max_planes + 1;
  refused(r);
  r = some_request(false, false);
  r.planes.count = -1;
  refused(r);
  r = some_request(false, false);
  r.clip_planes.resize(limits::max_clip_planes);
  EXPECT_NO_THROW(decode_request(encode(r)));
  r.clip_planes.resize(limits::max_clip_planes + 1);
  refused(r);
  r = some_request(false, false);
  r.window = {0, 0, 8193, 8192};
  refused(r);
  r = some_request(false, false);
  r.viewport.width = limits::max_viewport_extent + 1;
  refused(r);
  r = some_request(false, false);
  r.window.width = -1;
  refused(r);
  r = some_request(false, false);
  r.viewport.x = -limits::max_viewport_offset - 1;
  refused(r);
  r = some_request(false, false);
  std::get<TransferFunction>(r.classification).entries.resize(limits::max_table_entries + 1);
  refused(r);
  std::get<TransferFunction>(r.classification).entries.resize(1);
  refused(r);
  r = some_request(false, true);
  r.depth->depth.pop_back();
  refused(r);
  r = some_request(false, false);
  r.surfaces.resize(max_surfaces);
  EXPECT_NO_THROW(decode_request(encode(r)));
  r.surfaces.resize(max_surfaces + 1);
  refused(r);
  r = some_request(false, false);
  r.method = Method(3);
  refused(r);
  r = some_request_for_slice_segments();
  std::get<PreIntegrationTable>(r.classification).entries.pop_back();
  refused(r);
  r = some_request_for_slice_segments();
  std::get<PreIntegrationTable>(r.classification).edge = max_pre_integration_edge + 1;
  refused(r);

  VolumeDescription v = some_volume();
  v.size[1] = max_axis_texels + 1;
  EXPECT_THROW(decode_volume(encode(v)), MalformedMessage);
  v = some_volume();
  v.size[0] = 0;
  EXPECT_THROW(decode_volume(encode(v)), MalformedMessage);
  v = some_volume();
  v.stored.high[2] = v.size[2] + 1;
  EXPECT_THROW(decode_volume(encode(v)), MalformedMessage);
  v = some_volume();
  v.stored.high[0] = v.stored.low[0];
  EXPECT_THROW(decode_volume(encode(v)), MalformedMessage);

  Texels texels{1, std::vector<TexelBox>(limits::max_boxes_per_message, {{0, 0, 0}, {1, 1, 1}}), {}};
  EXPECT_NO_THROW(decode_texels(texels_message(texels)));
  texels.boxes.push_back(texels.boxes.front());
  EXPECT_THROW(decode_texels(texels_message(texels)), MalformedMessage);
  texels.boxes = {{{0, 2, 0}, {1, 2, 1}}};
  EXPECT_THROW(decode_texels(texels_message(texels)), MalformedMessage) << "an empty box";
  texels.boxes = {{{0, 0, 0}, {1, 1, max_axis_texels + 1}}};
  EXPECT_THROW(decode_texels(texels_message(texels)), MalformedMessage);

  EXPECT_THROW(decode_hello(encode(Hello{0})), MalformedMessage);
  EXPECT_THROW(decode_hello(encode(Hello{limits::max_ranks + 1})), MalformedMessage);
  EXPECT_THROW(decode_size(encode_size(limits::max_window_pixels * 16 + 1)), MalformedMessage);
  EXPECT_EQ(decode_text(encode_text(std::string(5000, 'x'))).size(), limits::max_text_bytes);
}

TEST(Protocol, APeersTextCannotSteerATerminal) {
  EXPECT_EQ(decode_text(encode_text("no\nway\033[2J")), "no way [2J");
}

TEST(Protocol, HeadersOfOthersAreRefused) {
  MessageHeader header;
  header.type = NodeMessage::render;
  EXPECT_NO_THROW(check(header, service_protocols, 100));
  header.payload_bytes = 101;
  EXPECT_THROW(check(header, service_protocols, 100), MalformedMessage);
  header = {.type = NodeMessage::render};
  header.magic = 0x20544547;  // "GET "
  EXPECT_THROW(check(header, service_protocols, 100), MalformedMessage);
  header = {.type = NodeMessage::render};
  ++header.type.version;
  EXPECT_THROW(check(header, service_protocols, 100), MalformedMessage);
  header = {};
  EXPECT_THROW(check(header, service_protocols, 100), MalformedMessage);
  header = {.type = NodeMessage(0)};
  EXPECT_THROW(check(header, service_protocols, 100), MalformedMessage);
  header = {.type = NodeMessage(int(NodeMessage::last) + 1)};
  EXPECT_THROW(check(header, service_protocols, 100), MalformedMessage);
  header = {.type = LineMessage::alive};
  EXPECT_THROW(check(header, service_protocols, 100), MalformedMessage) << "a protocol of other connections";
}

}  // namespace
}  // namespace understudy::compositor
