// SPDX-License-Identifier: Apache-2.0
// Iso-surfaces and light, compared with closed forms and the double-precision reference; the image is the same
// for any partition.
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <optional>
#include <stdexcept>

#include "tests/volume/segment_scenes.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/raycast/surface_search.h"
#include "volume/reference/illumination.h"
#include "volume/reference/pixel_integral.h"
#include "volume/request.h"

namespace understudy::volume::testing {
namespace {

std::vector<Surface> two_veils() {
  return {{0.7, {0.9F, 0.2F, 0.1F, 0.8F}}, {0.35, {0.1F, 0.5F, 0.9F, 0.3F}}};
}

/// A haze with an opacity of 1 % per step attenuates an opaque white surface; the pixel's brightness gives the
/// number of steps in front of it.
constexpr double haze = 0.01;
RenderRequest through_haze(const Texture& texture, double iso) {
  RenderRequest request = request_on_steps(texture);
  request.method = Method::pre_integrated;
  request.classification = TransferFunction{0, 1, {{0, 0, 0, float(haze)}, {0, 0, 0, float(haze)}}};
  request.surfaces = {{iso, {1, 1, 1, 1}}};
  return request;
}

double steps_before(const float* pixel) {
  return std::log(double(pixel[0])) / std::log1p(-double(float(haze)));
}

TEST(Surfaces, AreFoundToAThousandthOfAVoxel) {
  for (const bool sphere : {false, true})
    for (const TexelType type : {TexelType::u8, TexelType::u16, TexelType::f32}) {
      const Vec3 slope{0.31, 0.22, 0.35};
      Texture texture =
          sampled(describe({40, 40, 40}, type), sphere ? sphere_field(0.3, 0.2) : linear_field(slope, 0.06));
      constexpr double iso = 0.5;
      RenderRequest request = through_haze(texture, iso);
      give_ghost_layer(texture, request);
      FrameCounts counts;
      const Image image = drawn(texture, request, counts);
      const Field field = texture_field(texture.description, Filter::linear, texture.texels);
      int hits = 0;
      double worst = 0, worst_from_plane = 0;
      for (int y = 5; y < 39; ++y)
        for (int x = 3; x < 43; ++x) {
          const auto ray = pixel_ray(request, x, y);
          if (!ray || image.at(x, y)[0] < 1e-3F) continue;
          const auto stretches =
              field_along_ray(field, texture.description.size, ray->from, ray->to, ray->length);
          const auto hit = first_hit(stretches, iso);
          if (!hit) continue;
          ++hits;
          // A step is at most 1.2 voxels long.
          worst = std::max(worst, std::abs(steps_before(image.at(x, y)) - *hit));
          // The closed form of the plane holds only where the filter's wrapping has no effect.
          const Vec3 way = subtract(ray->to, ray->from), there = add(ray->from, scale(way, *hit / ray->length));
          if (std::any_of(there.begin(), there.end(),
                          [](double t) { return std::abs(t - 0.5) > 0.5 - 0.0125; }))
            continue;
          const double closed = (iso - 0.06 - dot(slope, ray->from)) / dot(slope, way) * ray->length;
          worst_from_plane = std::max(worst_from_plane, std::abs(steps_before(image.at(x, y)) - closed));
        }
      std::printf("sphere %d, texels %d: %d hits, at most %.2e steps off\n", sphere, int(type), hits, worst);
      EXPECT_GT(hits, 150);
      EXPECT_LE(worst, 8e-4);
      if (!sphere && type == TexelType::f32) {
        EXPECT_LE(worst_from_plane, 8e-4) << "the closed form";
      }
    }
}

TEST(Surfaces, SearchEndsOnEveryCurve) {
  double worst = 0;
  for (const double bend : {0.0, 0.5, 0.9, 0.999})
    for (int i = 1; i < 100; ++i) {
      const double root = i / 100.0;
      // A cubic with one root, flat there if `bend` is near one.
      const auto curve = [&](double s) {
        return (s - root) * ((1 - bend) + bend * 3 * (s - root) * (s - root));
      };
      for (const double sign : {1.0, -1.0}) {
        SurfaceSearch search{0, float(5 + sign * curve(0)), float(5 + sign * curve(1))};
        ASSERT_TRUE(search.find(5, 1, [&](float s) { return float(5 + sign * curve(double(s))); }));
        // Values have an error of half a millionth.
        const double residue = std::abs(curve(double(search.front)));
        worst = std::max(worst, std::min(std::abs(double(search.front) - root), residue / 1e-6 * 1e-3));
      }
    }
  EXPECT_LE(worst, 1e-3);
  SurfaceSearch search{0, 0, 1};
  EXPECT_FALSE(search.find(0.5F, 1, [](float) { return std::nanf(""); }));
}

TEST(Surfaces, OfASphereFaceTheLightAsASphereDoes) {
  Texture texture = sampled(describe({64, 64, 64}, TexelType::f32), sphere_field(0.3, 0.2));
  RenderRequest request = request_on_steps(texture);
  request.steps->metric = {64, 0, 0, 0, 64, 0, 0, 0, 64};
  request.classification = TransferFunction{0, 1, {{}, {}}};
  request.surfaces = {{0.5, {1, 1, 1, 1}}};
  request.light.emplace();
  request.light->ambient = request.light->specular = {0, 0, 0};
  request.light->diffuse = {1, 1, 1};
  request.light->direction = {0.3, 0.5, 1};
  request.light->two_sided = false;
  give_ghost_layer(texture, request);
  FrameCounts counts;
  const Image image = drawn(texture, request, counts);
  const Vec3 light = normalised(request.light->direction), centre{0.5, 0.5, 0.5};
  double worst = 0;
  int hits = 0;
  for (int y = 5; y < 39; ++y)
    for (int x = 3; x < 43; ++x) {
      const auto ray = pixel_ray(request, x, y);
      if (!ray) continue;
      const Vec3 way = normalised(subtract(ray->to, ray->from)), to_centre = subtract(centre, ray->from);
      const double middle = dot(way, to_centre), inside = 0.09 - dot(to_centre, to_centre) + middle * middle;
      if (inside < 0.002) continue;
      const Vec3 hit = add(ray->from, scale(way, middle - std::sqrt(inside)));
      const double cosine = std::max(dot(normalised(subtract(hit, centre)), light), 0.0);
      worst = std::max(worst, std::abs(double(image.at(x, y)[0]) - cosine));
      EXPECT_EQ(image.at(x, y)[3], 1);
      ++hits;
    }
  std::printf("%d hits, cosines at most %.2e off\n", hits, worst);
  EXPECT_GT(hits, 150);
  EXPECT_LE(worst, 0.02);
}

struct Scene {
  const char* name;
  bool surfaces, light, haze, cut, divided;
  float full_slope = 0;
  NormalGuard guard{};
};
constexpr Scene scenes[] = {
    {"surfaces", true, false, false, false, false},
    {"surfaces in colours", true, false, true, true, false},
    {"lit surfaces in lit colours", true, true, true, true, true},
    {"lit colours", false, true, true, false, false},
    {"lit colours that fade", true, true, true, false, false, 1},
    {"lit by shorter normals", true, true, true, false, false, 0, {0.5}},
    {"lit by normals of the larger", true, true, true, false, false, 0, {3, NormalGuard::Form::larger}},
    {"lit by normals of squares",
     true,
     true,
     true,
     false,
     false,
     0,
     {0.5, NormalGuard::Form::root_of_squares}}};

RenderRequest request_of(const Texture& texture, const Scene& scene) {
  RenderRequest request = request_on_steps(texture);
  if (!scene.haze) request.classification = TransferFunction{0, 1, {{}, {}}};
  if (scene.surfaces) request.surfaces = two_veils();
  if (scene.light) request.light = some_light();
  if (scene.light) request.light->full_slope = scene.full_slope;
  if (scene.light) request.light->guard = scene.guard;
  request.steps->divided = scene.divided;
  if (scene.divided) request.steps->offsets = RayOffsets{2, 2, {0, 0.3F, 0.6F, 0.9F}};
  if (scene.cut) {
    request.clip_planes = {{{1, 0.3, -0.2}, -0.35}};
    // A tilted wall.
    const Vec4 middle = transform_point(request.texture_to_clip, {0.3, 0.5, 0.3});
    const double there = (middle[2] / middle[3] + 1) / 2;
    request.depth = DepthImage{request.window, {}, false};
    for (std::size_t i = 0; i < request.window.pixels(); ++i)
      request.depth->depth.push_back(float(there + 1e-4 * double(i % 40)));
  }
  return request;
}

TEST(Surfaces, AndLightAreWhatDoublePrecisionSays) {
  for (const Wrap wrap : {Wrap::edge, Wrap::border, Wrap::repeat})
    for (const TexelType type : {TexelType::u8, TexelType::u16, TexelType::f32})
      for (const Scene& scene : scenes) {
        Texture texture = sampled(describe({40, 37, 43}, type, wrap), sphere_field(0.3, 0.2));
        const RenderRequest request = request_of(texture, scene);
        give_ghost_layer(texture, request);
        FrameCounts counts;
        const Image image = drawn(texture, request, counts);
        const ReferenceImage reference = expected(texture, request);
        const Difference d = difference(image, reference, 1e-3);
        std::printf("%s, texels %d, wrap %d: max %.2e, rms %.2e, %d pixels over\n", scene.name, int(type),
                    int(wrap), d.max, d.rms, d.pixels_over);
        EXPECT_LE(d.pixels_over, pixels_that_graze);
        if (d.pixels_over == 0) {
          EXPECT_LE(d.rms, 1e-4);
        }
        RenderRequest other = request;
        if (scene.surfaces) other.surfaces[1].value += 0.05;
        if (scene.light) other.light->direction[0] += 1;
        EXPECT_GT(difference(image, expected(texture, other)).rms, 1e-4)
            << "the comparison must be able to fail";
        if (scene.guard.slope == 0) continue;
        other = request;
        other.light->guard = {};
        EXPECT_GT(difference(image, expected(texture, other)).rms, 1e-3) << "the guard must show";
      }
}

TEST(Surfaces, AndLightAreTheSameForAnyPartition) {
  double worst = 0;
  for (int ranks = 2; ranks <= 8; ++ranks)
    for (const Scene& scene : scenes) {
      Texture texture = noise(describe({40, 37, 43}, TexelType::u8, Wrap(ranks % 3)), unsigned(ranks));
      const RenderRequest request = request_of(texture, scene);
      give_ghost_layer(texture, request);
      FrameCounts one, many;
      const Image whole = drawn(texture, request, one), parts = drawn_in_parts(texture, request, ranks, many);
      const double d = difference(whole, parts).max;
      worst = std::max(worst, d);
      EXPECT_LE(d, 1e-5) << ranks << " ranks, " << scene.name;
      EXPECT_EQ(one.samples, many.samples) << ranks << " ranks, " << scene.name;
    }
  std::printf("2 to 8 ranks against 1: largest difference %.2e\n", worst);
}

TEST(Surfaces, OfVolumesOfAnySize) {
  int differing = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (int size = 1; size <= 9; ++size) {
      std::array<int, 3> sizes{7, 9, 6};
      sizes[std::size_t(axis)] = size;
      Texture texture = noise(describe(sizes, size % 2 ? TexelType::u8 : TexelType::f32), unsigned(size));
      RenderRequest request = request_of(texture, scenes[2]);
      request.depth.reset();
      request.steps->metric = {29, 0, 0, 0, 29, 0, 0, 0, 29};
      give_ghost_layer(texture, request);
      FrameCounts counts;
      const Difference d = difference(drawn(texture, request, counts), expected(texture, request), 1e-3);
      EXPECT_LE(d.pixels_over, pixels_that_graze) << size << " along axis " << axis;
      differing += d.pixels_over;
      FrameCounts same;
      EXPECT_LE(difference(drawn(texture, request, same), drawn_in_parts(texture, request, 3, counts)).max,
                1e-5);
    }
  EXPECT_LE(differing, 10);
}

TEST(Surfaces, OfUnusualFieldsAreFinite) {
  const float nan = std::nanf(""), infinity = std::numeric_limits<float>::infinity();
  struct Unusual {
    const char* name;
    std::vector<float> values;  // repeated in this order
    double iso;
    bool shows;
  };
  const Unusual fields[] = {{"even", {0.5F}, 0.5, false},
                            {"nothing but NaN", {nan}, 0.5, false},
                            {"some NaN", {0, 1, 0, 1, 1, nan, 0, 0, 0, 1, 1, 0, 0.5F}, 0.5, true},
                            {"infinite", {0, infinity, 0, -infinity, 1}, 0.5, true},
                            {"greatest value", {0, 1}, 1.0, true},
                            {"least value", {0, 1}, 0.0, false},
                            {"denormal", {0, 1e-42F}, 5e-43, true}};
  for (const Unusual& unusual : fields)
    for (const bool slopes : {false, true}) {
      Texture texture = noise(describe({13, 12, 11}, TexelType::f32), 3);
      for (std::size_t i = 0; i < texture.texels.size() / 4; ++i) {
        // Runs of equal values, or all mixed.
        const float v = unusual.values[(slopes ? i / 39 : i) % unusual.values.size()];
        std::memcpy(texture.texels.data() + 4 * i, &v, sizeof v);
      }
      RenderRequest request = request_on_steps(texture);
      request.classification = TransferFunction{0, 1, {{}, {}}};
      request.surfaces = {{unusual.iso, {1, 1, 1, 1}}};
      request.light = some_light();
      give_ghost_layer(texture, request);
      FrameCounts counts;
      const Image image = drawn(texture, request, counts);
      float most = 0;
      for (const float v : image.rgba) {
        EXPECT_TRUE(std::isfinite(v)) << unusual.name;
        most = std::max(most, v);
      }
      if (!unusual.shows) {
        EXPECT_EQ(most, 0) << unusual.name;
      } else if (slopes) {
        EXPECT_GT(most, 0) << unusual.name;
      }
    }
}

TEST(Surfaces, AreSkippedToAndNeverPast) {
  Texture texture = sampled(describe({96, 96, 96}, TexelType::u8), sphere_field(0.25, 0.01));
  RenderRequest request = request_on_steps(texture);
  request.steps->metric = {90, 0, 0, 0, 90, 0, 0, 0, 90};
  request.classification = TransferFunction{0, 1, {{}, {}}};
  request.surfaces = {{0.5, {1, 0.5F, 0.2F, 0.5F}}};
  give_ghost_layer(texture, request);
  FrameCounts counts;
  const Image image = drawn(texture, request, counts);
  std::printf("%zu of %zu blocks empty, %zu of %zu segments looked at\n", std::size_t(counts.blocks_empty),
              std::size_t(counts.blocks), std::size_t(counts.samples_taken), std::size_t(counts.samples));
  EXPECT_GT(counts.blocks_empty, counts.blocks / 2);
  EXPECT_LT(counts.samples_taken, counts.samples / 2);
  EXPECT_LE(difference(image, expected(texture, request), 1e-3).pixels_over, pixels_that_graze);
}

TEST(Light, OnSlicesIsWhatDoublePrecisionSays) {
  for (const bool two_sided : {false, true})
    for (const bool from_the_eye : {false, true}) {
      Texture texture = sampled(describe({40, 37, 43}, TexelType::u16), marschner_lobb_field());
      RenderRequest request = request_for(texture, usual_camera(40, 34), 40, 34, 60);
      request.light = some_light();
      request.light->two_sided = two_sided;
      if (two_sided) request.light->full_slope = 2;  // of about 4 at most
      if (two_sided == from_the_eye) request.light->guard = {1};
      if (from_the_eye) request.light->direction = {};
      give_ghost_layer(texture, request);
      FrameCounts counts;
      const Image image = drawn(texture, request, counts);
      const Field field = texture_field(texture.description, Filter::linear, texture.texels);
      const auto shade = [&](const Vec3& t, const Vec3& way, const std::array<double, 4>& colour) {
        return illuminated(field, texture.description, *request.light, t, way, colour);
      };
      const Difference d = difference(image, slice_sum(field, request, request.window, shade), 1e-3);
      std::printf("two-sided %d, from the eye %d: max %.2e, rms %.2e\n", two_sided, from_the_eye, d.max, d.rms);
      EXPECT_LE(d.pixels_over, pixels_that_graze);
      EXPECT_LE(d.rms, 1e-4);
      request.light.reset();
      EXPECT_GT(difference(image, drawn(texture, request, counts)).rms, 1e-3) << "light changes nothing";
    }
}

TEST(Light, OnSamplesBeyondTheExitIsWhatDoublePrecisionSays) {
  for (const Wrap wrap : {Wrap::edge, Wrap::border})
    for (const TexelType type : {TexelType::u8, TexelType::f32}) {
      Texture texture = sampled(describe({40, 37, 43}, type, wrap), marschner_lobb_field());
      RenderRequest request = request_on_steps(texture);
      request.light = some_light();
      request.steps->first = 0.75;
      request.steps->counted_from = 0;
      give_ghost_layer(texture, request);
      FrameCounts counts;
      const Image image = drawn(texture, request, counts);
      const Field field = texture_field(texture.description, Filter::linear, texture.texels);
      const auto shade = [&](const Vec3& t, const Vec3& way, const std::array<double, 4>& colour) {
        return illuminated(field, texture.description, *request.light, t, way, colour);
      };
      const Difference d = difference(image, slice_sum(field, request, request.window, shade), 1e-3);
      std::printf("wrap %d, texels %d: max %.2e, rms %.2e\n", int(wrap), int(type), d.max, d.rms);
      EXPECT_LE(d.pixels_over, pixels_that_graze);
      request.steps->counted_from = 0.75;
      EXPECT_GT(difference(image, drawn(texture, request, counts)).rms, 1e-4) << "nothing lies beyond";
    }
}

TEST(Light, OnFirstSamplesBeyondTheExitIsWhatDoublePrecisionSays) {
  for (const TexelType type : {TexelType::u8, TexelType::f32}) {
    Texture texture = sampled(describe({40, 37, 43}, type, Wrap::edge), marschner_lobb_field());
    RenderRequest request = request_on_steps(texture);
    request.light = some_light();
    // Steps as long as the box is deep.
    for (double& number : request.steps->metric) number /= 40;
    request.steps->first = 0.75;
    request.steps->at_least_one = true;
    give_ghost_layer(texture, request);
    FrameCounts counts;
    const Image image = drawn(texture, request, counts);
    const Field field = texture_field(texture.description, Filter::linear, texture.texels);
    const auto shade = [&](const Vec3& t, const Vec3& way, const std::array<double, 4>& colour) {
      return illuminated(field, texture.description, *request.light, t, way, colour);
    };
    EXPECT_LE(difference(image, slice_sum(field, request, request.window, shade), 1e-3).pixels_over,
              pixels_that_graze);
    request.steps->at_least_one = false;
    EXPECT_GT(difference(image, drawn(texture, request, counts)).rms, 1e-3) << "no ray is too short";
  }
}

/// Light from the eye with an arbitrary response, not that of any lighting model.
Light some_response() {
  Light light = some_light();
  light.direction = {};
  light.even = {0.5F, 0.25F, 1};
  light.guard = {0.7, NormalGuard::Form::root_of_squares};
  light.response.clear();
  for (int i = 0; i <= 64; ++i) {
    const float cosine = float(i) / 32 - 1;
    light.response.push_back({1 + 0.5F * std::sin(3 * cosine), 0.3F * cosine * cosine * cosine});
  }
  return light;
}

TEST(Light, OfAnyResponseAndReachIsWhatDoublePrecisionSays) {
  struct Case {
    TexelType type;
    Filter filter;
    Vec3 reach;
    std::optional<std::array<double, 9>> ray_space{};
  };
  for (const Case& c :
       {Case{TexelType::u8, Filter::linear, {1, 1, 1}}, Case{TexelType::u8, Filter::linear_8_bit, {1, 1, 1}},
        Case{TexelType::u8, Filter::linear_8_bit, {1.25, 2, 0.5}},
        Case{TexelType::u16, Filter::linear, {0.5, 1, 3}}, Case{TexelType::f32, Filter::linear, {1, 1, 1}},
        Case{TexelType::f32, Filter::linear, {1, 1, 1}, {{1.5, 0, 0, 0, 0.5, 0.25, 0, 0, 1}}}}) {
    Texture texture = sampled(describe({40, 37, 43}, c.type), marschner_lobb_field());
    RenderRequest request = request_for(texture, usual_camera(40, 34), 40, 34, 60);
    request.filter = c.filter;
    request.light = some_response();
    request.light->reach = c.reach;
    request.light->ray_space = c.ray_space;
    give_ghost_layer(texture, request);
    FrameCounts counts;
    const Image image = drawn(texture, request, counts);
    const Field field = texture_field(texture.description, c.filter, texture.texels);
    const auto shade = [&](const Vec3& t, const Vec3& way, const std::array<double, 4>& colour) {
      return illuminated(field, texture.description, *request.light, t, way, colour);
    };
    const Difference d = difference(image, slice_sum(field, request, request.window, shade), 1e-3);
    std::printf("type %d, filter %d, reach %g: max %.2e, rms %.2e\n", int(c.type), int(c.filter), c.reach[0],
                d.max, d.rms);
    EXPECT_LE(d.pixels_over, pixels_that_graze);
    EXPECT_LE(d.rms, 1e-4);
    if (!c.ray_space) continue;
    request.light->ray_space.reset();
    EXPECT_GT(difference(image, drawn(texture, request, counts)).rms, 1e-3)
        << "the rays' space changes nothing";
  }
}

TEST(Light, GradientOpacityIsWhatDoublePrecisionSays) {
  struct Case {
    const char* name;
    TexelType type;
    Filter filter;
    Light light;
  };
  Light alone = some_light();
  alone.ambient = {1, 1, 1};
  alone.diffuse = alone.specular = {0, 0, 0};
  for (const Case& c : {Case{"with Phong's light", TexelType::u8, Filter::linear, some_light()},
                        Case{"with a response", TexelType::u8, Filter::linear_8_bit, some_response()},
                        Case{"alone", TexelType::u16, Filter::linear, alone},
                        Case{"alone, of floats", TexelType::f32, Filter::linear, alone}}) {
    Texture texture = sampled(describe({40, 37, 43}, c.type), marschner_lobb_field());
    RenderRequest request = request_for(texture, usual_camera(40, 34), 40, 34, 60);
    request.filter = c.filter;
    request.light = c.light;
    // Gradient opacity: 0 where the field is constant, 1 for medium slopes, little for the steepest.
    request.light->gradient_opacity = {{0, 0.3F, 1, 0.5F, 0.1F}, 0.2, 3};
    give_ghost_layer(texture, request);
    FrameCounts counts;
    const Image image = drawn(texture, request, counts);
    const Field field = texture_field(texture.description, c.filter, texture.texels);
    const auto shade = [&](const Vec3& t, const Vec3& way, const std::array<double, 4>& colour) {
      return illuminated(field, texture.description, *request.light, t, way, colour);
    };
    const Difference d = difference(image, slice_sum(field, request, request.window, shade), 1e-3);
    std::printf("%s: max %.2e, rms %.2e\n", c.name, d.max, d.rms);
    EXPECT_LE(d.pixels_over, pixels_that_graze);
    EXPECT_LE(d.rms, 1e-4);
    request.light->gradient_opacity.factors.clear();
    EXPECT_GT(difference(image, drawn(texture, request, counts)).rms, 1e-2) << "slopes change nothing";
  }
}

TEST(Light, ThatIsEverywhereTheSameChangesNothing) {
  Texture texture = noise(describe({40, 37, 43}, TexelType::u8), 4);
  RenderRequest request = request_on_steps(texture);
  FrameCounts counts;
  const Image plain = drawn(texture, request, counts);
  request.light.emplace();
  request.light->ambient = {1, 1, 1};
  request.light->diffuse = request.light->specular = {0, 0, 0};
  give_ghost_layer(texture, request);
  EXPECT_LE(difference(plain, drawn(texture, request, counts)).max, 1e-5);
}

TEST(Surfaces, AndLightWithoutSenseAreRefused) {
  Texture texture = noise(describe({9, 9, 9}, TexelType::u8), 1);
  RenderRequest good = request_of(texture, scenes[2]);
  give_ghost_layer(texture, good);
  EXPECT_NO_THROW(validate(texture.description, good));
  const auto refused = [&](const char* why, auto change) {
    RenderRequest bad = good;
    change(bad);
    EXPECT_THROW(validate(texture.description, bad), std::invalid_argument) << why;
  };
  refused("planes", [](RenderRequest& r) { r.steps.reset(); });
  refused("maximum", [](RenderRequest& r) { r.op = Operator::max; });
  refused("nearest", [](RenderRequest& r) { r.filter = Filter::nearest; });
  refused("fog", [](RenderRequest& r) { r.fog = Fog{{}, 0, {{}, {}}}; });
  refused("behind walls", [](RenderRequest& r) { r.steps->past_depth = 1; });
  refused("NaN", [](RenderRequest& r) { r.surfaces[0].value = NAN; });
  refused("opacity", [](RenderRequest& r) { r.surfaces[0].colour[3] = 1.5F; });
  refused("too many", [](RenderRequest& r) { r.surfaces.resize(max_surfaces + 1); });
  refused("singular", [](RenderRequest& r) { r.light->space = {}; });
  refused("shininess", [](RenderRequest& r) { r.light->shininess = -1; });
  refused("full slope", [](RenderRequest& r) { r.light->full_slope = -1; });
  refused("guard", [](RenderRequest& r) { r.light->guard.slope = -1; });
  refused("diffuse", [](RenderRequest& r) { r.light->diffuse[1] = NAN; });
  refused("even", [](RenderRequest& r) { r.light->even[0] = -1; });
  refused("reach", [](RenderRequest& r) { r.light->reach[2] = 0; });
  refused("response of one entry", [](RenderRequest& r) {
    r.light->direction = {};
    r.light->response = {{1, 0}};
  });
  refused("response to light from elsewhere", [](RenderRequest& r) { r.light->response = {{1, 0}, {1, 0}}; });
  refused("gradient opacity of surfaces", [](RenderRequest& r) { r.light->gradient_opacity = {{1, 1}}; });
  const auto refused_opacity = [&](const char* why, const GradientOpacity& opacity) {
    refused(why, [&](RenderRequest& r) {
      r.surfaces.clear();
      r.light->gradient_opacity = opacity;
    });
  };
  refused_opacity("gradient opacity of one factor", {{1}});
  refused_opacity("factors above 1", {{0, 1.5F}});
  refused_opacity("slopes the wrong way round", {{0, 1}, 1, 0});
  --texture.description.ghost_layer;
  EXPECT_THROW(validate(texture.description, good), std::invalid_argument) << "margin";
  Texture colours = noise(describe({9, 9, 9}, TexelType::rgba8), 1);
  colours.description.ghost_layer = 9;
  good.classification = LinearMap{};
  EXPECT_THROW(validate(colours.description, good), std::invalid_argument) << "colours";
}

TEST(Surfaces, AndLightAreTheSameOnAllInstructionSets) {
  const std::int64_t here = hwy::SupportedTargets();
  for (const TexelType type : {TexelType::u8, TexelType::u16, TexelType::f32})
    for (const Method method : {Method::post_classified, Method::pre_integrated})
      for (const Scene& scene : scenes) {
        Texture texture = sampled(describe({40, 37, 43}, type, Wrap::border), sphere_field(0.3, 0.2));
        RenderRequest request = request_of(texture, scene);
        request.method = method;
        if (method == Method::pre_integrated) {
          // A transfer function that ends within the field's values.
          std::get<TransferFunction>(request.classification).low = 0.2F;
          std::get<TransferFunction>(request.classification).high = 0.8F;
        }
        give_ghost_layer(texture, request);
        std::optional<Image> plain;
        for (const std::int64_t target : {HWY_EMU128, HWY_SSE4, HWY_AVX2, HWY_AVX3}) {
          if (target != HWY_EMU128 && (here & target) == 0) continue;
          hwy::SetSupportedTargetsForTest(target);
          hwy::GetChosenTarget().Update(hwy::SupportedTargets());
          FrameCounts counts;
          const Image image = drawn(texture, request, counts);
          if (!plain) plain = image;
          const Difference d = difference(image, *plain, 3e-4);
          EXPECT_LE(d.pixels_over, pixels_that_graze)
              << instruction_set() << ", " << scene.name << ", " << d.max;
        }
        hwy::SetSupportedTargetsForTest(0);
        hwy::GetChosenTarget().Update(hwy::SupportedTargets());
      }
}

}  // namespace
}  // namespace understudy::volume::testing
