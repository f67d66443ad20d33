// SPDX-License-Identifier: Apache-2.0
// Pre-integrated segments with transfer functions that end within the field's values. Beyond an end the medium
// is that of the end, so a segment that crosses it is split there.
#include <gtest/gtest.h>

#include "tests/volume/segment_scenes.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/request.h"

namespace understudy::volume::testing {
namespace {

struct Ends {
  const char* name;
  float low, high;
  float opacity;  ///< of the last entry; the first has half of it, or 0
  bool first_shows;
};
constexpr Ends tables[] = {{"the middle four fifths", 0.1F, 0.9F, 0.25F, true},
                           {"a window", 0.45F, 0.55F, 0.25F, true},
                           {"from the middle on", 0.5F, 2, 0.25F, false},
                           {"up to the middle", -1, 0.5F, 0.15F, true},
                           {"beyond all values", 1.5F, 2, 0.25F, true}};

TransferFunction table_of(const Ends& ends) {
  TransferFunction table{ends.low, ends.high, {}};
  for (int i = 0; i < 33; ++i) {
    const float s = float(i) / 32;
    const float a = ends.opacity * (ends.first_shows ? 0.5F + 0.5F * s : s);
    table.entries.push_back({a * s, a * (1 - s), 0.5F * a, a});
  }
  return table;
}

RenderRequest request_of(Texture& texture, const Ends& ends, bool cut, bool lit) {
  RenderRequest request = request_on_steps(texture);
  request.method = Method::pre_integrated;
  request.classification = table_of(ends);
  if (cut) {
    request.steps->first = 0.4;
    request.clip_planes = {{{1, 0.3, -0.2}, -0.35}};
    request.surfaces = {{0.6, {0.9F, 0.2F, 0.1F, 0.5F}}};
  }
  if (lit) request.light = some_light();
  give_ghost_layer(texture, request);
  return request;
}

TEST(TableEnds, AreWhereDoublePrecisionSays) {
  for (const Ends& ends : tables)
    for (const TexelType type : {TexelType::u8, TexelType::u16, TexelType::f32})
      for (const bool cut : {false, true}) {
        const bool lit = cut && type == TexelType::f32;
        Texture texture = sampled(describe({40, 37, 43}, type), sphere_field(0.3, 0.2));
        RenderRequest request = request_of(texture, ends, cut, lit);
        request.window = {10, 12, 20, 15};  // quadrature is slow
        FrameCounts one, four;
        const Image image = drawn(texture, request, one);
        const Difference d = difference(image, expected(texture, request), 1e-3);
        const double apart = difference(image, drawn_in_parts(texture, request, 4, four)).max;
        std::printf("%-24s texels %d, cut %d: max %.1e, rms %.1e; four ranks from one %.1e\n", ends.name,
                    int(type), cut, d.max, d.rms, apart);
        EXPECT_LE(d.pixels_over, cut ? pixels_that_graze : 0) << ends.name;
        EXPECT_LE(d.rms, 1e-4) << ends.name;
        EXPECT_LE(apart, 1e-5) << ends.name;
      }
}

TEST(TableEnds, MakeNoDifferenceWhereTheTableGoesOnAsItEnds) {
  // The same function defined over more values than the field has: its segments need no splitting.
  const Ends ends = tables[0];
  for (const TexelType type : {TexelType::u8, TexelType::f32}) {
    Texture texture = noise(describe({40, 37, 43}, type), 9);
    RenderRequest request = request_of(texture, ends, false, false);
    FrameCounts counts;
    const Image parted = drawn(texture, request, counts);
    TransferFunction& table = std::get<TransferFunction>(request.classification);
    constexpr std::size_t more = 8;
    table.entries.insert(table.entries.begin(), more, table.entries.front());
    table.entries.insert(table.entries.end(), more, table.entries.back());
    const float entry = (ends.high - ends.low) / 32;
    table.low -= entry * float(more);
    table.high += entry * float(more);
    const Difference d = difference(parted, drawn(texture, request, counts));
    std::printf("texels %d: max %.1e, rms %.1e\n", int(type), d.max, d.rms);
    EXPECT_LE(d.max, 5e-4);
    EXPECT_LE(d.rms, 5e-5);
  }
}

TEST(TableEnds, OfFieldsWithHugeValuesAreFinite) {
  const float huge = std::numeric_limits<float>::infinity();
  Texture texture = noise(describe({13, 12, 11}, TexelType::f32), 3);
  const std::vector<float> values{0, huge, 0.4F, -huge, 1, std::nanf(""), 1e30F, -1e-40F};
  for (std::size_t i = 0; i < texture.texels.size() / 4; ++i)
    std::memcpy(texture.texels.data() + 4 * i, &values[i % values.size()], 4);
  for (const Ends& ends : tables) {
    const RenderRequest request = request_of(texture, ends, true, true);
    FrameCounts counts;
    for (const float v : drawn(texture, request, counts).rgba) ASSERT_TRUE(std::isfinite(v)) << ends.name;
  }
}

}  // namespace
}  // namespace understudy::volume::testing
