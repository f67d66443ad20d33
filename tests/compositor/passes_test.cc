// SPDX-License-Identifier: Apache-2.0
// Volumes that are shown in parts: images equal those of the whole volume, parts that cannot be seen are not
// loaded, and no rank exceeds its memory limit.
#include <gtest/gtest.h>

#include <cstdio>
#include <limits>
#include <random>

#include "compositor/passes/pass_plan.h"
#include "compositor/passes/pass_renderer.h"
#include "tests/compositor/loading_group.h"
#include "volume/brick/brick_store.h"
#include "volume/cell_lattice.h"
#include "volume/file/hierarchical_writer.h"
#include "volume/file/volume_file.h"
#include "volume/opening/open_volume.h"

namespace understudy::compositor {
namespace {

using namespace testing;
using volume::Operator;
using volume::TexelBox;
using volume::TexelType;

class Passes : public LoadingGroup {
 protected:
  std::string write_raw(const Texture& texture) const {
    return write("v_41x37x29_" + std::string(name_of(texture.description.type)) + ".raw", texture.texels);
  }

  /// A volume shown in `parts` parts by `service`.
  struct Shown {
    Shown(LoadingService& service, const Texture& texture, const std::string& path, int parts)
        : file(volume::open_volume(path)),
          renderer(service, *file, {texture.description, path, {}, {}},
                   volume::by_blocks(texture.description, parts), [](int, int, std::span<const RankLoad>) {}) {}

    volume::Image image(const volume::RenderRequest& request) {
      return whole_image(renderer.render(request), request);
    }

