// SPDX-License-Identifier: Apache-2.0
// Samples on constant steps along the rays, as ray casters in a fragment shader take them, compared with the
// double-precision reference; the image is the same for any partition.
#include <gtest/gtest.h>

#include <limits>
#include <optional>
#include <stdexcept>

#include "tests/volume/scenes.h"
#include "volume/footprint.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/kd_tree.h"
#include "volume/raycast/ray_caster.h"
#include "volume/request.h"

namespace understudy::volume::testing {
namespace {

/// Steps of `length` in a space that is stretched and sheared relative to texture space.
RaySteps steps_of(double length) {
  RaySteps steps;
  steps.metric = {1.0 / length, 0.1 / length, 0, 0, 0.8 / length, 0, 0.2 / length, 0, 1.3 / length};
  return steps;
}

Matrix4 parallel_camera() {
  return multiply(parallel(0.9, 0.8, -5, 5),
                  multiply(look_at({0.9, 0.7, 1.6}, {0, 0, 0}, {0, 1, 0}), unit_cube()));
}

struct Case {
  const char* name;
  Matrix4 camera;
  double first;
  bool divided;
  Operator op;
  bool offset = false;                      ///< every ray has its own offset
  std::optional<double> counted_from = {};  ///< as in RaySteps
  bool at_least_one = false;                ///< as in RaySteps
};

std::vector<Case> cases() {
  const Matrix4 usual = usual_camera(45, 39);
  return {{"perspective, one step in", usual, 1, false, Operator::over},
          {"perspective, from the entry", usual, 0, false, Operator::over},
          {"perspective, divided", usual, 0, true, Operator::over},
          {"perspective, divided, middles", usual, 0.5, true, Operator::add},
          {"parallel, half a step in", parallel_camera(), 0.5, false, Operator::over},
          {"parallel, divided, maximum", parallel_camera(), 0, true, Operator::max},
          {"perspective, noise at the entry", usual, 0, false, Operator::over, true},
          {"parallel, noise half a step in", parallel_camera(), 0.5, false, Operator::add, true},
          {"perspective, samples moved by noise", usual, 0, false, Operator::over, true, 0},
          {"parallel, samples moved by noise, maximum", parallel_camera(), 0, false, Operator::max, true, 0},
          {"perspective, parts moved by noise", usual, 0, true, Operator::add, true, 0},
          {"perspective, a part of a step beyond", usual, 0.5, false, Operator::over, false, 0},
          {"parallel, a whole step beyond", parallel_camera(), 1, false, Operator::add, false, 0},
          {"perspective, a step less", usual, 0, false, Operator::over, false, 1},
          {"perspective, long steps by noise, one at least", usual, 0, false, Operator::over, true, {}, true},
          {"parallel, a step and a half in, one at least",
           parallel_camera(),
           1.5,
           false,
           Operator::max,
           false,
           {},
           true},
          {"perspective, divided, one at least", usual, 0.5, true, Operator::over, false, {}, true}};
}

RenderRequest request_of(const Texture& texture, const Case& c) {
  RenderRequest request = request_for(texture, c.camera, 45, 39, 0);
  request.steps = steps_of(0.031);
  request.steps->first = c.first;
  request.steps->divided = c.divided;
  if (c.offset) request.steps->offsets = RayOffsets{3, 2, {0.1F, 0.9F, 0.4F, 0.7F, 0, 0.3F}};
  request.op = c.op;
  request.steps->counted_from = c.counted_from;
  request.steps->at_least_one = c.at_least_one;
  // Steps as long as the box is deep: most rays are too short for their first sample.
  if (c.at_least_one)
    for (double& number : request.steps->metric) number /= 20;
  if (!c.counted_from && !c.at_least_one) request.region = {{0.03, 0, 0.05}, {0.97, 0.9, 1}};
  return request;
}

void compose(Operator op, float* front, const float* back) {
  const float room = 1 - front[3];
  for (int k = 0; k < 4; ++k)
    front[k] = op == Operator::over  ? front[k] + room * back[k]
               : op == Operator::add ? front[k] + back[k]
                                     : std::max(front[k], back[k]);
}

/// A sample exactly at the end of its ray may count in one image and not in the other.
constexpr int pixels_at_the_end = 3;

TEST(RaySteps, GiveTheImageOfTheReference) {
  for (const TexelType type : {TexelType::u8, TexelType::f32}) {
    const Texture texture = noise(describe({37, 29, 41}, type, Wrap::edge), 5);
    const Field field = texture_field(texture.description, Filter::linear, texture.texels);
    const BrickStore store = filled(texture);
    for (const Case& c : cases()) {
      RenderRequest request = request_of(texture, c);
      Image image(request.window);
      FrameCounts counts;
      raycast(store, request, image, counts);
      EXPECT_GT(counts.samples, c.at_least_one ? 800U : 10000U) << c.name;
      const Difference d = difference(image, slice_sum(field, request, request.window), 1e-3);
      std::printf("%s: largest %.1e, rms %.1e\n", c.name, d.max, d.rms);
      EXPECT_LE(d.pixels_over, pixels_at_the_end) << c.name;
      EXPECT_LE(d.rms, 3e-4) << c.name;
      // Another rule gives another image, so the comparison can fail.
      request.steps->first += c.divided ? 0.3 : 0.5;
      if (c.op == Operator::over) {
        EXPECT_GT(difference(image, slice_sum(field, request, request.window)).rms, 1e-3) << c.name;
      }
    }
  }
}

TEST(RaySteps, EndAtOpaqueGeometryAndClipPlanes) {
  const Texture texture = noise(describe({37, 29, 41}, TexelType::u8, Wrap::edge), 6);
  const Field field = texture_field(texture.description, Filter::linear, texture.texels);
  const BrickStore store = filled(texture);
  for (const double past : {0.0, 1.0})
    for (const Case& c : cases()) {
      if (c.counted_from) continue;  // does not support clip planes
      RenderRequest request = request_of(texture, c);
      request.steps->past_depth = past;
      if (!c.at_least_one) request.clip_planes = {{{1, 0.3, -0.2}, -0.2}};
      const auto whole = slice_sum(field, request, request.window);
      DepthImage depth;
      depth.rect = request.window;
      // A tilted wall through the middle of the volume.
      const Vec4 middle = transform_point(c.camera, {0.5, 0.5, 0.5}),
                 end = transform_point(c.camera, {1, 0.2, 0.9});
      const double there = (middle[2] / middle[3] + 1) / 2, slope = (end[2] / end[3] + 1) / 2 - there;
      const int half = depth.rect.width / 2;
      for (int y = 0; y < depth.rect.height; ++y)
        for (int x = 0; x < depth.rect.width; ++x)
          depth.depth.push_back(float(there + slope * (x - half) / depth.rect.width));
      request.depth = depth;
      Image image(request.window);
      FrameCounts counts;
      raycast(store, request, image, counts);
      const auto reference = slice_sum(field, request, request.window);
      const Difference d = difference(image, reference, 1e-3);
      EXPECT_LE(d.pixels_over, pixels_at_the_end) << c.name << ", " << past << " steps past the depth";
      EXPECT_GT(difference(whole, reference).rms, 1e-3) << "the wall hides nothing: the test tests nothing";
    }
}

TEST(RaySteps, OfRaysThatEnterBehindTheFarPlaneHaveNoSample) {
  const Texture texture = noise(describe({37, 29, 41}, TexelType::u8, Wrap::edge), 8);
  const Field field = texture_field(texture.description, Filter::linear, texture.texels);
  for (const Case& c : cases()) {
    if (!c.at_least_one) continue;
    RenderRequest request = request_of(texture, c);
    // Moves the far plane into the volume: z reaches w at a smaller depth.
    for (std::size_t k = 0; k < 4; ++k)
      request.texture_to_clip[8 + k] += 0.04 * request.texture_to_clip[12 + k];
    Image image(request.window);
    FrameCounts counts;
    raycast(filled(texture), request, image, counts);
    EXPECT_LE(difference(image, slice_sum(field, request, request.window), 1e-3).pixels_over, pixels_at_the_end)
        << c.name;
  }
}

TEST(RaySteps, GiveTheSameImageForAnyPartition) {
  double worst = 0;
  for (int ranks = 2; ranks <= 9; ++ranks)
    for (const Case& c : cases()) {
      const Texture texture = noise(describe({37, 29, 41}, TexelType::u8, Wrap::edge), unsigned(ranks));
      const RenderRequest request = request_of(texture, c);
      Image one(request.window), many(request.window);
      FrameCounts counts_of_one, counts_of_many;
      raycast(filled(texture), request, one, counts_of_one);
      const KdTree tree(texture.description, ranks);
      for (const int rank : tree.visibility_order(request)) {
        Image part(footprint(request, texture.description, tree.box(rank)));
        raycast(filled(texture, tree.box(rank)), request, part, counts_of_many);
        for (int y = part.rect.y; y < part.rect.y + part.rect.height; ++y)
          for (int x = part.rect.x; x < part.rect.x + part.rect.width; ++x)
            compose(c.op, many.at(x, y), part.at(x, y));
      }
      EXPECT_EQ(counts_of_one.samples, counts_of_many.samples) << c.name << ", " << ranks << " ranks";
      const double d = difference(one, many).max;
      worst = std::max(worst, d);
      EXPECT_LE(d, c.op == Operator::add ? 2e-5 : 1e-5) << c.name << ", " << ranks << " ranks";
    }
  std::printf("2 to 9 ranks against 1: largest difference %.2e\n", worst);
}

/// What a maximum projection skips does not change the image.
TEST(RaySteps, UnderARisingTableAMaximumPassesByWhatAddsNothing) {
  for (const float lowest : {0.0F, 1.0F}) {
    Texture texture = noise(describe({64, 64, 64}, TexelType::u8, Wrap::edge), 9);
    // Brighter towards one corner, so that whole blocks are darker than others.
    for (std::size_t i = 0; i < texture.texels.size(); ++i) {
      const std::size_t x = i % 64, y = i / 64 % 64, z = i / 4096;
      texture.texels[i] = std::byte(std::to_integer<std::size_t>(texture.texels[i]) * (x + y + z) / 192);
    }
    RenderRequest request = request_of(texture, cases().front());
    request.op = Operator::max;
    request.classification = TransferFunction{0, 1, {{0, 0, 0, lowest}, {1, 0, 0, 1}}};
    Image image(request.window);
    FrameCounts counts;
    raycast(filled(texture), request, image, counts);
    const Field field = texture_field(texture.description, Filter::linear, texture.texels);
    const Difference d = difference(image, slice_sum(field, request, request.window), 1e-3);
    EXPECT_LE(d.pixels_over, pixels_at_the_end);
    EXPECT_LE(d.rms, 3e-4);
    std::printf("%llu of %llu samples taken\n", static_cast<unsigned long long>(counts.samples_taken),
                static_cast<unsigned long long>(counts.samples));
    EXPECT_LT(counts.samples_taken, counts.samples * 3 / 4);
  }
}

TEST(RaySteps, WithoutSenseAreRefused) {
  const Texture texture = noise(describe({9, 9, 9}, TexelType::u8, Wrap::edge), 1);
  const RenderRequest good = request_of(texture, cases().front());
  EXPECT_NO_THROW(validate(texture.description, good));
  RenderRequest bad = good;
  bad.steps->metric = {1, 0, 0, 2, 0, 0, 0, 0, 1};
  EXPECT_THROW(validate(texture.description, bad), std::invalid_argument);
  bad = good;
  bad.steps->metric[4] = NAN;
  EXPECT_THROW(validate(texture.description, bad), std::invalid_argument);
  bad = good;
  for (double& m : bad.steps->metric) m *= 1e6;
  EXPECT_THROW(validate(texture.description, bad), std::invalid_argument);
  bad = good;
  bad.steps->first = -1;
  EXPECT_THROW(validate(texture.description, bad), std::invalid_argument);
  bad = good;
  bad.steps->offsets = RayOffsets{3, 2, {0, 0, 0, 0, 0}};
  EXPECT_THROW(validate(texture.description, bad), std::invalid_argument) << "no rectangle";
  bad.steps->offsets = RayOffsets{1, 1, {-1.5F}};
  EXPECT_THROW(validate(texture.description, bad), std::invalid_argument) << "before the entry";
  bad = good;
  bad.steps->counted_from = 0;
  EXPECT_THROW(validate(texture.description, bad), std::invalid_argument) << "not the whole texture";
  bad.region = {{0, 0, 0}, {1, 1, 1}};
  EXPECT_NO_THROW(validate(texture.description, bad));
  bad.clip_planes = {{{1, 0, 0}, -0.5}};
  EXPECT_THROW(validate(texture.description, bad), std::invalid_argument) << "a clip plane";
  bad.clip_planes.clear();
  Texture repeating = texture;
  repeating.description.wrap[1] = Wrap::repeat;
  bad.steps->first = 0;
  EXPECT_NO_THROW(validate(repeating.description, bad)) << "none lies beyond";
  bad.steps->first = 0.5;
  EXPECT_NO_THROW(validate(texture.description, bad));
  EXPECT_THROW(validate(repeating.description, bad), std::invalid_argument) << "a texture that repeats";
  Texture bordered = texture;
  bordered.description.wrap[2] = Wrap::border;
  EXPECT_NO_THROW(validate(bordered.description, bad));
  bad.filter = Filter::nearest;
  EXPECT_NO_THROW(validate(texture.description, bad));
  EXPECT_THROW(validate(bordered.description, bad), std::invalid_argument) << "a border without a filter";
  bad.steps->first = 0;
  EXPECT_NO_THROW(validate(bordered.description, bad)) << "none lies beyond";
  bad.region.high[2] = 1.1;
  EXPECT_THROW(validate(bordered.description, bad), std::invalid_argument) << "rays reach beyond the texture";
  bad.region.high[2] = 1;
  bad.filter = Filter::linear;
  bad.steps->first = 20;
  EXPECT_THROW(validate(texture.description, bad), std::invalid_argument) << "far beyond";
  bad.steps->first = good.steps->first;
  for (const double from : {-1.0, 1e9, std::numeric_limits<double>::quiet_NaN()}) {
    bad.steps->counted_from = from;
    EXPECT_THROW(validate(texture.description, bad), std::invalid_argument) << "counted from " << from;
  }
  bad = good;
  bad.steps->first = 1;
  bad.steps->at_least_one = true;
  EXPECT_THROW(validate(texture.description, bad), std::invalid_argument) << "not the whole texture";
  bad.steps->divided = true;
  EXPECT_NO_THROW(validate(texture.description, bad)) << "none lies beyond";
  bad.steps->first = 1.5;
  EXPECT_THROW(validate(texture.description, bad), std::invalid_argument) << "beyond its one part";
  bad.steps->first = 1;
  bad.steps->divided = false;
  bad.region = {{0, 0, 0}, {1, 1, 1}};
  EXPECT_NO_THROW(validate(texture.description, bad));
  EXPECT_THROW(validate(repeating.description, bad), std::invalid_argument) << "a texture that repeats";
  EXPECT_NO_THROW(validate(bordered.description, bad));
  bad.filter = Filter::nearest;
  EXPECT_THROW(validate(bordered.description, bad), std::invalid_argument) << "a border without a filter";
}

}  // namespace
}  // namespace understudy::volume::testing
