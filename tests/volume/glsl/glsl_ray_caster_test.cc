// The ray caster in GLSL against the double-precision reference and against the CPU, on EGL and on OSMesa.
#include "volume/glsl/glsl_ray_caster.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstring>
#include <limits>
#include <optional>

#include "tests/volume/scenes.h"
#include "volume/footprint.h"
#include "volume/kd_tree.h"
#include "volume/raycast/ray_caster.h"

namespace understudy::volume::glsl {
namespace {

using namespace volume::testing;

constexpr int width = 61, height = 47;

struct Scene {
  const char* name;
  Texture texture;
  RenderRequest request;
};

/// Constant steps, about one a texel.
RaySteps steps_of(double length) {
  RaySteps steps;
  steps.metric = {1 / length, 0, 0, 0, 1 / length, 0, 0, 0, 1 / length};
  steps.first = 0.5;
  return steps;
}

DepthImage tilted_wall(const RenderRequest& request) {
  DepthImage depth;
  depth.rect = request.window;
  const Vec4 middle = transform_point(request.texture_to_clip, {0.5, 0.5, 0.5}),
             end = transform_point(request.texture_to_clip, {1, 0.2, 0.9});
  const double there = (middle[2] / middle[3] + 1) / 2, slope = (end[2] / end[3] + 1) / 2 - there;
  for (int y = 0; y < depth.rect.height; ++y)
    for (int x = 0; x < depth.rect.width; ++x)
      depth.depth.push_back(float(there + slope * (x - depth.rect.width / 2) / depth.rect.width));
  return depth;
}

/// Nothing but the highest values shows, and that fully.
TransferFunction sparse_table() {
  TransferFunction f;
  for (int i = 0; i < 64; ++i) {
    const float a = i < 44 ? 0.0F : 0.04F * float(i - 43);
    f.entries.push_back({a, 0.5F * a, 0.2F * a, a});
  }
  return f;
}

std::vector<Scene> scenes() {
  const Matrix4 usual = usual_camera(width, height);
  const Matrix4 inside =
      multiply(perspective(70, double(width) / height, 0.01, 10),
               multiply(look_at({0.1, -0.05, 0.2}, {-0.4, 0.1, -0.3}, {0, 1, 0}), unit_cube()));
  const Matrix4 orthographic = multiply(parallel(0.9, 0.8, -5, 5),
                                        multiply(look_at({0.9, 0.7, 1.6}, {0, 0, 0}, {0, 1, 0}), unit_cube()));
  std::vector<Scene> all;
  const auto add = [&](const char* name, Texture texture, const Matrix4& camera) -> RenderRequest& {
    all.push_back({name, std::move(texture), {}});
    all.back().request = request_for(all.back().texture, camera, width, height, 70);
    return all.back().request;
  };
  add("ball, bytes, planes", sampled(describe({64, 64, 64}, TexelType::u8), sphere_field(0.35)), usual);
  add("Marschner-Lobb, 16 bits, steps", sampled(describe({41, 41, 41}, TexelType::u16), marschner_lobb_field()),
      usual)
      .steps = steps_of(0.025);
  add("ramp, floats, planes",
      sampled(describe({33, 21, 50}, TexelType::f32), linear_field({0.4, 0.3, 0.2}, 0.05)), orthographic);
  RenderRequest& sparse =
      add("ball, sparse, steps", sampled(describe({70, 64, 57}, TexelType::u8), sphere_field(0.3)), usual);
  sparse.classification = sparse_table();
  sparse.steps = steps_of(0.016);
  sparse.termination = 1e-5F;
  add("noise, bytes, border", noise(describe({19, 23, 17}, TexelType::u8, Wrap::border), 1), usual);
  add("noise, 16 bits, repeated, nearest", noise(describe({19, 23, 17}, TexelType::u16, Wrap::repeat), 2),
      usual)
      .filter = Filter::nearest;
  add("noise, colours", noise(describe({24, 31, 29}, TexelType::rgba8), 3), usual);
  RenderRequest& maximum =
      add("noise, maximum, steps", noise(describe({37, 29, 41}, TexelType::u8), 4), orthographic);
  maximum.op = Operator::max;
  maximum.steps = steps_of(0.03);
  maximum.steps->divided = true;
  add("noise, minimum", noise(describe({24, 31, 29}, TexelType::u8), 5), usual).op = Operator::min;
  RenderRequest& sum = add("noise, sum, floats", noise(describe({24, 31, 29}, TexelType::f32), 6), usual);
  sum.op = Operator::add;
  sum.classification = smooth_table(256, 0.02F);
  add("noise, first hit", noise(describe({37, 29, 41}, TexelType::u16), 9), usual).op = Operator::first_hit;
  add("noise, from within", noise(describe({37, 29, 41}, TexelType::u8), 7), inside).steps = steps_of(0.03);
  RenderRequest& cut = add("ball, wall and clip plane",
                           sampled(describe({50, 50, 50}, TexelType::u8), sphere_field(0.4)), usual);
  cut.clip_planes = {{{1, 0.3, -0.2}, -0.4}};
  cut.depth = tilted_wall(cut);
  cut.region = {{0.03, 0, 0.05}, {0.97, 0.9, 1}};
  RenderRequest& jittered =
      add("noise, each ray begun elsewhere", noise(describe({37, 29, 41}, TexelType::u8), 8), usual);
  jittered.steps = steps_of(0.03);
  jittered.steps->offsets = RayOffsets{3, 2, {0.1F, 0.9F, 0.4F, 0.7F, 0, 0.3F}};
  return all;
}

struct Picture {
  Image image;
  FrameCounts counts;
};

Picture on_cpu(const Scene& scene) {
  Picture picture{Image(scene.request.window), {}};
  raycast(filled(scene.texture), scene.request, picture.image, picture.counts);
  return picture;
}

class GlslRayCasterOn : public ::testing::TestWithParam<Platform> {
 protected:
  void SetUp() override {
    try {
      device_.emplace(GetParam());
    } catch (const ContextUnavailable& absent) {
      GTEST_SKIP() << absent.what();
    }
  }

