// SPDX-License-Identifier: Apache-2.0
// A store whose cells change holds the same blocks as a new one.
#include <gmock/gmock.h>

#include <cstring>

#include "tests/volume/scenes.h"
#include "volume/block_costs.h"
#include "volume/brick/brick_store.h"
#include "volume/cell_lattice.h"
#include "volume/footprint.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/partition.h"
#include "volume/raycast/ray_caster.h"
#include "volume/request.h"

namespace understudy::volume::testing {
namespace {

TexelBox random_cells(const TexelBox& lattice, std::mt19937& random) {
  TexelBox cells;
  for (int k = 0; k < 3; ++k) {
    std::uniform_int_distribution<int> cell(lattice.low[k], lattice.high[k]);
    const int a = cell(random), b = cell(random);
    cells.low[k] = std::min(a, b);
    cells.high[k] = std::max(a, b);
  }
  return cells;
}

void expect_same(const BrickStore& store, const BrickStore& fresh) {
  ASSERT_EQ(store.first_block(), fresh.first_block());
  ASSERT_EQ(store.block_counts(), fresh.block_counts());
  ASSERT_EQ(store.texels_shown(), fresh.texels_shown());
  const auto [nx, ny, nz] = fresh.block_counts();
  std::size_t block = 0;
  for (int z = 0; z < nz; ++z)
    for (int y = 0; y < ny; ++y)
      for (int x = 0; x < nx; ++x, ++block) {
        const BrickStore::BlockPlace place{x + fresh.first_block()[0], y + fresh.first_block()[1],
                                           z + fresh.first_block()[2]};
        ASSERT_EQ(store.packed(place), fresh.packed(place));
        for (std::size_t c = 0; c < fresh.ranges(block).size(); ++c) {
          EXPECT_EQ(store.ranges(block)[c].low, fresh.ranges(block)[c].low);
          EXPECT_EQ(store.ranges(block)[c].high, fresh.ranges(block)[c].high);
        }
      }
}

TEST(Reshape, ALongWayOfBoxesEndsWithTheBlocksOfANewStore) {
  const unsigned seed = 2601;
  std::printf("seed %u\n", seed);
  std::mt19937 random(seed);
  int trial = 0;
  for (const TexelType type : {TexelType::u8, TexelType::u16, TexelType::f32, TexelType::rgba8})
    for (const Wrap wrap : {Wrap::edge, Wrap::border, Wrap::repeat}) {
      VolumeDescription description = describe({37, 29, 41}, type, wrap);
      description.ghost_layer = trial++ % 3;
      Texture texture = noise(description, seed);
      // Half of the volume is constant, so that blocks are shared.
      std::fill(texture.texels.begin() + std::ptrdiff_t(texture.texels.size() / 2), texture.texels.end(),
                std::byte(0));
      const TexelBox lattice = cell_lattice(description).box();
      const BrickStore whole = filled(texture);
      BrickStore store = filled(texture, random_cells(lattice, random));
      std::size_t most = 0;
      for (int step = 0; step < 12; ++step) {
        const TexelBox cells = step == 5 ? TexelBox{lattice.low, lattice.low} : random_cells(lattice, random);
        store.reshape(cells, [&](const BrickStore::BlockPlace& place) { return whole.packed(place); });
        EXPECT_EQ(store.owned_cells(), cells);
        expect_same(store, filled(texture, cells));
        most = std::max(most, store.bytes());
      }
      // Released storage is reused: the total never exceeds that of a whole volume and one chunk.
      EXPECT_LE(most, 2 * whole.bytes());

      // Changes reach the added blocks, and images equal those of a new store.
      store.reshape(lattice, [&](const BrickStore::BlockPlace& place) { return whole.packed(place); });
      Texture changed = noise(description, seed + 1);
      std::vector<std::size_t> blocks;
      store.change(description.stored, changed.texels, blocks);
      expect_same(store, filled(changed));
      const RenderRequest request = request_for(changed, usual_camera(45, 39), 45, 39, 80);
      Image image(request.window), expected(request.window);
      FrameCounts counts;
      raycast(store, request, image, counts);
      raycast(filled(changed), request, expected, counts);
      EXPECT_EQ(image.rgba, expected.rgba);
    }
}

TEST(Reshape, RefusesWhatCannotBe) {
  const Texture texture = noise(describe({20, 20, 20}, TexelType::u8), 1);
  BrickStore store = filled(texture);
  const auto never = [](const BrickStore::BlockPlace&) { return std::vector<std::byte>(3); };
  EXPECT_THROW(store.reshape({{0, 0, 0}, {20, 20, 20}}, never), std::invalid_argument);
  expect_same(store, filled(texture));
  BrickStore unfinished(texture.description, cell_lattice(texture.description).box());
  EXPECT_THROW(unfinished.reshape({{0, 0, 0}, {8, 8, 8}}, never), std::logic_error);
  BrickStore part = filled(texture, {{0, 0, 0}, {8, 8, 8}});
  EXPECT_THROW(part.reshape({{0, 0, 0}, {16, 8, 8}}, never), std::logic_error);  // no block has 3 bytes
}

}  // namespace
}  // namespace understudy::volume::testing
