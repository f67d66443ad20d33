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
#include "tests/compositor/message_kinds.h"
#include "volume/frame_counts.h"
#include "volume/raycast/pre_integration_lookup.h"
#include "volume/raycast/ray_caster.h"
#include "volume/request.h"

namespace understudy::compositor {
namespace {

using namespace volume;
using namespace testing;

TEST(Protocol, EveryMessageReadsBackAsWritten) {
  for (const MessageKind& kind : all_message_kinds()) {
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
  EXPECT_EQ(got.steps->counted_from, sent.steps->counted_from);
  EXPECT_EQ(got.steps->at_least_one, sent.steps->at_least_one);
  EXPECT_EQ(got.steps->cover_whole_ray, sent.steps->cover_whole_ray);
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
  EXPECT_EQ(got.opacity_limit, sent.opacity_limit);
  ASSERT_TRUE(got.fog.has_value());
  EXPECT_EQ(got.fog->normal, sent.fog->normal);
  EXPECT_EQ(got.fog->offset, sent.fog->offset);
  EXPECT_EQ(got.fog->entries, sent.fog->entries);
  ASSERT_TRUE(got.depth.has_value());
  EXPECT_EQ(got.depth->rect, sent.depth->rect);
  EXPECT_EQ(got.depth->depth, sent.depth->depth);
  EXPECT_EQ(got.depth->or_equal, sent.depth->or_equal);
  EXPECT_EQ(got.exact, sent.exact);
  EXPECT_EQ(decode_request(encode(some_request(true, false))).classification,
            some_request(true, false).classification);
}

TEST(Protocol, SaysWhichImagesMustBeExact) {
  RenderRequest request = some_request_for_slice_segments();
  // Without the table, as in a relay.
  EXPECT_FALSE(asks_for_exact_image(encode(request, 1)));
  request.exact = true;
  EXPECT_TRUE(asks_for_exact_image(encode(request, 1)));
  request = some_request(true, false);
  EXPECT_FALSE(asks_for_exact_image(encode(request)));
  request.bound_of = MediumFunction{{0, 1, {{}, {1, 1, 1, 1}}}, 1};
  EXPECT_TRUE(asks_for_exact_image(encode(request)));
  EXPECT_TRUE(must_be_exact(decode_request(encode(request))));
  EXPECT_THROW(asks_for_exact_image({}), MalformedMessage);
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
  for (const MessageKind& kind : all_message_kinds())
    for (std::size_t size = 0; size < kind.bytes.size(); ++size) {
      // A copy of exactly that size, so that the sanitizer detects reads beyond its end.
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
  for (const MessageKind& kind : all_message_kinds()) {
    std::vector<std::byte> longer = kind.bytes;
    longer.resize(longer.size() + 8);
    EXPECT_THROW(kind.read_and_write_again(longer), MalformedMessage) << kind.name;
  }
}

TEST(Protocol, AbsurdValuesInAnyPlaceNeverGetPast) {
  // Each eight bytes in turn become a huge, a negative and a boundary value: that is refused or harmless (a
  // coordinate, an id), and never causes a crash or a large allocation.
  int refused = 0, harmless = 0;
  for (const MessageKind& kind : all_message_kinds())
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
  for (const MessageKind& kind : all_message_kinds())
    for (int trial = 0; trial < 3000; ++trial) {
      std::vector<std::byte> bytes = kind.bytes;
      for (unsigned i = 1 + random() % 4; i > 0; --i) bytes[random() % bytes.size()] = std::byte(random());
      if (random() % 4 == 0) bytes.resize(random() % bytes.size());
      try {
        kind.read_and_write_again(bytes);
      } catch (const MalformedMessage&) {
        continue;  // any other exception fails the test
      }
    }
}

// Each limit that a message can exceed is exceeded by one.
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
