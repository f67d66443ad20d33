// SPDX-License-Identifier: Apache-2.0
// Volumes that do not fit into textures at once are drawn in passes by bricks that are loaded and evicted, on
// EGL and on OSMesa. The image must equal that of a single texture.
#include <gmock/gmock.h>

#include <cstdio>
#include <cstring>
#include <limits>
#include <optional>

#include "tests/volume/glsl/gl_scenes.h"
#include "volume/frame_counts.h"
#include "volume/glsl/glsl_ray_caster.h"
#include "volume/image.h"
#include "volume/request.h"

namespace understudy::volume::glsl {
namespace {

using namespace testing;
using ::testing::HasSubstr;

constexpr std::uint64_t brick_bytes(std::uint64_t cells, std::uint64_t texel) {
  return (cells + 1) * (cells + 1) * (cells + 1) * texel;
}

std::uint64_t bytes_in_texture(TexelType type) {
  return type == TexelType::rgba8 ? 8 : type == TexelType::f32 ? 4 : 2;
}

class GlslBricksOn : public ::testing::TestWithParam<Platform> {
 protected:
  void SetUp() override {
    try {
      device_.emplace(GetParam());
    } catch (const ContextUnavailable& absent) {
      GTEST_SKIP() << absent.what();
    }
  }

  Device& device() { return *device_; }

  /// Leaves no more than `bytes` of texture memory free from now on.
  void leave(std::uint64_t bytes) {
    taken_.reset();
    taken_.emplace(device_->texture_memory(), device_->texture_memory().left() - bytes);
  }
  void leave_all() { taken_.reset(); }

  static GlImage draw(GlslRayCaster& caster, const RenderRequest& request) {
    GlImage image{Image(request.window), {}};
    caster.render(request, image.image, image.counts);
    return image;
  }
  /// Draws from a single texture.
  GlImage whole(const Texture& texture, const RenderRequest& request) {
    leave_all();
    const BrickStore store = filled(texture);
    GlslRayCaster caster(store, device());
    GlImage image = draw(caster, request);
    EXPECT_EQ(caster.brick_figures().bricks, 0U);
    return image;
  }

