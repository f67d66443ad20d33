// SPDX-License-Identifier: Apache-2.0
// Bricks, the transfer function's emptiness query, and the distance map.
#include <gmock/gmock.h>

#include "tests/volume/scenes.h"
#include "volume/raycast/occupancy_map.h"
#include "volume/raycast/transfer_table.h"
#include "volume/request.h"

namespace understudy::volume::testing {
namespace {

TEST(BrickStore, HoldsEveryTexelOfEveryCell) {
  for (const Wrap wrap : {Wrap::edge, Wrap::repeat}) {
    const Texture texture = noise(describe({19, 23, 13}, TexelType::u8, wrap), 61);
    const VolumeDescription& d = texture.description;
    const CellLattice lattice = cell_lattice(d);
    for (const TexelBox& cells : {lattice.box(), TexelBox{{3, 8, 2}, {11, 16, 12}}}) {
      const BrickStore store = filled(texture, cells);
      const auto& counts = store.block_counts();
      for (int z = cells.low[2]; z < cells.high[2]; ++z)
        for (int y = cells.low[1]; y < cells.high[1]; ++y)
          for (int x = cells.low[0]; x < cells.high[0]; ++x)
            for (int corner = 0; corner < 8; ++corner) {
              std::size_t block = 0, stride = 1;
              int inside = 0, place = 1;
              std::size_t expected = 0, texture_stride = 1;
              const std::array<int, 3> cell{x, y, z};
              for (int k = 0; k < 3; ++k) {
                const int local = cell[k] - lattice.origin[k];
                block += std::size_t(local / 8 - store.first_block()[k]) * stride;
                inside += (local % 8 + (corner >> k & 1)) * place;
                stride *= std::size_t(counts[k]);
                place *= 9;
                const int texel = (cell[k] + (corner >> k & 1) + d.size[k]) % d.size[k];
                expected += std::size_t(texel) * texture_stride;
                texture_stride *= std::size_t(d.size[k]);
              }
              ASSERT_EQ(store.block_data()[block][inside], texture.texels[expected]);
            }
    }
  }
}

TEST(BrickStore, TakesSliceRangesInAnyOrder) {
  const Texture texture = noise(describe({19, 23, 33}, TexelType::u16), 62);
  const RenderRequest request = request_for(texture, usual_camera(21, 17), 21, 17, 40);
  const BrickStore whole = filled(texture);
  BrickStore pieces(texture.description, cell_lattice(texture.description).box());
  const std::size_t slice = 19 * 23 * 2;
  for (const auto& [first, count] : {std::pair{20, 13}, {0, 1}, {5, 15}, {1, 4}})
    pieces.add_slices(
        {{0, 0, first}, {19, 23, first + count}},
        std::span(texture.texels).subspan(std::size_t(first) * slice, std::size_t(count) * slice));
  pieces.finish();
  for (std::size_t b = 0; b < whole.blocks(); ++b)
    EXPECT_EQ(std::memcmp(whole.block_data()[b], pieces.block_data()[b], 729 * 2), 0);
}

TEST(BrickStore, RefusesWrongSliceRanges) {
  const Texture texture = noise(describe({5, 6, 7}, TexelType::u8), 63);
  BrickStore store(texture.description, cell_lattice(texture.description).box());
  const std::span<const std::byte> all = texture.texels;
  const auto slice_range = [](int first, int end) { return TexelBox{{0, 0, first}, {5, 6, end}}; };
  EXPECT_THROW(store.add_slices(slice_range(0, 7), all.first(100)), std::invalid_argument);
  EXPECT_THROW(store.add_slices(slice_range(-1, 0), all.first(30)), std::invalid_argument);
  EXPECT_THROW(store.add_slices(slice_range(6, 8), all.first(60)), std::invalid_argument);
  EXPECT_THROW(store.add_slices(slice_range(0, 0), {}), std::invalid_argument);
  EXPECT_THROW(store.add_slices(slice_range(3, std::numeric_limits<int>::max()), all), std::invalid_argument);
  EXPECT_THROW(store.add_slices({{0, 0, 0}, {4, 6, 1}}, all.first(24)), std::invalid_argument) << "too narrow";
  store.add_slices(slice_range(0, 3), all.first(90));
  EXPECT_THROW(store.add_slices(slice_range(2, 3), all.first(30)), std::invalid_argument);
  EXPECT_THROW(store.finish(), std::invalid_argument);
  std::vector<std::size_t> changed;
  EXPECT_THROW(store.change(slice_range(0, 1), all.first(30), changed), std::invalid_argument)
      << "not finished";
  store.add_slices(slice_range(3, 7), all.first(120));
  EXPECT_NO_THROW(store.finish());

  VolumeDescription d = texture.description;
  d.size = {0, 6, 7};
  EXPECT_THROW(cell_lattice(d), std::invalid_argument);
  d.size = {max_axis_texels + 1, 6, 7};
  EXPECT_THROW(cell_lattice(d), std::invalid_argument);
  d = texture.description;
  d.stored.high[1] = 7;
  EXPECT_THROW(cell_lattice(d), std::invalid_argument);
  EXPECT_THROW(BrickStore(texture.description, {{0, 0, 0}, {5, 5, 6}}), std::invalid_argument);
  const VolumeDescription vast = describe({max_axis_texels, max_axis_texels, max_axis_texels}, TexelType::u8);
  EXPECT_THROW(BrickStore(vast, cell_lattice(vast).box()), std::invalid_argument);
}

TEST(BrickStore, CostsHalfAgainAtMostAndPaddingNothing) {
  const Texture dense = noise(describe({128, 128, 128}, TexelType::u8), 64);
  const double ratio = double(filled(dense).bytes()) / double(dense.texels.size());
  std::printf("128^3 u8, dense: %.3f times the raw size\n", ratio);
  EXPECT_LE(ratio, 1.5);

  const Texture padded = sampled(describe({128, 128, 128}, TexelType::u8), [](const Vec3& t) {
    return t[0] < 0.25 && t[1] < 0.25 ? std::fmod(91.7 * t[2] + 17.3 * t[0] + 3.1 * t[1], 1.0) : 0.0;
  });
  const double padded_ratio = double(filled(padded).bytes()) / double(padded.texels.size());
  std::printf("with 15/16 of it padding: %.3f times\n", padded_ratio);
  EXPECT_LE(padded_ratio, 0.25);
}

TEST(TransferTable, SaysExactlyWhichRangesShow) {
  std::mt19937 random(65);
  int showing = 0, clear = 0;
  for (int trial = 0; trial < 300; ++trial) {
    TransferFunction f;
    const int entries = 2 + int(random() % 40);
    for (int i = 0; i < entries; ++i)
      f.entries.push_back(random() % 6 == 0 ? Rgba{0, random() % 2 ? 0.3F : 0, 0, 0.1F} : Rgba{});
    f.low = trial % 3 ? 0.0F : 0.2F;
    f.high = trial % 2 ? 1.0F : 0.7F;
    const TransferTable table(f, TexelType::f32, 0);
    for (int range = 0; range < 40; ++range) {
      float low = float(random() % 1000) / 900 - 0.05F, high = float(random() % 1000) / 900 - 0.05F;
      if (low > high) std::swap(low, high);
      // Brute force: the piecewise linear table is visible within the range exactly if it is not 0 at one of
      // the range's ends, at an entry inside, or between.
      bool shows = false;
      const double last = entries - 1;
      const auto position = [&](double v) {
        return std::clamp((v - double(f.low)) / (double(f.high) - double(f.low)) * last, 0.0, last);
      };
      const double a = position(low), b = position(high);
      for (int i = 0; i <= 2000; ++i) {
        const double p = a + (b - a) * i / 2000;
        const auto below = std::size_t(p), above = std::min(below + 1, std::size_t(entries - 1));
        for (std::size_t k = 0; k < 4; ++k)
          shows =
              shows ||
              (1 - (p - double(below))) * f.entries[below][k] + (p - double(below)) * f.entries[above][k] != 0;
      }
      const bool said = table.shows({low, high});
      // Within rounding of an entry, either answer is correct.
      const auto at_entry = [](double p) { return std::abs(p - std::round(p)) < 1e-4; };
      if (!at_entry(a) && !at_entry(b)) {
        EXPECT_EQ(said, shows) << "trial " << trial << ", seed 65";
      }
      (said ? showing : clear) += 1;
    }
    EXPECT_FALSE(table.shows({1, 0})) << "no values";
  }
  EXPECT_GT(showing, 1000);
  EXPECT_GT(clear, 1000);
}

TEST(TransferTable, HasExactAnswersForTexelValues) {
  TransferFunction spike;
  spike.entries.assign(256, Rgba{});
  spike.entries[100] = {1, 1, 1, 1};
  const TransferTable table(spike, TexelType::u8, 0);
  EXPECT_FALSE(table.shows({0, 99}));
  EXPECT_FALSE(table.shows({101, 255}));
  EXPECT_TRUE(table.shows({100, 100}));
  EXPECT_TRUE(table.shows({99, 101}));
}

TEST(OccupancyMap, EqualsTheChebyshevDistance) {
  std::mt19937 random(66);
  for (const std::array<int, 3> n : {std::array{7, 5, 9}, {1, 1, 30}, {12, 12, 1}, {1, 1, 1}, {300, 1, 1}})
    for (const unsigned rarity : {2U, 40U, 100000U}) {
      const std::size_t count = std::size_t(n[0]) * n[1] * n[2];
      std::vector<bool> shows(count);
      for (std::size_t b = 0; b < count; ++b) shows[b] = random() % rarity == 0;
      const OccupancyMap map(n, shows);
      for (std::size_t b = 0; b < count; ++b) {
        const auto at = [&](std::size_t i) {
          return std::array{int(i) % n[0], int(i) / n[0] % n[1], int(i) / n[0] / n[1]};
        };
        int nearest = 255;
        for (std::size_t other = 0; other < count; ++other) {
          if (!shows[other]) continue;
          int distance = 0;
          for (std::size_t k = 0; k < 3; ++k) distance = std::max(distance, std::abs(at(b)[k] - at(other)[k]));
          nearest = std::min(nearest, distance);
        }
        ASSERT_EQ(map.distances()[b], nearest);
      }
      EXPECT_EQ(map.empty_bricks(), std::size_t(std::count(shows.begin(), shows.end(), false)));
    }
}

TEST(Inverse, UndoesTheMatrixAndRefusesSingularOnes) {
  std::mt19937 random(67);
  std::uniform_real_distribution<double> uniform(-1, 1);
  double worst = 0;
  for (int trial = 0; trial < 200; ++trial) {
    Matrix4 m;
    for (double& v : m) v = uniform(random);
    for (int k = 0; k < 4; ++k) {
      m[4 * (trial % 4) + k] *= 1e6;  // extreme scales are no reason for refusal
      m[4 * k + trial / 4 % 4] *= 1e-6;
    }
    const auto back = inverse(m);
    ASSERT_TRUE(back);
    const Matrix4 product = multiply(m, *back);
    for (int i = 0; i < 4; ++i)
      for (int k = 0; k < 4; ++k) {
        const double row_scale = i == trial % 4 ? 1e6 : 1, column_scale = k == trial % 4 ? 1e6 : 1;
        worst = std::max(worst, std::abs(product[4 * i + k] - (i == k)) / row_scale * column_scale);
      }
    Matrix4 singular = m;
    for (int k = 0; k < 4; ++k) singular[12 + k] = 0.3 * m[k] - 2 * m[4 + k] + m[8 + k];
    EXPECT_FALSE(inverse(singular)) << trial;
  }
  std::printf("largest error %.2e\n", worst);
  EXPECT_LE(worst, 1e-10);
  EXPECT_FALSE(inverse(Matrix4{}));
  Matrix4 infinite = identity();
  infinite[3] = INFINITY;
  EXPECT_FALSE(inverse(infinite));
}

TEST(HalfSpaces, MoveWithTheirPoints) {
  const Matrix4 m = multiply(look_at({0.9, 0.7, 1.6}, {0, 0, 0}, {0, 1, 0}), unit_cube());
  const HalfSpace plane{{0.3, -0.4, 0.8}, 0.2};
  const HalfSpace moved = transform_half_space(*inverse(m), plane);
  const Vec3 p{0.2, 0.9, -3};
  const Vec4 q = transform_point(m, p);
  EXPECT_NEAR(dot(moved.normal, {q[0], q[1], q[2]}) + moved.offset, dot(plane.normal, p) + plane.offset, 1e-12);
}

}  // namespace
}  // namespace understudy::volume::testing
