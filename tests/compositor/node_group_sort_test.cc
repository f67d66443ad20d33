// SPDX-License-Identifier: Apache-2.0
// Sort-first and hybrid: groups of ranks divide images.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

#include "compositor/service/client_limits.h"
#include "compositor/service/rank_renderer.h"
#include "compositor/sort/cost_image.h"
#include "tests/all_cases.h"
#include "tests/compositor/node_group.h"
#include "volume/frame_counts.h"

namespace understudy::compositor {
namespace {

using namespace testing;
using volume::Operator;
using volume::TexelType;

class NodeGroupSort : public NodeGroupTest {
 protected:
  Group& start_sorted(int ranks, Sort sort, const ExchangeSettings& exchange = drawn_first) {
    return start(ranks, limits::stall_patience, {}, exchange, {sort, std::uint64_t(1) << 40, 0});
  }
  void dismiss(const Group& group) {
    launcher_->ask([](Broker& b) { b.dismiss_node_group(); });
    EXPECT_TRUE(eventually([&] { return group.ended(); }));
  }
};

TEST(EstimatedCosts, AreWhatPartsOfAnImageTake) {
  constexpr double samples_per_ray = 14;
  RankRenderer renderer(0, 1);
  const Texture texture = some_texture();
  const VolumeKey key{1, texture.description.id};
  renderer.begin(1, texture.description);
  renderer.add_texels(key, {&texture.description.stored, 1}, texture.texels);
  renderer.end(key);
  volume::RenderRequest request =
      volume::testing::request_for(texture, volume::testing::usual_camera(640, 480), 640, 480, 300);
  request.termination = 1e-3F;  // early ray termination in the middle
  double whole = 0, worst = 0;
  std::vector<std::pair<double, double>> estimated_and_taken;
  for (const volume::Rect& part :
       {volume::Rect{0, 0, 320, 240}, volume::Rect{320, 0, 320, 240}, volume::Rect{0, 240, 320, 240},
        volume::Rect{320, 240, 320, 240}, volume::Rect{251, 177, 130, 131}}) {
    const std::vector<volume::Rect> tiles = tiles_of(part);
    double estimated = 0;
    for (const float cost : renderer.estimated_costs(1, request, tiles)) estimated += double(cost);
    volume::FrameCounts counts;
    renderer.render(1, request, counts, nullptr, part);
    const double taken = double(counts.samples_taken) + samples_per_ray * double(counts.rays);
    estimated_and_taken.emplace_back(estimated, taken);
    whole = std::max(whole, taken);
  }
  ASSERT_GT(whole, 1e5);
  for (const auto& [estimated, taken] : estimated_and_taken)
    worst = std::max(worst, std::abs(estimated - taken) / whole);
  std::printf("estimates are at most %.1f %% of the dearest part off\n", 100 * worst);
  EXPECT_LE(worst, 0.05);
}

TEST(RankRenderer, CountsVolumesOfOthersThatHaveTheSameId) {
  const volume::VolumeDescription description = some_texture().description;
  const auto bytes = std::uint64_t(volume::testing::stored_texels(description));
  // Two machines, each with room for one copy and a half.
  RankRenderer renderer(0, {0, 1}, volume::cpu_renderer, client_limits(1, {}),
                        {Sort::automatic, bytes + bytes / 2, 0});
  const auto machines_of_a_copy = [&](std::uint64_t client) {
    renderer.begin(client, description);
    return renderer.arrangement({client, description.id}).members();
  };
  EXPECT_EQ(machines_of_a_copy(1), 1);
  EXPECT_EQ(machines_of_a_copy(1), 1) << "it replaces its former self";
  EXPECT_EQ(machines_of_a_copy(2), 2) << "two copies do not fit";
}

TEST_F(NodeGroupSort, ShowsTheImagesOfOneProcess) {
  const std::vector<int> sizes = takes_all_cases() ? std::vector{1, 2, 4, 6, 7} : std::vector{1, 4, 7};
  for (const Sort sort : {Sort::first, Sort::hybrid, Sort::automatic})
    for (const int ranks : sizes) {
      const Group& group = start_sorted(ranks, sort);
      const auto linked = connect(), embedded = embedded_service();
      double worst = 0;
      for (const TexelType type : {TexelType::u8, TexelType::f32, TexelType::rgba8}) {
        Texture texture = some_texture(1 + std::uint64_t(type), type);
        texture.description.ghost_layer = 3;  // for light
        upload(*linked, texture);
        upload(*embedded, texture);
        for (const Operator op : {Operator::over, Operator::max, Operator::min, Operator::add}) {
          const volume::RenderRequest request = some_request(texture, op);
          worst = std::max(worst, largest_difference(image_of(*linked, request), image_of(*embedded, request)));
        }
        if (type == TexelType::rgba8) continue;
        volume::RenderRequest request = request_on_steps(texture);
        for (const volume::Method method : {volume::Method::post_classified, volume::Method::pre_integrated}) {
          request.method = method;
          worst = std::max(worst, largest_difference(image_of(*linked, request), image_of(*embedded, request)));
        }
        request.surfaces = {{0.4F, {1, 0.5F, 0.2F, 0.8F}}};
        request.light.emplace();
        worst = std::max(worst, largest_difference(image_of(*linked, request), image_of(*embedded, request)));
      }
      std::printf("sort %d, %d ranks: at most %.2g apart\n", int(sort), ranks, worst);
      EXPECT_LE(worst, 1e-5);
      dismiss(group);
    }
}

TEST_F(NodeGroupSort, ShowsTheImagesOfOneProcessWhereverTheVolumeIsCut) {
  using volume::PartitionMethod;
  for (const PartitionMethod method : {PartitionMethod::factors, PartitionMethod::cost})
    for (const int ranks : {3, 6}) {
      const Group& group =
          start(ranks, limits::stall_patience, {}, drawn_first, {.sort = Sort::last, .partition = method});
      const auto linked = connect(), embedded = embedded_service();
      double worst = 0;
      for (const TexelType type : {TexelType::u8, TexelType::rgba8}) {
        Texture texture = some_texture(1 + std::uint64_t(type), type);
        upload(*linked, texture);
        upload(*embedded, texture);
        for (const Operator op : {Operator::over, Operator::max, Operator::over, Operator::min}) {
          const volume::RenderRequest request = some_request(texture, op);
          worst = std::max(worst, largest_difference(image_of(*linked, request), image_of(*embedded, request)));
        }
      }
      EXPECT_LE(worst, 1e-5) << int(method) << ", " << ranks << " ranks";
      dismiss(group);
    }
}

TEST_F(NodeGroupSort, SortFirstTakesTheSamplesOfOneRankAndMovesNoPixelBetweenThem) {
  const Texture texture = some_texture();
  const auto embedded = embedded_service();
  upload(*embedded, texture);
  const volume::RenderRequest request = some_request(texture);
  const volume::FrameCounts one = embedded->render(request).counts;
  for (const int ranks : {2, 5, 8}) {
    const Group& group = start_sorted(ranks, Sort::first);
    const auto linked = connect();
    upload(*linked, texture);
    const volume::FrameCounts all = linked->render(request).counts;
    EXPECT_EQ(all.samples, one.samples) << ranks;
    EXPECT_EQ(all.samples_taken, one.samples_taken) << ranks;
    EXPECT_EQ(all.rays, one.rays) << ranks;
    EXPECT_EQ(all.blocks, one.blocks) << ranks;
    EXPECT_EQ(all.blocks_empty, one.blocks_empty) << ranks;
    // Each sends rank 0 a message that its part is in the image buffer.
    EXPECT_LE(all.messages, std::uint64_t(ranks - 1));
    EXPECT_LE(all.bytes_exchanged, std::uint64_t(ranks) * 64);
    dismiss(group);
  }
}

TEST_F(NodeGroupSort, ShowsTheSameHoweverPixelsTravel) {
  const Texture texture = some_texture();
  const auto embedded = embedded_service();
  upload(*embedded, texture);
  const volume::RenderRequest request = some_request(texture);
  const volume::Image expected = image_of(*embedded, request);
  for (const Gather gather : {Gather::direct, Gather::root})
    for (const Overlap overlap : {Overlap::off, Overlap::on})
      for (const Sort sort : {Sort::first, Sort::hybrid}) {
        const Group& group = start_sorted(4, sort, {.gather = gather, .overlap = overlap});
        const auto linked = connect();
        upload(*linked, texture);
        for (int image = 0; image < 3; ++image)
          EXPECT_LE(largest_difference(image_of(*linked, request), expected), 1e-5);
        dismiss(group);
      }
}

TEST_F(NodeGroupSort, IntegralsAndChangedTexelsAreThoseOfOneProcess) {
  for (const Sort sort : {Sort::first, Sort::hybrid}) {
    const Group& group = start_sorted(4, sort);
    const auto linked = connect(), embedded = embedded_service();
    Texture texture = some_texture();
    upload(*linked, texture);
    upload(*embedded, texture);
    volume::RenderRequest request = request_on_steps(texture);
    std::vector<volume::Pixel> pixels;
    for (int y = 0; y < 120; y += 13)
      for (int x = 0; x < 160; x += 13) pixels.push_back({x, y});
    const auto expected = embedded->integrals(request, pixels, 2000);
    const auto integrals = linked->integrals(request, pixels, 2000);
    ASSERT_EQ(integrals.size(), expected.size());
    for (std::size_t i = 0; i < pixels.size(); ++i)
      for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(integrals[i][k], expected[i][k], 1e-6);

    const volume::TexelBox box{{10, 8, 5}, {30, 31, 22}};
    const std::vector<std::byte> texels(volume::texels_in(box), std::byte(200));
    for (RenderService* const service : {linked.get(), embedded.get()}) {
      service->begin_change(texture.description.id, 2);
      service->add_texels(texture.description.id, {&box, 1}, texels);
      service->end_volume(texture.description.id);
    }
    request.version = 2;
    EXPECT_LE(largest_difference(image_of(*linked, request), image_of(*embedded, request)), 1e-5);
    dismiss(group);
  }
}

TEST_F(NodeGroupSort, RaysThatEndAtAnOpacityAreCastWhole) {
  for (const Sort sort : {Sort::first, Sort::last}) {
    const Group& group = start_sorted(4, sort);
    const auto linked = connect(), embedded = embedded_service();
    const Texture texture = some_texture();
    upload(*linked, texture);
    upload(*embedded, texture);
    volume::RenderRequest request = request_on_steps(texture);
    request.classification = volume::testing::smooth_table(256, 0.6F);
    const volume::Image whole = image_of(*embedded, request);
    request.opacity_limit = 0.7F;
    const volume::Image ended = image_of(*embedded, request);
    EXPECT_GT(largest_difference(whole, ended), 0.05);
    if (sort == Sort::first)
      EXPECT_LE(largest_difference(image_of(*linked, request), ended), 1e-5);
    else
      EXPECT_THROW(linked->render(request), RequestRefused);
    dismiss(group);
  }
}

TEST_F(NodeGroupSort, RaysThatEndNearlyOpaqueMayBeCastInParts) {
  start_sorted(4, Sort::last);
  const auto linked = connect(), embedded = embedded_service();
  const Texture texture = some_texture();
  upload(*linked, texture);
  upload(*embedded, texture);
  volume::RenderRequest request = request_on_steps(texture);
  request.classification = volume::testing::smooth_table(256, 0.6F);
  request.opacity_limit = volume::divisible_opacity_limit;
  EXPECT_LE(largest_difference(image_of(*linked, request), image_of(*embedded, request)),
            1 - volume::divisible_opacity_limit + 1e-5);
}

TEST_F(NodeGroupSort, RefusesWhatIsRefusedAndGoesOn) {
  start_sorted(4, Sort::first);
  const auto linked = connect(), embedded = embedded_service();
  const Texture texture = some_texture();
  upload(*linked, texture);
  upload(*embedded, texture);
  volume::RenderRequest request = some_request(texture);
  request.texture_to_clip = {};  // singular
  EXPECT_THROW(linked->render(request), RequestRefused);
  request.volume = 99;
  EXPECT_THROW(linked->render(request), RequestRefused);
  request = some_request(texture);
  EXPECT_LE(largest_difference(image_of(*linked, request), image_of(*embedded, request)), 1e-5);
}

}  // namespace
}  // namespace understudy::compositor
