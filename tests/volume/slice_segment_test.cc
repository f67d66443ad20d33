// SPDX-License-Identifier: Apache-2.0
// Slice segments: colours that depend on two samples, looked up in a pre-integration table.
#include <gmock/gmock.h>
#include <hwy/targets.h>

#include "tests/volume/scenes.h"
#include "volume/footprint.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/kd_tree.h"
#include "volume/raycast/pre_integration_lookup.h"
#include "volume/raycast/ray_caster.h"
#include "volume/request.h"

namespace understudy::volume::testing {
namespace {

/// Opaque bands of different colours that lie between front and back values: neither sample alone determines
/// the entry.
PreIntegrationTable banded_pairs(int edge, float clear_below = 0) {
  PreIntegrationTable table;
  table.edge = edge;
  for (int back = 0; back < edge; ++back)
    for (int front = 0; front < edge; ++front) {
      const float f = float(front) / float(edge - 1), b = float(back) / float(edge - 1);
      const float low = std::min(f, b), high = std::max(f, b);
      const bool crosses = low < 0.55F && high > 0.45F;
      const float alpha = high <= clear_below ? 0 : 0.05F + (crosses ? 0.4F : 0.1F * f);
      table.entries.push_back(alpha > 0 ? Rgba{f, b, crosses ? 1.0F : 0.2F, alpha} : Rgba{f, b, 1, 0});
    }
  return table;
}

/// A request whose segments extend to the next plane, perpendicular to the plane or along the ray.
RenderRequest slice_segments_of(Texture& texture, bool along_rays, int width = 45, int height = 39) {
  RenderRequest request = request_for(texture, usual_camera(width, height), width, height, 80);
  request.classification = banded_pairs(33);
  SliceSegment& slice_segment = request.slice_segment.emplace();
  const double square = dot(request.planes.normal, request.planes.normal);
  const Vec3 straight = scale(request.planes.normal, request.planes.spacing / square);
  if (along_rays) {
    slice_segment.planes = 1;
    // For rays inclined by less than 60 degrees.
    for (double& reach : slice_segment.reach) reach = 2 * length(straight);
  } else {
    slice_segment.offset = straight;
    for (std::size_t k = 0; k < 3; ++k) slice_segment.reach[k] = std::abs(straight[k]);
  }
  const double reach = std::max({slice_segment.reach[0], slice_segment.reach[1], slice_segment.reach[2]});
  texture.description.ghost_layer = int(std::ceil(reach * 51)) + 1;
  return request;
}

Image drawn(const BrickStore& store, const RenderRequest& request, FrameCounts& counts) {
  Image image(request.window);
  raycast(store, request, image, counts);
  return image;
}

TEST(Segments, AreWhatDoublePrecisionSays) {
  for (const bool along_rays : {false, true})
    for (const TexelType type : {TexelType::u8, TexelType::u16, TexelType::f32})
      for (const Wrap wrap : {Wrap::edge, Wrap::border})
        for (const Operator op : {Operator::over, Operator::max, Operator::min, Operator::add}) {
          Texture texture = sampled(describe({45, 38, 51}, type, wrap), marschner_lobb_field());
          RenderRequest request = slice_segments_of(texture, along_rays);
          request.op = op;
          if (op == Operator::max)
            std::get<PreIntegrationTable>(request.classification).multiply_by_alpha = false;
          FrameCounts counts;
          const Image image = drawn(filled(texture), request, counts);
          const ReferenceImage reference = slice_sum(
              texture_field(texture.description, request.filter, texture.texels), request, request.window);
          const Difference d = difference(image, reference, 1e-3);
          std::printf("along rays %d, texels %d, wrap %d, operator %d: max %.2e, rms %.2e\n", along_rays,
                      int(type), int(wrap), int(op), d.max, d.rms);
          // 1e-5 corresponds to 100 dB. A ray that grazes the region may have one sample more.
          EXPECT_LE(d.rms, op == Operator::add ? 1e-4 : 1e-5);
          EXPECT_LE(d.pixels_over, op == Operator::min ? 6 : 4);
        }
}

TEST(Segments, OneRankOrFourGiveOneImage) {
  for (const bool along_rays : {false, true})
    for (int ranks = 2; ranks <= 4; ++ranks) {
      Texture texture = noise(describe({45, 38, 51}, TexelType::u8), 5);
      RenderRequest request = slice_segments_of(texture, along_rays);
      FrameCounts one_count, count;
      const Image one = drawn(filled(texture), request, one_count);
      const KdTree tree(texture.description, ranks);
      Image all(request.window);
      for (const int rank : tree.visibility_order(request)) {
        const BrickStore store = filled(texture, tree.box(rank));
        Image part(footprint(request, texture.description, tree.box(rank)));
        raycast(store, request, part, count);
        for (int y = part.rect.y; y < part.rect.y + part.rect.height; ++y)
          for (int x = part.rect.x; x < part.rect.x + part.rect.width; ++x) {
            const float room = 1 - all.at(x, y)[3];
            for (int k = 0; k < 4; ++k) all.at(x, y)[k] += room * part.at(x, y)[k];
          }
      }
      const double d = difference(one, all).max;
      std::printf("%d ranks, along rays %d: largest difference %.2e\n", ranks, along_rays, d);
      EXPECT_LE(d, 1e-5);
      EXPECT_EQ(one_count.samples, count.samples);
    }
}

TEST(Segments, AGhostLayerTooSmallIsRefused) {
  Texture texture = noise(describe({45, 38, 51}, TexelType::u8), 5);
  RenderRequest request = slice_segments_of(texture, false);
  texture.description.ghost_layer = 0;
  FrameCounts counts;
  const BrickStore store = filled(texture);
  EXPECT_THROW(drawn(store, request, counts), std::invalid_argument);
  request.slice_segment.reset();
  EXPECT_THROW(drawn(store, request, counts), std::invalid_argument) << "pairs without segments";
}

/// A segment may be visible at its back only: blocks with clear fronts lie beside visible blocks.
TEST(Segments, BeyondABorderWithoutAFilterAreRefused) {
  Texture texture = noise(describe({45, 38, 51}, TexelType::u8, Wrap::border), 5);
  RenderRequest request = slice_segments_of(texture, false);
  EXPECT_NO_THROW(validate(texture.description, request));
  request.filter = Filter::nearest;
  EXPECT_THROW(validate(texture.description, request), std::invalid_argument);
  texture.description.wrap.fill(Wrap::edge);
  EXPECT_NO_THROW(validate(texture.description, request));
}

TEST(Segments, SkippingLeavesNoSegmentOut) {
  for (const bool along_rays : {false, true}) {
    Texture texture = sampled(describe({64, 64, 64}, TexelType::u8), sphere_field(0.2, 0.01));
    RenderRequest request = slice_segments_of(texture, along_rays);
    request.classification = banded_pairs(33, 0.3F);
    texture.description.ghost_layer = 16;
    FrameCounts counts;
    const Image image = drawn(filled(texture), request, counts);
    EXPECT_GT(counts.blocks_empty, counts.blocks / 4);
    EXPECT_LT(counts.blocks_empty, counts.blocks);
    EXPECT_LT(counts.samples_taken, counts.samples / 2);
    const ReferenceImage reference =
        slice_sum(texture_field(texture.description, request.filter, texture.texels), request, request.window);
    EXPECT_LE(difference(image, reference, 1e-3).pixels_over, 4) << "along rays " << along_rays;
  }
}

TEST(Segments, OpaqueOnesEndTheirRays) {
  Texture texture = noise(describe({45, 38, 51}, TexelType::u8), 5);
  RenderRequest request = slice_segments_of(texture, false);
  FrameCounts all, fewer;
  const Image whole = drawn(filled(texture), request, all);
  request.termination = 5e-6F;
  const Image ended = drawn(filled(texture), request, fewer);
  EXPECT_GT(fewer.rays_terminated, 0U);
  EXPECT_LT(fewer.samples_taken, all.samples_taken);
  EXPECT_LE(difference(whole, ended).max, 1e-5);
}

TEST(Segments, AllInstructionSetsDrawTheSameImage) {
  for (const TexelType type : {TexelType::u8, TexelType::u16, TexelType::f32}) {
    Texture texture = noise(describe({45, 38, 51}, type, Wrap::border), 9);
    if (type == TexelType::f32) {
      const float nan = std::nanf("");
      for (std::size_t i = 0; i < texture.texels.size() / 4; i += 97)
        std::memcpy(texture.texels.data() + 4 * i, &nan, sizeof nan);
    }
    const RenderRequest request = slice_segments_of(texture, false);
    const BrickStore store = filled(texture);
    const std::int64_t here = hwy::SupportedTargets();
    std::optional<Image> plain;
    for (const std::int64_t target : {HWY_EMU128, HWY_SSE4, HWY_AVX2, HWY_AVX3}) {
      if (target != HWY_EMU128 && (here & target) == 0) continue;
      hwy::SetSupportedTargetsForTest(target);
      hwy::GetChosenTarget().Update(hwy::SupportedTargets());
      FrameCounts counts;
      const Image image = drawn(store, request, counts);
      if (!plain) plain = image;
      const double d = difference(image, *plain).max;
      std::printf("texels %d, %s: largest difference %.2e\n", int(type), instruction_set(), d);
      EXPECT_LE(d, 3e-4) << instruction_set();
    }
    hwy::SetSupportedTargetsForTest(0);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
}

TEST(Segments, WhatShowsIsFoundForAnyTwoRanges) {
  PreIntegrationTable table;
  table.edge = 17;
  table.entries.resize(17 * 17);
  table.entries[12 * 17 + 3] = {1, 1, 1, 0.5F};  // front 3 / 16, back 12 / 16
  const PreIntegrationLookup pairs(table, TexelType::f32, 0);
  const auto at = [](int from, int to) { return BrickStore::Range{float(from) / 16, float(to) / 16}; };
  for (int a = 0; a < 16; ++a)
    for (int b = a; b <= 16; ++b) {
      EXPECT_EQ(pairs.shows(at(a, b), at(12, 12)), a <= 3 && b >= 3) << a << " " << b;
      EXPECT_EQ(pairs.shows(at(3, 3), at(a, b)), a <= 12 && b >= 12) << a << " " << b;
    }
  EXPECT_FALSE(pairs.shows({1, 0}, at(0, 16))) << "a block without values";
}

}  // namespace
}  // namespace understudy::volume::testing