 private:
  std::optional<Device> device_;
  std::optional<TextureMemory::Part> taken_;
};

TEST_P(GlslBricksOn, ShowWhatOneTextureShowsUnderAnyBudget) {
  double worst = 0;
  std::uint64_t evictions = 0;
  for (Scene scene : scenes()) {
    // Rays may also terminate at brick boundaries.
    if (scene.request.termination > 0) scene.request.termination = 1e-6F;
    const GlImage one = whole(scene.texture, scene.request);
    const BrickStore store = filled(scene.texture);
    const int cells = scene.texture.description.size[0] < 32 ? 8 : 16;
    const std::uint64_t brick =
        brick_bytes(std::uint64_t(cells), bytes_in_texture(scene.texture.description.type));
    for (const std::uint64_t bricks : {1, 2, 6}) {
      leave(bricks * brick);
      GlslRayCaster caster(store, device(), cells);
      const GlImage parts = draw(caster, scene.request);
      const BrickFigures figures = caster.brick_figures();
      const Difference d = difference(parts.image, one.image);
      worst = std::max(worst, d.max);
      evictions += figures.evictions;
      EXPECT_GT(figures.bricks, figures.slots) << scene.name;
      EXPECT_LE(figures.slots, bricks) << scene.name;
      EXPECT_GE(std::uint64_t(figures.passes), figures.uploads / bricks) << scene.name;
      EXPECT_EQ(figures.evictions, figures.uploads - std::min(figures.uploads, std::uint64_t(figures.slots)))
          << scene.name;
      EXPECT_LE(d.max, 1e-5) << scene.name << ", " << bricks << " bricks";
      EXPECT_EQ(parts.counts.samples, one.counts.samples) << scene.name;
      EXPECT_EQ(parts.counts.rays, one.counts.rays) << scene.name;
      EXPECT_GT(parts.counts.samples_taken, one.counts.samples_taken / 2) << scene.name;
    }
  }
  EXPECT_GT(evictions, 0U);
  std::printf("bricks against one texture: largest difference %.1e, %llu evictions\n", worst,
              static_cast<unsigned long long>(evictions));
}

TEST_P(GlslBricksOn, TakeEverySmallSize) {
  double worst = 0;
  int by_bricks = 0;
  for (int size = 1; size <= 33; size += size < 9 ? 1 : 4)
    for (const Wrap wrap : {Wrap::edge, Wrap::border, Wrap::repeat}) {
      const Texture texture =
          noise(describe({size, 34 - size, (size + 4) % 33 + 1}, TexelType::u8, wrap), unsigned(size));
      const RenderRequest request = request_for(texture, usual_camera(width, height), width, height, 40);
      const GlImage one = whole(texture, request);
      leave(brick_bytes(8, 2));
      const BrickStore store = filled(texture);
      GlslRayCaster caster(store, device(), 8);
      const Difference d = difference(draw(caster, request).image, one.image);
      worst = std::max(worst, d.max);
      by_bricks += caster.brick_figures().slots == 1 ? 1 : 0;  // the smallest volumes fit without bricks
      EXPECT_LE(d.max, 1e-5) << size << " texels along x, wrap " << int(wrap);
    }
  EXPECT_GT(by_bricks, 30);
  std::printf("largest difference from one texture %.1e\n", worst);
}

TEST_P(GlslBricksOn, StayWhereAllThatIsSeenFits) {
  const Texture texture = sampled(describe({48, 48, 48}, TexelType::u8), sphere_field(0.3));
  RenderRequest request = request_for(texture, usual_camera(width, height), width, height, 60);
  request.classification = sparse_table();
  const BrickStore store = filled(texture);
  leave(64 * brick_bytes(8, 2));
  GlslRayCaster caster(store, device(), 8);
  draw(caster, request);
  const BrickFigures first = caster.brick_figures();
  EXPECT_EQ(first.bricks, 216U);
  EXPECT_GT(first.uploads, 0U);
  EXPECT_LE(first.uploads, first.slots) << "air takes no memory";
  EXPECT_EQ(first.passes, 1);
  draw(caster, request);
  const BrickFigures second = caster.brick_figures();
  EXPECT_EQ(second.uploads, first.uploads);
  EXPECT_EQ(second.evictions, 0U);
}

TEST_P(GlslBricksOn, AreThoseThatTheTableShows) {
  // Values increase along x: low values lie in the bricks at the left, high values in those at the right.
  const Texture texture = sampled(describe({65, 33, 33}, TexelType::u8), linear_field({0.9, 0, 0}, 0.05));
  RenderRequest request = request_for(texture, usual_camera(width, height), width, height, 60);
  const auto showing = [](int first, int last) {
    TransferFunction f;
    f.entries.resize(64);
    for (int i = first; i < last; ++i) f.entries[std::size_t(i)] = {0.05F, 0.03F, 0.01F, 0.05F};
    return f;
  };
  const BrickStore store = filled(texture);
  const TransferFunction low = showing(0, 16), high = showing(48, 64);
  request.classification = low;
  const GlImage left = whole(texture, request);
  request.classification = high;
  const GlImage right = whole(texture, request);
  leave(4 * brick_bytes(16, 2));
  GlslRayCaster caster(store, device(), 16);
  request.classification = low;
  EXPECT_LE(difference(draw(caster, request).image, left.image).max, 1e-5);
  const BrickFigures before = caster.brick_figures();
  request.classification = high;
  EXPECT_LE(difference(draw(caster, request).image, right.image).max, 1e-5);
  const BrickFigures after = caster.brick_figures();
  EXPECT_GT(after.uploads, before.uploads);
  EXPECT_GT(after.evictions, before.evictions);
  EXPECT_GT(difference(left.image, right.image).max, 0.1);
}

TEST_P(GlslBricksOn, BehindWhatIsOpaqueNeverCome) {
  const Texture texture = noise(describe({49, 49, 49}, TexelType::u8), 2);
  RenderRequest request = request_for(texture, usual_camera(width, height), width, height, 100);
  request.classification = TransferFunction{0, 1, {{0.5F, 0.5F, 0.5F, 0.9F}, {0.9F, 0.9F, 0.9F, 0.9F}}};
  request.termination = 1e-6F;
  const GlImage one = whole(texture, request);
  const BrickStore store = filled(texture);
  leave(brick_bytes(8, 2));
  GlslRayCaster caster(store, device(), 8);
  EXPECT_LE(difference(draw(caster, request).image, one.image).max, 1e-5);
  EXPECT_EQ(caster.brick_figures().bricks, 216U);
  EXPECT_LT(caster.brick_figures().uploads, 180U);
}

TEST_P(GlslBricksOn, FollowTexelsThatChange) {
  const VolumeDescription description = describe({40, 33, 27}, TexelType::u8);
  const Texture before = sampled(description, sphere_field(0.2)),
                after = sampled(description, sphere_field(0.4));
  RenderRequest request = request_for(before, usual_camera(width, height), width, height, 50);
  request.classification = sparse_table();
  const GlImage expected = whole(after, request);
  EXPECT_GT(difference(whole(before, request).image, expected.image).max, 0.1);
  for (const std::uint64_t bricks : {1, 8, 12}) {
    leave(bricks * brick_bytes(16, 2));
    BrickStore store = filled(before);
    GlslRayCaster caster(store, device(), 16);
    draw(caster, request);
    std::vector<std::size_t> blocks;
    store.change(description.stored, after.texels, blocks);
    caster.blocks_changed(blocks);
    EXPECT_LE(difference(draw(caster, request).image, expected.image).max, 1e-5) << bricks << " bricks";
  }
}

TEST_P(GlslBricksOn, TakeVolumesLongerThanTextures) {
  const int length = device().max_volume_edge() + 77;
  if (length > max_axis_texels) GTEST_SKIP() << "this OpenGL takes the longest volume that there is";
  const Texture texture = sampled(describe({length, 9, 5}, TexelType::u16), linear_field({0.6, 0.3, 0.1}, 0));
  const RenderRequest request = request_for(texture, usual_camera(width, height), width, height, 70);
  const BrickStore store = filled(texture);
  GlslRayCaster caster(store, device());
  const GlImage gl = draw(caster, request);
  EXPECT_EQ(caster.brick_figures().passes, 1);
  EXPECT_GT(caster.brick_figures().bricks, 30U);
  EXPECT_LE(difference(gl.image, on_cpu({"", texture, request}).image).max, 1e-4);
}

TEST_P(GlslBricksOn, NeedMemoryForOne) {
  const Texture texture = noise(describe({40, 40, 40}, TexelType::u8), 2);
  const RenderRequest request = request_for(texture, usual_camera(width, height), width, height, 50);
  const BrickStore store = filled(texture);
  leave(brick_bytes(16, 2) - 1);
  GlslRayCaster caster(store, device(), 16);
  Image image(request.window);
  FrameCounts counts;
  try {
    caster.render(request, image, counts);
    FAIL() << "there is no room for a brick";
  } catch (const NotSupported& refused) {
    EXPECT_THAT(refused.what(), HasSubstr("one brick of the volume takes 9826"));
    EXPECT_THAT(refused.what(), HasSubstr("--gpu-memory"));
  }
  EXPECT_EQ(counts.samples, 0U);
  leave(brick_bytes(16, 2));
  EXPECT_NO_THROW(draw(caster, request));
}

TEST_P(GlslBricksOn, GiveTheirMemoryBack) {
  const Texture texture = noise(describe({40, 40, 40}, TexelType::u8), 2);
  const RenderRequest request = request_for(texture, usual_camera(width, height), width, height, 50);
  const BrickStore store = filled(texture);
  const std::uint64_t all = device().texture_memory().left();
  {
    GlslRayCaster caster(store, device());
    draw(caster, request);
    EXPECT_EQ(device().texture_memory().left(), all - std::uint64_t(40 * 40 * 40 * 2));
    leave(3 * brick_bytes(16, 2));
    GlslRayCaster other(store, device(), 16);
    draw(other, request);
    EXPECT_EQ(device().texture_memory().left(), 0U);
  }
  leave_all();
  EXPECT_EQ(device().texture_memory().left(), all);
}

TEST_P(GlslBricksOn, WithTexelsThatAreNotNumbersAreForTheCpu) {
  Texture texture = sampled(describe({33, 17, 17}, TexelType::f32), linear_field({0.4, 0.3, 0.2}, 0.05));
  const float none = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(texture.texels.data() + sizeof none * 2000, &none, sizeof none);
  const RenderRequest request = request_for(texture, usual_camera(width, height), width, height, 30);
  const BrickStore store = filled(texture);
  leave(brick_bytes(16, 4));
  GlslRayCaster caster(store, device(), 16);
  EXPECT_THROW(draw(caster, request), NotSupported);
}

INSTANTIATE_TEST_SUITE_P(Offscreen, GlslBricksOn, ::testing::Values(Platform::egl, Platform::osmesa),
                         [](const auto& info) { return info.param == Platform::egl ? "Egl" : "OsMesa"; });

}  // namespace
}  // namespace understudy::volume::glsl