    std::unique_ptr<volume::VolumeFile> file;
    PassRenderer renderer;
  };
};

TEST_F(Passes, ShowTheImagesOfTheWholeVolume) {
  for (const auto& [ranks, sort] :
       {std::pair{0, Sort::last}, {3, Sort::last}, {3, Sort::automatic}, {2, Sort::first}}) {
    const auto loading = service(ranks, {.sort = sort});
    double worst = 0;
    for (const TexelType type : {TexelType::u8, TexelType::f32}) {
      Texture texture = some_texture(7, type);
      texture.description.ghost_layer = 3;  // for light
      const std::string path = write_raw(texture);
      const auto sent = embedded_service();
      upload(*sent, texture);
      for (const int parts : {2, 5, 12}) {
        Shown shown(*loading, texture, path, parts);
        const auto compare = [&](const volume::RenderRequest& request) {
          worst = std::max(worst, largest_difference(shown.image(request), image_of(*sent, request)));
        };
        shown.renderer.load(some_request(texture));
        EXPECT_EQ(shown.renderer.figures().loads, parts) << "the file does not tell its values";
        for (const Operator op : {Operator::over, Operator::max, Operator::min, Operator::add})
          compare(some_request(texture, op));
        volume::RenderRequest request = request_on_steps(texture);
        for (const volume::Method method : {volume::Method::post_classified, volume::Method::pre_integrated}) {
          request.method = method;
          compare(request);
        }
        request.surfaces = {{0.4F, {1, 0.5F, 0.2F, 0.8F}}};
        request.light.emplace();
        compare(request);
      }
    }
    std::printf("%d ranks: at most %.2g apart\n", ranks, worst);
    EXPECT_LE(worst, 1e-5);
    dismiss();
  }
}

/// Opaque in the half of the volume nearer to the usual camera, elsewhere only a haze.
Texture opaque_in_front() {
  Texture texture = some_texture(7, TexelType::u8);
  const auto& size = texture.description.size;
  std::size_t at = 0;
  for (int z = 0; z < size[2]; ++z)
    for (int y = 0; y < size[1]; ++y)
      for (int x = 0; x < size[0]; ++x) texture.texels[at++] = std::byte(z >= 18 ? 255 : x < 24 ? 40 : 0);
  return texture;
}

TEST_F(Passes, LeaveOutWhatIsInvisibleOrHidden) {
  const Texture texture = opaque_in_front();
  const std::string path = write_raw(texture);
  const auto sent = embedded_service();
  upload(*sent, texture);
  const auto loading = service(2);
  Shown shown(*loading, texture, path, 8);
  volume::RenderRequest request = some_request(texture);
  request.termination = 1e-4F;
  volume::TransferFunction table;
  for (int i = 0; i < 256; ++i) {
    const float alpha = i > 200 ? 0.9F : i > 30 ? 0.01F : 0;
    table.entries.push_back({alpha, alpha / 2, 0, alpha});
  }
  request.classification = table;
  shown.renderer.load(request);
  const int loads = shown.renderer.figures().loads;
  EXPECT_EQ(loads, 8);
  EXPECT_LE(largest_difference(shown.image(request), image_of(*sent, request)), 1e-4);
  const PassFigures& figures = shown.renderer.figures();
  EXPECT_GT(figures.empty, 0);
  EXPECT_GT(figures.hidden, 0);
  EXPECT_LE(figures.loads - loads, 8 - figures.empty - figures.hidden);
  std::printf("of 8 parts %d empty, %d hidden\n", figures.empty, figures.hidden);
  const std::vector<RankLoad> ranks = shown.renderer.ranks();
  EXPECT_GT(ranks[0].image_samples + ranks[1].image_samples, 0U);
}

TEST_F(Passes, ReadNoFileForTheValuesThatItTells) {
  const Texture texture = opaque_in_front();
  const std::string path = folder_ / "v.uvol";
  volume::write_hierarchical(*volume::open_volume(write_raw(texture)), path, {});
  const auto loading = service(0);
  Shown shown(*loading, texture, path, 4);
  volume::RenderRequest request = some_request(texture);
  shown.renderer.load(request);
  EXPECT_EQ(shown.renderer.figures().loads, 0);
  const auto sent = embedded_service();
  upload(*sent, texture);
  EXPECT_LE(largest_difference(shown.image(request), image_of(*sent, request)), 1e-5);
  // Under `min` a sample shows even if it is 0.
  request.op = Operator::min;
  EXPECT_LE(largest_difference(shown.image(request), image_of(*sent, request)), 1e-5);
  request.op = Operator::over;
  // If nothing is visible, nothing is read.
  request.classification = volume::TransferFunction{0, 1, {{0, 0, 0, 0}, {0, 0, 0, 0}}};
  const int loads = shown.renderer.figures().loads;
  EXPECT_LE(largest_difference(shown.image(request), volume::Image(request.window)), 0);
  EXPECT_EQ(shown.renderer.figures().loads, loads);
}

TEST(PassPlan, BricksTakeNoMoreThanTheyMay) {
  std::mt19937 random(11);
  const auto up_to = [&](int most) { return int(random() % unsigned(most)) + 1; };
  for (int trial = 0; trial < 60; ++trial) {
    volume::VolumeDescription description =
        volume::testing::describe({up_to(70), up_to(70), up_to(70)},
                                  std::array{TexelType::u8, TexelType::u16, TexelType::f32}[trial % 3]);
    description.ghost_layer = trial % 4;
    const TexelBox all = volume::shown_cells(description);
    TexelBox cells;
    for (std::size_t k = 0; k < 3; ++k) {
      cells.low[k] = up_to(all.high[k]) - 1;
      cells.high[k] = std::min(all.high[k], cells.low[k] + up_to(50));
    }
    volume::BrickStore store(description, cells);
    const TexelBox shown = store.texels_shown();
    std::size_t most = store.bytes();
    for (int z = shown.low[2]; z < shown.high[2]; ++z) {
      TexelBox slice = shown;
      slice.low[2] = z;
      slice.high[2] = z + 1;
      std::vector<std::byte> texels(volume::texels_in(slice) * volume::bytes_per_texel(description.type));
      for (std::byte& byte : texels) byte = std::byte(random() & 0x3F);  // no constant blocks
      store.add_slices(slice, texels);
      most = std::max(most, store.bytes());
    }
    store.finish();
    most = std::max(most, store.bytes());
    EXPECT_LE(most, volume::BrickStore::most_bytes(description, cells)) << trial;
  }
}

TEST(PassPlan, DividesUntilEveryRankHasRoom) {
  const auto file = volume::open_volume("synthetic:200x180x160:u16");
  volume::VolumeDescription description = volume::testing::describe({200, 180, 160}, TexelType::u16);
  description.ghost_layer = 1;
  int before = 1;
  for (const std::uint64_t mib : {200, 18, 12, 6, 3}) {
    const auto parts = passes_within(description, *file, 2, mib << 20U);
    ASSERT_TRUE(parts) << mib;
    EXPECT_GE(parts->ranks, before) << mib;
    before = parts->ranks;
    for (const TexelBox& part : volume::boxes(*parts, description)) {
      volume::VolumeDescription shown = description;
      shown.part = part;
      EXPECT_LE(bytes_of_rank(shown, *file, 2), mib << 20U);
    }
  }
  EXPECT_GT(before, 4);
  EXPECT_FALSE(passes_within(description, *file, 2, 100'000)) << "the smallest part takes more";
}

TEST(PassPlan, APartThatLiesOutsideIsRefused) {
  volume::VolumeDescription description = volume::testing::describe({20, 18, 16}, TexelType::u8);
  for (const TexelBox& part : {TexelBox{{0, 0, 0}, {20, 17, 15}}, TexelBox{{4, 4, 4}, {4, 9, 9}}}) {
    description.part = part;
    EXPECT_THROW(embedded_service()->begin_volume(description), RequestRefused);
  }
}

}  // namespace
}  // namespace understudy::compositor
