// SPDX-License-Identifier: Apache-2.0
// Texels that change after a volume is complete: store and images equal those of a volume that was filled with
// the new texels from the start.
#include <gtest/gtest.h>

#include <cstdio>
#include <set>
#include <string>

#include "tests/volume/scenes.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/kd_tree.h"
#include "volume/raycast/ray_caster.h"
#include "volume/request.h"

namespace understudy::volume::testing {
namespace {

std::vector<std::byte> texels_of(const Texture& texture, const TexelBox& box) {
  const std::size_t bytes = bytes_per_texel(texture.description.type);
  std::vector<std::byte> texels(texels_in(box) * bytes);
  copy_texels(box, bytes, texture.description.stored, texture.texels, box, texels);
  return texels;
}

void put(Texture& texture, const TexelBox& box, std::span<const std::byte> texels) {
  copy_texels(box, bytes_per_texel(texture.description.type), box, texels, texture.description.stored,
              texture.texels);
}

void expect_equal(const BrickStore& a, const BrickStore& b) {
  ASSERT_EQ(a.blocks(), b.blocks());
  const std::size_t bytes = BrickStore::block_texels * bytes_per_texel(a.description().type);
  const std::size_t channels = a.description().type == TexelType::rgba8 ? 4 : 1;
  for (std::size_t i = 0; i < a.blocks(); ++i) {
    ASSERT_EQ(std::memcmp(a.block_data()[i], b.block_data()[i], bytes), 0) << "block " << i;
    for (std::size_t k = 0; k < channels; ++k) {
      ASSERT_EQ(a.ranges(i)[k].low, b.ranges(i)[k].low) << "block " << i;
      ASSERT_EQ(a.ranges(i)[k].high, b.ranges(i)[k].high) << "block " << i;
    }
  }
}

Image image(RayCaster& caster, const RenderRequest& request) {
  Image image(request.window);
  FrameCounts counts;
  caster.render(request, image, counts);
  return image;
}

struct Kind {
  TexelType type;
  Wrap wrap;
  Operator op;
};

class Changes : public ::testing::TestWithParam<Kind> {};

TEST_P(Changes, EqualAFreshVolumeBitForBit) {
  const Kind& kind = GetParam();
  const unsigned seed = 20261121;
  std::printf("seed %u\n", seed);
  std::mt19937 random(seed);
  VolumeDescription description = describe({43, 37, 29}, kind.type, kind.wrap);
  if (kind.wrap != Wrap::repeat) description.stored = {{2, 0, 1}, {40, 37, 29}};
  const TexelBox stored = description.stored;
  for (const int ranks : {1, 4}) {
    const KdTree tree(description, ranks);
    for (int rank = 0; rank < ranks; ++rank) {
      Texture texture = noise(description, 5);
      BrickStore store = filled(texture, tree.box(rank));
      RayCaster caster(store);
      RenderRequest request = request_for(texture, usual_camera(40, 30), 40, 30, 60);
      request.op = kind.op;
      image(caster, request);
      for (int round = 0; round < 12; ++round) {
        TexelBox box;
        for (std::size_t k = 0; k < 3; ++k) {
          const int extent = stored.high[k] - stored.low[k];
          box.low[k] = stored.low[k] + int(random() % unsigned(extent));
          box.high[k] = box.low[k] + 1 + int(random() % unsigned(stored.high[k] - box.low[k]));
        }
        // Constant boxes make blocks share their storage; a later round separates them again.
        Texture other = noise(description, unsigned(random()));
        if (round % 2 == 0) {
          const std::vector<std::byte> same(bytes_per_texel(kind.type), std::byte(round % 4 == 0 ? 0 : 0x3c));
          for (std::size_t i = 0; i < other.texels.size(); ++i) other.texels[i] = same[i % same.size()];
        }
        const std::vector<std::byte> texels = texels_of(other, box);
        put(texture, box, texels);
        std::vector<std::size_t> changed;
        store.change(box, texels, changed);
        caster.blocks_changed(changed);
        const BrickStore fresh = filled(texture, tree.box(rank));
        expect_equal(store, fresh);
        RayCaster of_fresh(fresh);
        ASSERT_EQ(image(caster, request).rgba, image(of_fresh, request).rgba)
            << "round " << round << ", rank " << rank << " of " << ranks;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Of, Changes,
                         ::testing::Values(Kind{TexelType::u8, Wrap::edge, Operator::over},
                                           Kind{TexelType::u8, Wrap::repeat, Operator::max},
                                           Kind{TexelType::u16, Wrap::border, Operator::over},
                                           Kind{TexelType::f32, Wrap::edge, Operator::min},
                                           Kind{TexelType::f32, Wrap::repeat, Operator::add},
                                           Kind{TexelType::rgba8, Wrap::border, Operator::over}),
                         [](const auto& info) { return "Kind" + std::to_string(info.index); });

TEST(Changes, TouchNoBlockThatDoesNotShowTheTexels) {
  const Texture texture = noise(describe({64, 64, 64}, TexelType::u8), 9);
  BrickStore store = filled(texture);
  std::vector<std::size_t> changed;
  // Texels 0 to 7 belong to the first block only; texel 8 lies on the face to the next block.
  store.change({{0, 0, 0}, {8, 8, 8}}, std::vector<std::byte>(512), changed);
  EXPECT_EQ(changed, std::vector<std::size_t>{0});
  changed.clear();
  store.change({{8, 3, 3}, {9, 4, 4}}, std::vector<std::byte>(1), changed);
  EXPECT_EQ(changed, (std::vector<std::size_t>{0, 1}));
}

TEST(Changes, GiveMemoryBack) {
  const VolumeDescription description = describe({64, 64, 64}, TexelType::f32);
  Texture texture = noise(description, 10);
  BrickStore store = filled(texture);
  const std::size_t before = store.bytes();
  std::vector<std::size_t> changed;
  for (int round = 0; round < 20; ++round) {
    const Texture next = round % 2 == 0 ? sampled(description, constant_field(0.01 * round))
                                        : noise(description, unsigned(round));
    store.change(description.stored, next.texels, changed);
  }
  EXPECT_LE(store.bytes(), before + before / 4) << "a film costs no more than two of its frames";
}

TEST(TexelsShown, OfAllRanksAreAllThatIsStored) {
  for (const Wrap wrap : {Wrap::edge, Wrap::repeat})
    for (const int ranks : {1, 3, 8}) {
      const VolumeDescription description = describe({43, 37, 29}, TexelType::u8, wrap);
      const KdTree tree(description, ranks);
      std::vector<bool> shown(std::size_t(43 * 37 * 29));
      for (int rank = 0; rank < ranks; ++rank) {
        const TexelBox box = BrickStore::texels_shown(description, tree.box(rank));
        ASSERT_TRUE(contains(description.stored, box));
        for (int z = box.low[2]; z < box.high[2]; ++z)
          for (int y = box.low[1]; y < box.high[1]; ++y)
            for (int x = box.low[0]; x < box.high[0]; ++x) shown[(z * 37 + y) * 43 + x] = true;
      }
      EXPECT_EQ(std::count(shown.begin(), shown.end(), false), 0) << ranks << " ranks";
    }
  EXPECT_TRUE(is_empty(BrickStore::texels_shown(describe({4, 4, 4}, TexelType::u8), {})));
}

}  // namespace
}  // namespace understudy::volume::testing