  Device& device() { return *device_; }

  Picture on_gl(const Texture& texture, const TexelBox& cells, const RenderRequest& request, const Rect& rect) {
    const BrickStore store = filled(texture, cells);
    GlslRayCaster caster(store, device());
    Picture picture{Image(rect), {}};
    caster.render(request, picture.image, picture.counts);
    return picture;
  }
  Picture on_gl(const Scene& scene) {
    return on_gl(scene.texture, cell_lattice(scene.texture.description).box(), scene.request,
                 scene.request.window);
  }

 private:
  std::optional<Device> device_;
};

TEST_P(GlslRayCasterOn, GivesThePictureOfTheReferenceAndOfTheCpu) {
  std::printf("%s\n", device().description().c_str());
  for (const Scene& scene : scenes()) {
    const Picture gl = on_gl(scene), cpu = on_cpu(scene);
    const Field field = texture_field(scene.texture.description, scene.request.filter, scene.texture.texels);
    const ReferenceImage exact = slice_sum(field, scene.request, scene.request.window);
    const Difference d = difference(gl.image, exact), own = difference(cpu.image, exact),
                     both = difference(gl.image, cpu.image);
    std::printf("%-34s rms %.1e, largest %.1e; CPU's rms %.1e; GL against CPU: rms %.1e, largest %.1e\n",
                scene.name, d.rms, d.max, own.rms, both.rms, both.max);
    EXPECT_LE(d.rms, 1e-3) << scene.name;
    EXPECT_LE(both.rms, 1e-3) << scene.name;
    EXPECT_EQ(gl.counts.samples, cpu.counts.samples) << scene.name;
    EXPECT_EQ(gl.counts.rays, cpu.counts.rays) << scene.name;
    EXPECT_GT(gl.counts.samples_taken, 0U) << scene.name;
    EXPECT_EQ(gl.counts.blocks_empty, cpu.counts.blocks_empty) << scene.name;

    // Samples elsewhere give another picture: the comparison can fail.
    RenderRequest other = scene.request;
    if (other.steps) other.steps->first += 0.5;
    other.planes.first += 0.5 * other.planes.spacing;
    EXPECT_GT(difference(gl.image, slice_sum(field, other, other.window)).rms, 2 * d.rms) << scene.name;
  }
}

TEST_P(GlslRayCasterOn, LeavesOutWhatIsEmptyOrHidden) {
  for (const Scene& scene : scenes())
    if (scene.request.termination > 0) {
      const Picture gl = on_gl(scene);
      std::printf("%s: %llu of %llu samples taken, %llu of %llu rays terminated\n", scene.name,
                  static_cast<unsigned long long>(gl.counts.samples_taken),
                  static_cast<unsigned long long>(gl.counts.samples),
                  static_cast<unsigned long long>(gl.counts.rays_terminated),
                  static_cast<unsigned long long>(gl.counts.rays));
      EXPECT_LT(gl.counts.samples_taken, gl.counts.samples / 2);
      EXPECT_GT(gl.counts.rays_terminated, 0U);
    }
}

void compose(Operator op, float* front, const float* back) {
  const float room = 1 - front[3];
  for (int k = 0; k < 4; ++k)
    front[k] = op == Operator::over || op == Operator::first_hit ? front[k] + room * back[k]
               : op == Operator::add                             ? front[k] + back[k]
               : op == Operator::max                             ? std::max(front[k], back[k])
                                                                 : std::min(front[k], back[k]);
}

TEST_P(GlslRayCasterOn, GivesTheSamePictureForAnyPartition) {
  double worst = 0;
  for (const int ranks : {2, 4, 7})
    for (const Scene& scene : scenes()) {
      if (scene.request.termination > 0) continue;
      const Picture one = on_gl(scene);
      Image many(scene.request.window);
      std::fill(many.rgba.begin(), many.rgba.end(), neutral_value(scene.request.op));
      std::uint64_t samples = 0;
      const KdTree tree(scene.texture.description, ranks);
      for (const int rank : tree.visibility_order(scene.request)) {
        const Rect rect = footprint(scene.request, scene.texture.description, tree.box(rank));
        const Picture part = on_gl(scene.texture, tree.box(rank), scene.request, rect);
        samples += part.counts.samples;
        for (int y = rect.y; y < rect.y + rect.height; ++y)
          for (int x = rect.x; x < rect.x + rect.width; ++x)
            compose(scene.request.op, many.at(x, y), part.image.at(x, y));
      }
      EXPECT_EQ(samples, one.counts.samples) << scene.name << ", " << ranks << " ranks";
      const double d = difference(one.image, many).max;
      worst = std::max(worst, d);
      EXPECT_LE(d, 1e-4) << scene.name << ", " << ranks << " ranks";
    }
  std::printf("2 to 7 ranks against 1: largest difference %.1e\n", worst);
}

TEST_P(GlslRayCasterOn, TakesEverySmallSize) {
  double worst = 0;
  for (int size = 1; size <= 9; ++size)
    for (const Wrap wrap : {Wrap::edge, Wrap::border, Wrap::repeat}) {
      Scene scene{
          "", noise(describe({size, 10 - size, (size + 4) % 9 + 1}, TexelType::u8, wrap), unsigned(size)), {}};
      scene.request = request_for(scene.texture, usual_camera(width, height), width, height, 20);
      const Difference d = difference(on_gl(scene).image, on_cpu(scene).image);
      worst = std::max(worst, d.max);
      EXPECT_LE(d.max, 1e-3) << size << " texels along x, wrap " << int(wrap);
    }
  std::printf("largest difference from the CPU %.1e\n", worst);
}

TEST_P(GlslRayCasterOn, FollowsTexelsThatChange) {
  const VolumeDescription description = describe({40, 33, 27}, TexelType::u8);
  const Texture before = sampled(description, sphere_field(0.2)),
                after = sampled(description, sphere_field(0.4));
  BrickStore store = filled(before);
  GlslRayCaster caster(store, device());
  RenderRequest request = request_for(before, usual_camera(width, height), width, height, 50);
  request.classification = sparse_table();
  Image image(request.window);
  FrameCounts counts;
  caster.render(request, image, counts);
  std::vector<std::size_t> blocks;
  store.change(description.stored, after.texels, blocks);
  caster.blocks_changed(blocks);
  caster.render(request, image, counts);
  const Scene scene{"", after, request};
  EXPECT_LE(difference(image, on_gl(scene).image).max, 1e-6);
  EXPECT_GT(difference(image, on_gl({"", before, request}).image).max, 0.1);
}

TEST_P(GlslRayCasterOn, LeavesTexelsThatAreNotNumbersToTheCpu) {
  Texture texture = sampled(describe({17, 17, 17}, TexelType::f32), linear_field({0.4, 0.3, 0.2}, 0.05));
  const RenderRequest request = request_for(texture, usual_camera(width, height), width, height, 30);
  EXPECT_NO_THROW(on_gl({"", texture, request}));
  const float none = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(texture.texels.data() + sizeof none * 2000, &none, sizeof none);
  EXPECT_THROW(on_gl({"", texture, request}), NotSupported);
}

TEST_P(GlslRayCasterOn, SaysWhatItLeavesToTheCpu) {
  const Texture texture = noise(describe({9, 9, 9}, TexelType::u8), 1);
  const BrickStore store = filled(texture);
  GlslRayCaster caster(store, device());
  RenderRequest request = request_for(texture, usual_camera(width, height), width, height, 20);
  EXPECT_FALSE(caster.obstacle(request));
  Image image(request.window);
  FrameCounts counts;
  request.fog = Fog{{0, 0, 1}, 0, {{0, 0, 0, 1}, {1, 1, 1, 0}}};
  EXPECT_EQ(caster.obstacle(request), "fog");
  EXPECT_THROW(caster.render(request, image, counts), NotSupported);
  EXPECT_EQ(counts.samples, 0U);
  request.fog.reset();
  std::get<TransferFunction>(request.classification)
      .entries.resize(std::size_t(device().max_texture_edge()) + 1);
  EXPECT_TRUE(caster.obstacle(request));
  request.planes.normal = {0, 0, 0};
  EXPECT_THROW(caster.render(request, image, counts), std::invalid_argument) << "senseless for everybody";
}

INSTANTIATE_TEST_SUITE_P(Offscreen, GlslRayCasterOn, ::testing::Values(Platform::egl, Platform::osmesa),
                         [](const auto& info) { return info.param == Platform::egl ? "Egl" : "OsMesa"; });

}  // namespace
}  // namespace understudy::volume::glsl
