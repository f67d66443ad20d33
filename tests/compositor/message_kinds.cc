// SPDX-License-Identifier: Apache-2.0
#include "tests/compositor/message_kinds.h"

#include <array>

#include "compositor/service/integral_parts.h"
#include "compositor/service/load_protocol.h"
#include "compositor/service/request_message.h"
#include "compositor/service/service_protocols.h"
#include "volume/frame_counts.h"

namespace understudy::compositor::testing {

using namespace volume;

namespace {

/// Where the table of some_request_for_slice_segments() is among the tables that the nodes keep; all other
/// places are empty.
constexpr int kept_place = 1;

}  // namespace

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
  v.part = {{8, 10, 3}, {40, 32, 16}};
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
  r.steps->cover_whole_ray = !depth;
  if (depth) r.steps->counted_from = 0.25;
  r.steps->at_least_one = depth;
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
                    {{2, 0, 0, 0, 3, 0, 0, 0.5, 4}},
                    {0.5, -1, 2},
                    {0.1F, 0.2F, 0.3F},
                    {0.4F, 0.5F, 0.6F},
                    {0.7F, 0.8F, 0.9F},
                    12,
                    0.5F,
                    {0.75, NormalGuard::Form::root_of_squares},
                    false,
                    false,
                    {1, 2, 0.5},
                    {0.5F, 0.25F, 1},
                    1.5F,
                    {{1, -0.5F}, {0.25F, 0}, {0, 2}},
                    {{0.25F, 1, 0.5F}, 0.125, 3}};
  }
  if (!colours) r.fog = Fog{{0.5, -0.25, 2}, 0.125, {{0, 0, 0, 1}, {0.1F, 0.2F, 0.3F, 0.5F}}};
  r.opacity_limit = 0.95F;
  r.termination = 1e-5F;
  r.may_travel_as_halves = depth;
  r.exact = !colours;
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

namespace {

std::array<PreIntegrationTable, 3> some_kept_tables() {
  return {PreIntegrationTable{},
          std::get<PreIntegrationTable>(some_request_for_slice_segments().classification),
          PreIntegrationTable{}};
}

FrameCounts some_counts() {
  return {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14.5, 15.25};
}

}  // namespace

std::vector<std::byte> texels_message(const Texels& texels) {
  std::vector<std::byte> bytes = encode_texels_head(texels);
  bytes.insert(bytes.end(), texels.texels.begin(), texels.texels.end());
  bytes.resize((bytes.size() + 7) / 8 * 8);
  return bytes;
}

std::vector<MessageKind> all_message_kinds() {
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
      {"rendered", encode(RenderedReply{{1, 2, 3, 4}, some_counts(), true}),
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
      {"load",
       encode(LoadRequest{some_volume(),
                          "/a/b_64x33x17.raw",
                          {{{64, 33, 17}}, ScalarType::f64, true},
                          {TexelType::u16, {{-1.5, 2e300}}}}),
       [](auto b) { return encode(decode_load_request(b)); }},
      {"histogram", encode(HistogramQuestion{7, {-0.5, 1.5, 200}}),
       [](auto b) { return encode(decode_histogram_question(b)); }},
      {"counted", encode_histogram(std::array<std::uint64_t, 3>{1, 0, ~std::uint64_t(0)}),
       [](auto b) { return encode_histogram(decode_histogram(b)); }},
      {"id", encode_id(~std::uint64_t(0)), [](auto b) { return encode_id(decode_id(b)); }},
      {"size", encode_size(4096), [](auto b) { return encode_size(decode_size(b)); }},
      {"text", encode_text("why not"), [](auto b) { return encode_text(decode_text(b)); }},
  };
}

}  // namespace understudy::compositor::testing
