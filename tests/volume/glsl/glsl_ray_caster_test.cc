// SPDX-License-Identifier: Apache-2.0
// Compares the GLSL ray caster with the double-precision reference and with the CPU, on EGL and on OSMesa.
#include "volume/glsl/glsl_ray_caster.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstring>
#include <limits>
#include <optional>

#include "tests/volume/glsl/gl_scenes.h"
#include "volume/footprint.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/kd_tree.h"
#include "volume/request.h"

namespace understudy::volume::glsl {
namespace {

using namespace testing;

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

  GlImage on_gl(const Texture& texture, const TexelBox& cells, const RenderRequest& request, const Rect& rect) {
    const BrickStore store = filled(texture, cells);
    GlslRayCaster caster(store, device());
    GlImage image{Image(rect), {}};
    caster.render(request, image.image, image.counts);
    return image;
  }
  GlImage on_gl(const Scene& scene) {
    return on_gl(scene.texture, cell_lattice(scene.texture.description).box(), scene.request,
                 scene.request.window);
  }

 private:
  std::optional<Device> device_;
};

TEST_P(GlslRayCasterOn, GivesTheImageOfTheReferenceAndOfTheCpu) {
  std::printf("%s\n", device().description().c_str());
  for (const Scene& scene : scenes()) {
    const GlImage gl = on_gl(scene), cpu = on_cpu(scene);
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

    // Other sample positions give another image, so the comparison can fail.
    RenderRequest other = scene.request;
    if (other.steps) other.steps->first += 0.5;
    other.planes.first += 0.5 * other.planes.spacing;
    EXPECT_GT(difference(gl.image, slice_sum(field, other, other.window)).rms, 2 * d.rms) << scene.name;
  }
}

TEST_P(GlslRayCasterOn, LeavesOutWhatIsEmptyOrHidden) {
  for (const Scene& scene : scenes())
    if (scene.request.termination > 0) {
      const GlImage gl = on_gl(scene);
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

TEST_P(GlslRayCasterOn, GivesTheSameImageForAnyPartition) {
  double worst = 0;
  for (const int ranks : {2, 4, 7})
    for (const Scene& scene : scenes()) {
      if (scene.request.termination > 0 || scene.request.opacity_limit < 1) continue;
      const GlImage one = on_gl(scene);
      Image many(scene.request.window);
      std::fill(many.rgba.begin(), many.rgba.end(), neutral_value(scene.request.op));
      std::uint64_t samples = 0;
      const KdTree tree(scene.texture.description, ranks);
      for (const int rank : tree.visibility_order(scene.request)) {
        const Rect rect = footprint(scene.request, scene.texture.description, tree.box(rank));
        const GlImage part = on_gl(scene.texture, tree.box(rank), scene.request, rect);
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

TEST_P(GlslRayCasterOn, LeavesOutWhatTheCpuLeavesOut) {
  const Texture texture = sampled(describe({45, 38, 51}, TexelType::u8), sphere_field(0.4));
  RenderRequest request = request_for(texture, usual_camera(width, height), width, height, 150);
  request.classification = smooth_table(256, 0.9F);
  for (int i = 0; i < 20; ++i) std::get<TransferFunction>(request.classification).entries[std::size_t(i)] = {};
  request.termination = 5e-6F;
  const BrickStore store = filled(texture);
  GlslRayCaster caster(store, device());
  struct Drawn {
    Image image;
    FrameCounts counts;
  };
  const auto draw = [&](const RenderRequest& asked, bool gl) {
    Drawn drawn{Image(asked.window), {}};
    if (gl)
      caster.render(asked, drawn.image, drawn.counts);
    else
      raycast(store, asked, drawn.image, drawn.counts);
    return drawn;
  };
  const Drawn usual = draw(request, true), on_cpu = draw(request, false);
  EXPECT_GT(usual.counts.blocks_empty, 0U);
  EXPECT_GT(usual.counts.samples_hidden, usual.counts.samples / 20);
  // A ray may end eight samples earlier or later.
  EXPECT_NEAR(double(usual.counts.samples_hidden), double(on_cpu.counts.samples_hidden),
              8 * double(usual.counts.rays_terminated));
  EXPECT_LE(usual.counts.samples_taken + usual.counts.samples_hidden, usual.counts.samples);
  request.termination = 0;
  const Drawn to_the_end = draw(request, true);
  EXPECT_EQ(to_the_end.counts.samples_hidden, 0U);
  EXPECT_LE(difference(usual.image, to_the_end.image).max, 5e-6);
  request.optimizations.empty_bricks = false;
  const Drawn all = draw(request, true);
  EXPECT_EQ(all.counts.samples_taken, all.counts.samples);
  EXPECT_EQ(all.counts.blocks_empty, 0U);
  EXPECT_LE(difference(all.image, to_the_end.image).max, 1e-6);
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
