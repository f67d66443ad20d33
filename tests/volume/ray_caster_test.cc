// SPDX-License-Identifier: Apache-2.0
#include "volume/raycast/ray_caster.h"

#include <gmock/gmock.h>

#include <string>

#include "tests/volume/scenes.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/request.h"

namespace understudy::volume::testing {
namespace {

Image render(const Texture& texture, const RenderRequest& request, FrameCounts* counts = nullptr) {
  const BrickStore store = filled(texture);
  Image image(request.window);
  FrameCounts mine;
  raycast(store, request, image, mine);
  if (counts) *counts = mine;
  return image;
}

ReferenceImage reference(const Texture& texture, const RenderRequest& request) {
  return slice_sum(texture_field(texture.description, request.filter, texture.texels), request, request.window);
}

/// Renders with both, expects them to agree within `bound`, and returns the difference.
Difference expect_like_reference(const Texture& texture, const RenderRequest& request, double bound,
                                 const char* what) {
  const ReferenceImage expected = reference(texture, request);
  const Difference d = difference(render(texture, request), expected, bound);
  const double shown = *std::max_element(expected.rgba.begin(), expected.rgba.end());
  EXPECT_LE(d.max, bound) << what << ", " << d.pixels_over << " pixels";
  EXPECT_GT(shown, 0.01) << what << ": the image is empty, nothing was tested";
  return d;
}

const char* name(TexelType type) {
  return type == TexelType::u8    ? "u8"
         : type == TexelType::u16 ? "u16"
         : type == TexelType::f32 ? "f32"
                                  : "rgba8";
}
const char* name(Wrap wrap) {
  return wrap == Wrap::edge ? "edge" : wrap == Wrap::border ? "border" : "repeat";
}
const char* name(Operator op) {
  return op == Operator::over ? "over" : op == Operator::max ? "max" : op == Operator::min ? "min" : "add";
}

constexpr TexelType all_types[] = {TexelType::u8, TexelType::u16, TexelType::f32, TexelType::rgba8};

TEST(RayCaster, EqualsTheSlicesForEveryTexelTypeAndWrap) {
  double worst = 0;
  for (const TexelType type : all_types)
    for (const Wrap wrap : {Wrap::edge, Wrap::border, Wrap::repeat}) {
      const Texture texture = noise(describe({19, 23, 13}, type, wrap), 11);
      const RenderRequest request = request_for(texture, usual_camera(41, 37), 41, 37, 30);
      const auto what = std::string(name(type)) + " " + name(wrap);
      worst = std::max(worst, expect_like_reference(texture, request, 5e-5, what.c_str()).max);
    }
  std::printf("largest difference %.2e\n", worst);
}

TEST(RayCaster, EqualsTheSlicesForEveryOperator) {
  for (const TexelType type : all_types)
    for (const Operator op : {Operator::over, Operator::max, Operator::min, Operator::add}) {
      const Texture texture = noise(describe({19, 23, 13}, type), 12);
      RenderRequest request = request_for(texture, usual_camera(41, 37), 41, 37, 30);
      request.op = op;
      const auto what = std::string(name(type)) + " " + name(op);
      const Difference d = expect_like_reference(texture, request, 1e-4, what.c_str());
      std::printf("%s: %.2e\n", what.c_str(), d.max);
    }
}

/// A red haze that increases from one corner to the opposite one, with a kink.
Fog red_haze() {
  Fog fog{.normal = {0.5, 0.6, -0.4}, .offset = 0.3, .entries = {}};
  for (int i = 0; i < 65; ++i) {
    const float weight = std::max(0.0F, 1 - float(i) / 50);
    fog.entries.push_back({0.7F * (1 - weight), 0.1F * (1 - weight), 0, weight});
  }
  return fog;
}

TEST(RayCaster, EqualsTheSlicesInFog) {
  for (const TexelType type : all_types) {
    const Texture texture = noise(describe({19, 23, 13}, type), 15);
    for (const Operator op : {Operator::over, Operator::max, Operator::add}) {
      RenderRequest request = request_for(texture, usual_camera(41, 37), 41, 37, 30);
      request.op = op;
      const Image clear = render(texture, request);
      request.fog = red_haze();
      const auto what = std::string(name(type)) + " " + name(op);
      expect_like_reference(texture, request, 2e-4, what.c_str());
      EXPECT_GT(difference(render(texture, request), clear).max, 0.05) << what << ": the fog is not to be seen";
    }
  }
}

TEST(RayCaster, KnowsTheClassificationsOfTheLastTwoRequests) {
  const Texture texture = noise(describe({19, 23, 13}, TexelType::u8), 16);
  const BrickStore store = filled(texture);
  RayCaster caster(store);
  std::array<RenderRequest, 3> requests;
  for (std::size_t i = 0; i < requests.size(); ++i) {
    requests[i] = request_for(texture, usual_camera(41, 37), 41, 37, 30);
    requests[i].classification = smooth_table(256, 0.1F * float(i + 1));
  }
  for (const std::size_t i : {0, 1, 0, 1, 2, 0, 2, 1, 1}) {
    Image image(requests[i].window);
    FrameCounts counts;
    caster.render(requests[i], image, counts);
    EXPECT_EQ(image.rgba, render(texture, requests[i]).rgba) << "classification " << i;
  }
}

TEST(RayCaster, EqualsTheSlicesWithTheNearestFilter) {
  for (const TexelType type : all_types) {
    const Texture texture = noise(describe({19, 23, 13}, type), 13);
    RenderRequest request = request_for(texture, usual_camera(41, 37), 41, 37, 30);
    request.filter = Filter::nearest;
    expect_like_reference(texture, request, 5e-5, name(type));
  }
}

struct Camera {
  const char* name;
  Matrix4 texture_to_clip;
};

std::vector<Camera> cameras(int width, int height) {
  const double aspect = double(width) / height;
  const Matrix4 view = look_at({0.9, 0.7, 1.6}, {0, 0, 0}, {0, 1, 0});
  const Matrix4 lens = perspective(40, aspect, 0.1, 10);
  const Matrix4 mirror{-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  const Matrix4 shear{1, 0.4, 0.1, 0, 0, 1, -0.3, 0, 0.2, 0, 1, 0, 0, 0, 0, 1};
  const Matrix4 inside = look_at({0.1, -0.05, 0.12}, {0.5, 0.4, -0.6}, {0, 1, 0});
  const Matrix4 on_face = look_at({0, 0, 0.5}, {0.1, 0.05, 0}, {0, 1, 0});
  const Matrix4 on_corner = look_at({0.5, 0.5, 0.5}, {0, 0, 0}, {0, 1, 0});
  const Matrix4 along_axis = look_at({0, 0, 2}, {0, 0, 0}, {0, 1, 0});
  const Matrix4 squeezed{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1e-6, 0, 0, 0, 0, 1};
  const auto seen = [&](const Matrix4& projection, const Matrix4& look) {
    return multiply(projection, multiply(look, unit_cube()));
  };
  return {
      {"perspective", seen(lens, view)},
      {"parallel", seen(parallel(0.9 * aspect, 0.9, 0.1, 10), view)},
      {"mirrored", seen(lens, multiply(view, mirror))},
      {"sheared", seen(lens, multiply(view, shear))},
      {"camera inside", seen(perspective(70, aspect, 0.01, 10), inside)},
      {"camera on a face", seen(perspective(70, aspect, 0.001, 10), on_face)},
      {"camera on a corner", seen(perspective(70, aspect, 0.001, 10), on_corner)},
      {"near plane cuts", seen(perspective(40, aspect, 1.9, 10), view)},
      {"far plane cuts", seen(perspective(40, aspect, 0.1, 1.9), view)},
      {"rays along an axis", seen(parallel(0.6 * aspect, 0.6, 0.1, 10), along_axis)},
      {"anisotropy 1e6", seen(parallel(0.6 * aspect, 0.6, 0.1, 10), multiply(along_axis, squeezed))},
      {"near : far = 1e-12", seen(perspective(40, aspect, 1e-6, 1e6), view)},
  };
}

TEST(RayCaster, EqualsTheSlicesForEveryCamera) {
  for (const Camera& camera : cameras(41, 37))
    for (const TexelType type : {TexelType::u8, TexelType::f32}) {
      const Texture texture = noise(describe({19, 23, 13}, type), 14);
      const RenderRequest request = request_for(texture, camera.texture_to_clip, 41, 37, 30);
      const Difference d = expect_like_reference(texture, request, 1e-4, camera.name);
      std::printf("%-20s %-4s %.2e\n", camera.name, name(type), d.max);
    }
}

TEST(RayCaster, EqualsTheSlicesWhenPlanesDoNotFaceTheViewer) {
  for (const Camera& camera : cameras(41, 37)) {
    if (std::string(camera.name).starts_with("camera") || std::string(camera.name) == "anisotropy 1e6")
      continue;
    const Texture texture = noise(describe({19, 23, 13}, TexelType::u8), 15);
    RenderRequest request = request_for(texture, camera.texture_to_clip, 41, 37, 30);
    request.planes = {{0, 0, -3}, -2.983, 0.1, 30};
    expect_like_reference(texture, request, 1e-4, camera.name);
  }
}

TEST(RayCaster, EqualsTheSlicesForEveryExtent) {
  std::vector<std::array<int, 3>> sizes{{1, 1, 1},  {1, 9, 17}, {9, 1, 17}, {9, 17, 1},
                                        {1, 1, 33}, {33, 1, 1}, {1, 33, 1}};
  for (int n = 2; n <= 33; n += n < 8 ? 1 : 4) sizes.push_back({n, (n * 7) % 33 + 1, (n * 5) % 33 + 1});
  for (int n : {8, 9, 10, 16, 17, 18}) sizes.push_back({n, n, n});
  for (const auto& size : sizes)
    for (const Wrap wrap : {Wrap::edge, Wrap::border, Wrap::repeat})
      for (const TexelType type : {TexelType::u8, TexelType::f32}) {
        const Texture texture = noise(describe(size, type, wrap), 16);
        RenderRequest request = request_for(texture, usual_camera(23, 21), 23, 21, 20);
        if (type == TexelType::u8) request.classification = smooth_table(256, 0.5F);
        const auto what = std::to_string(size[0]) + "x" + std::to_string(size[1]) + "x" +
                          std::to_string(size[2]) + " " + name(wrap) + " " + name(type);
        const Difference d = difference(render(texture, request), reference(texture, request));
        EXPECT_LE(d.max, 1e-4) << what;
      }
}

TEST(RayCaster, CutsAtRegionClipPlanesAndWindow) {
  const Texture texture = noise(describe({19, 23, 13}, TexelType::u8), 17);
  RenderRequest request = request_for(texture, usual_camera(41, 37), 41, 37, 30);
  request.region = {{0.11, 0.23, 0.07}, {0.83, 0.91, 0.77}};
  request.clip_planes = {{{1, 0.5, -0.2}, -0.3}, {{-1, 0, 1}, 0.4}};
  request.window = {10, 11, 22, 19};
  expect_like_reference(texture, request, 5e-5, "cut");

  const Rect larger{0, 0, 60, 60};
  const BrickStore store = filled(texture);
  Image image(larger);
  FrameCounts counts;
  raycast(store, request, image, counts);
  for (int y = 0; y < larger.height; ++y)
    for (int x = 0; x < larger.width; ++x)
      if (x < 10 || x >= 32 || y < 11 || y >= 30) {
        ASSERT_EQ(image.at(x, y)[3], 0) << x << " " << y;
      }
}

TEST(RayCaster, DrawsOnlyTheStoredPartOfAPaddedTexture) {
  VolumeDescription padded = describe({32, 32, 32}, TexelType::u8, Wrap::border);
  padded.stored = {{0, 3, 5}, {20, 24, 32}};
  const Texture texture = noise(padded, 18);
  RenderRequest request = request_for(texture, usual_camera(41, 37), 41, 37, 30);
  request.region = {{0, 4 / 32.0, 6 / 32.0}, {19 / 32.0, 23 / 32.0, 1}};
  expect_like_reference(texture, request, 5e-5, "padded");
}

TEST(RayCaster, HidesSamplesBehindTheDepthImage) {
  for (const bool or_equal : {false, true}) {
    const Texture texture = noise(describe({19, 23, 13}, TexelType::u8), 19);
    RenderRequest request = request_for(texture, usual_camera(41, 37), 41, 37, 30);
    request.depth_range = {0.1, 0.8};
    DepthImage depth{{0, 0, 38, 60}, std::vector<float>(38 * 60), or_equal};
    std::mt19937 random(5);
    std::uniform_real_distribution<float> between(0.70F, 0.78F);
    for (float& d : depth.depth) d = between(random);
    const Difference open = difference(render(texture, request), reference(texture, request));
    request.depth = depth;
    expect_like_reference(texture, request, 5e-5, "depth");
    EXPECT_LE(open.max, 5e-5);
    RenderRequest without = request;
    without.depth.reset();
    EXPECT_GT(difference(render(texture, request), render(texture, without)).max, 0.01)
        << "the depth image hid nothing";
  }
}

TEST(RayCaster, SeesADepthTieAsTheDepthFunctionDoes) {
  // A parallel view along z with a plane exactly at window depth one half.
  const Texture texture = sampled(describe({8, 8, 8}, TexelType::u8), constant_field(1));
  RenderRequest request = request_for(texture, {2, 0, 0, -1, 0, 2, 0, -1, 0, 0, 2, -1, 0, 0, 0, 1}, 4, 4, 1);
  request.planes = {{0, 0, 1}, 0.5, 1, 1};
  DepthImage depth{request.window, std::vector<float>(16, 0.5F), false};
  request.depth = depth;
  EXPECT_EQ(render(texture, request).at(4, 6)[3], 0);
  request.depth->or_equal = true;
  EXPECT_NEAR(render(texture, request).at(4, 6)[3], 0.2, 1e-6);
}

TEST(RayCaster, ReachesTheAnalyticFieldsThroughTheTexture) {
  for (const auto& field : {sphere_field(0.35), marschner_lobb_field(), linear_field({0.3, 0.2, 0.4}, 0.05)}) {
    const Texture texture = sampled(describe({48, 48, 48}, TexelType::f32), field);
    const RenderRequest request = request_for(texture, usual_camera(33, 31), 33, 31, 60);
    expect_like_reference(texture, request, 5e-5, "analytic");
  }
}

TEST(RayCaster, KeepsThinFog) {
  // Each of 1000 layers has an opacity far below the spacing of floats next to 1.
  const Texture texture = sampled(describe({16, 16, 16}, TexelType::u8), constant_field(1));
  RenderRequest request = request_for(texture, {2, 0, 0, -1, 0, 2, 0, -1, 0, 0, 2, -1, 0, 0, 0, 1}, 8, 8, 1000);
  TransferFunction fog;
  fog.entries.assign(2, {1e-9F, 0, 0, 1e-9F});
  request.classification = fog;
  const float alpha = render(texture, request).at(6, 8)[3];
  std::printf("1000 layers of 1e-9: %.9g\n", double(alpha));
  EXPECT_NEAR(alpha, 1e-6, 1e-11);
}

TEST(RayCaster, StopsAtOpaqueSamples) {
  const Texture texture = noise(describe({19, 23, 13}, TexelType::u8), 20);
  RenderRequest request = request_for(texture, usual_camera(41, 37), 41, 37, 200);
  TransferFunction opaque;
  opaque.entries.assign(2, {0.5F, 0.25F, 0.125F, 1.0F});
  request.classification = opaque;
  request.termination = 5e-6F;
  FrameCounts counts;
  const Image image = render(texture, request, &counts);
  EXPECT_LE(difference(image, reference(texture, request)).max, 1e-6);
  EXPECT_GT(counts.rays_terminated, 0U);
  EXPECT_LT(counts.samples_taken, counts.samples / 4);
  std::printf("%llu of %llu samples taken\n", static_cast<unsigned long long>(counts.samples_taken),
              static_cast<unsigned long long>(counts.samples));
}

TEST(RayCaster, TerminationStaysWithinItsThreshold) {
  const Texture texture = noise(describe({33, 33, 33}, TexelType::u8), 21);
  RenderRequest request = request_for(texture, usual_camera(41, 37), 41, 37, 100);
  request.classification = smooth_table(256, 1.0F);
  const ReferenceImage all = reference(texture, request);
  for (const float threshold : {0.02F, 1e-3F, 1e-5F}) {
    request.termination = threshold;
    const double d = difference(render(texture, request), all).max;
    std::printf("threshold %g: difference %.2e\n", double(threshold), d);
    EXPECT_LE(d, threshold + 5e-5);
  }
}

TEST(RayCaster, SkipsEmptyBricksWithoutChangingTheImage) {
  for (const TexelType type : all_types) {
    const Texture texture = sampled(describe({70, 66, 50}, type), [](const Vec3& t) {
      const double r = std::hypot(t[0] - 0.3, t[1] - 0.35, t[2] - 0.6);
      return r < 0.15 ? 1 - r : 0.0;
    });
    RenderRequest request = request_for(texture, usual_camera(61, 57), 61, 57, 150);
    if (type == TexelType::rgba8) {
      LinearMap map;
      map.matrix = {1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0.5F};  // the second component shows air
      request.classification = map;
    }
    FrameCounts counts;
    render(texture, request, &counts);
    const Difference d = expect_like_reference(texture, request, 5e-5, name(type));
    std::printf("%s: %llu of %llu blocks empty, %llu of %llu samples taken, difference %.2e\n", name(type),
                static_cast<unsigned long long>(counts.blocks_empty),
                static_cast<unsigned long long>(counts.blocks),
                static_cast<unsigned long long>(counts.samples_taken),
                static_cast<unsigned long long>(counts.samples), d.max);
    EXPECT_GT(counts.blocks_empty, counts.blocks / 2);
    EXPECT_LT(counts.samples_taken, counts.samples / 4);
  }
}

TEST(RayCaster, CountsTheSamplesOfTheSlices) {
  // All texels are equal and almost transparent: the sum of alphas under `add` counts the samples.
  const Texture texture = sampled(describe({19, 23, 13}, TexelType::u8), constant_field(1));
  RenderRequest request = request_for(texture, usual_camera(41, 37), 41, 37, 30);
  TransferFunction one;
  one.entries.assign(2, {0, 0, 0, 1.0F});
  request.classification = one;
  request.op = Operator::add;
  FrameCounts counts;
  const Image image = render(texture, request, &counts);
  double sum = 0;
  std::uint64_t rays = 0;
  const ReferenceImage expected = reference(texture, request);
  for (std::size_t i = 3; i < expected.rgba.size(); i += 4) {
    sum += expected.rgba[i];
    rays += expected.rgba[i] > 0;
  }
  EXPECT_EQ(counts.samples, std::uint64_t(sum));
  EXPECT_EQ(counts.samples_taken, counts.samples);
  EXPECT_EQ(counts.rays, rays);
  EXPECT_LE(difference(image, expected).max, 1e-4);
}

TEST(RayCaster, FollowsAChangedClassification) {
  const Texture texture = noise(describe({19, 23, 13}, TexelType::u8), 22);
  const BrickStore store = filled(texture);
  RayCaster caster(store);
  RenderRequest request = request_for(texture, usual_camera(41, 37), 41, 37, 30);
  for (const Operator op : {Operator::over, Operator::min, Operator::over})
    for (const float opacity : {0.2F, 0.0F, 0.7F}) {
      request.op = op;
      request.classification = smooth_table(256, opacity);
      Image image(request.window);
      FrameCounts counts;
      caster.render(request, image, counts);
      EXPECT_LE(difference(image, reference(texture, request)).max, 1e-4) << opacity;
    }
}

TEST(RayCaster, RefusesFogThatCannotBe) {
  const Texture texture = noise(describe({5, 5, 5}, TexelType::u8), 24);
  const auto refused = [&](Operator op, auto change) {
    RenderRequest request = request_for(texture, usual_camera(8, 8), 8, 8, 4);
    request.op = op;
    request.fog = red_haze();
    change(*request.fog);
    EXPECT_THROW(render(texture, request), std::invalid_argument);
  };
  refused(Operator::min, [](Fog&) {});
  refused(Operator::over, [](Fog& fog) { fog.entries.resize(1); });
  refused(Operator::over, [](Fog& fog) { fog.entries[3][1] = NAN; });
  refused(Operator::over, [](Fog& fog) { fog.normal[2] = INFINITY; });
  refused(Operator::over, [](Fog& fog) { fog.offset = NAN; });
}

TEST(RayCaster, DiscardsFragmentsByAlpha) {
  const Texture texture = noise(describe({19, 23, 13}, TexelType::rgba8), 23);
  RenderRequest request = request_for(texture, usual_camera(41, 37), 41, 37, 30);
  for (const bool multiply_by_alpha : {true, false}) {
    LinearMap map;
    map.matrix = {0.5F, 0.2F, 0, 0, 0, 0.9F, 0, 0.1F, 0.3F, 0, 0.7F, 0, 0.1F, 0, 0, 0.8F};
    map.multiply_by_alpha = multiply_by_alpha;
    map.alpha_above = 0.02F;
    request.classification = map;
    expect_like_reference(texture, request, 5e-5, "alpha test");
  }
}

TEST(RayCaster, RefusesWhatCannotBeDrawnAndSaysWhy) {
  const Texture texture = noise(describe({5, 5, 5}, TexelType::u8), 24);
  const BrickStore store = filled(texture);
  const RenderRequest good = request_for(texture, usual_camera(8, 8), 8, 8, 4);
  const auto refusal = [&](auto change) {
    RenderRequest request = good;
    change(request);
    Image image(good.window);
    FrameCounts counts;
    try {
      raycast(store, request, image, counts);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("nothing refused");
  };
  using ::testing::HasSubstr;
  EXPECT_THAT(refusal([](RenderRequest&) {}), HasSubstr("nothing"));
  EXPECT_THAT(refusal([](RenderRequest& r) { r.texture_to_clip = Matrix4{}; }), HasSubstr("singular"));
  EXPECT_THAT(refusal([](RenderRequest& r) {
                for (int k = 0; k < 4; ++k) r.texture_to_clip[4 + k] = 0.1 * r.texture_to_clip[k];
              }),
              HasSubstr("singular"));
  EXPECT_THAT(refusal([](RenderRequest& r) { r.texture_to_clip[5] = NAN; }), HasSubstr("not finite"));
  EXPECT_THAT(refusal([](RenderRequest& r) { r.planes.normal = {}; }), HasSubstr("no direction"));
  EXPECT_THAT(refusal([](RenderRequest& r) { r.planes.count = max_planes + 1; }), HasSubstr("slice planes"));
  EXPECT_THAT(refusal([](RenderRequest& r) { r.viewport.width = 0; }), HasSubstr("viewport"));
  EXPECT_THAT(refusal([](RenderRequest& r) { r.classification = LinearMap{}; }),
              HasSubstr("transfer function"));
  EXPECT_THAT(refusal([](RenderRequest& r) { r.classification = TransferFunction{}; }), HasSubstr("0 entries"));
  EXPECT_THAT(refusal([](RenderRequest& r) {
                TransferFunction f = smooth_table();
                f.entries[3][1] = INFINITY;
                r.classification = f;
              }),
              HasSubstr("not finite"));
  EXPECT_THAT(refusal([](RenderRequest& r) { r.termination = 1; }), HasSubstr("termination"));
  EXPECT_THAT(refusal([](RenderRequest& r) {
                r.depth = DepthImage{{0, 0, 4, 4}, std::vector<float>(15), false};
              }),
              HasSubstr("depth image"));
  EXPECT_THAT(refusal([](RenderRequest& r) { r.clip_planes.resize(1000); }), HasSubstr("clip planes"));
  EXPECT_THAT(refusal([](RenderRequest& r) { r.region.low[1] = NAN; }), HasSubstr("region"));

  const BrickStore unfinished(texture.description, cell_lattice(texture.description).box());
  Image image(good.window);
  FrameCounts counts;
  EXPECT_THROW(raycast(unfinished, good, image, counts), std::logic_error);
}

TEST(RayCaster, DrawsNothingOnRaysAlongTheSlices) {
  const Texture texture = noise(describe({9, 9, 9}, TexelType::u8), 25);
  RenderRequest request = request_for(texture, {2, 0, 0, -1, 0, 2, 0, -1, 0, 0, 2, -1, 0, 0, 0, 1}, 8, 8, 8);
  request.planes = {{1, 0, 0}, 0.1, 0.1, 8};
  FrameCounts counts;
  const Image image = render(texture, request, &counts);
  EXPECT_EQ(counts.samples, 0U);
  EXPECT_EQ(*std::max_element(image.rgba.begin(), image.rgba.end()), 0);
}

}  // namespace
}  // namespace understudy::volume::testing
