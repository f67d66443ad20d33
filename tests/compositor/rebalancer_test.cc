// SPDX-License-Identifier: Apache-2.0
// Node groups that move blocks while images are drawn: the images stay the same.
#include "compositor/node/rebalancer.h"

#include <gmock/gmock.h>

#include <atomic>
#include <cstdio>
#include <mutex>
#include <random>

#include "compositor/balance/tree.h"
#include "compositor/exchange/exchange.h"
#include "compositor/exchange/schedule.h"
#include "compositor/exchange/thread_communicator.h"
#include "compositor/node/node.h"
#include "compositor/service/remote_service.h"
#include "tests/all_cases.h"
#include "tests/compositor/group_scene.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/occlusion.h"
#include "volume/partition.h"
#include "volume/request.h"

namespace understudy::compositor {
namespace {

using namespace testing;
using volume::TexelType;

Texture scene(TexelType type = TexelType::u8, volume::Wrap wrap = volume::Wrap::edge) {
  volume::VolumeDescription description = volume::testing::describe({73, 61, 49}, type, wrap);
  description.id = 7;
  return volume::testing::sampled(description, volume::testing::marschner_lobb_field());
}

/// A different image for each number: the camera turns.
volume::RenderRequest request_of(const Texture& texture, int drawn) {
  using namespace volume::testing;
  using volume::multiply;
  const double angle = 0.05 * drawn;
  const volume::Matrix4 camera = multiply(
      perspective(45, 4.0 / 3, 0.1, 20),
      multiply(look_at({2 * std::sin(angle), 0.6, 2 * std::cos(angle)}, {0, 0, 0}, {0, 1, 0}), unit_cube()));
  volume::RenderRequest request = request_for(texture, camera, 96, 72, 60);
  request.version = texture.description.version;
  return request;
}

std::vector<std::byte> texels_of(const Texture& texture, const volume::TexelBox& box) {
  const std::size_t texel = volume::bytes_per_texel(texture.description.type);
  std::vector<std::byte> part(volume::texels_in(box) * texel);
  volume::copy_texels(box, texel, texture.description.stored, texture.texels, box, part);
  return part;
}

/// One rank, without sockets. Its time is not measured, but computed as its samples times its relative cost, so
/// that every run is the same.
class Rank {
 public:
  Rank(Communicator& communicator, const BalanceSettings& settings,
       volume::PartitionMethod method = volume::PartitionMethod::blocks)
      : communicator_(communicator),
        renderer_(communicator.rank(), communicator.size()),
        rebalancer_(communicator, renderer_, settings, method) {}

  void upload(const Texture& texture) {
    const volume::VolumeDescription& d = texture.description;
    rebalancer_.forget({0, d.id});
    renderer_.begin(0, d);
    give(texture, {d.stored});
    renderer_.end({0, d.id});
  }

  void change(const Texture& texture, const std::vector<volume::TexelBox>& boxes) {
    const volume::VolumeDescription& d = texture.description;
    renderer_.begin_change({0, d.id}, d.version);
    rebalancer_.texels_changed({0, d.id}, d, boxes);
    give(texture, boxes);
    renderer_.end({0, d.id});
  }

  volume::Image image(const volume::RenderRequest& asked, double relative_cost) {
    const volume::RenderRequest request = rebalancer_.before_image(0, [&] { return asked; });
    volume::FrameCounts counts;
    volume::Image image = renderer_.render(0, request, counts);
    struct Told {
      volume::Rect footprint;
      RankWork work;
    } mine{image.rect, {double(counts.samples_taken) * relative_cost, counts.samples_taken}};
    std::vector<Told> all(std::size_t(communicator_.size()));
    communicator_.gather_to_all(bytes_of(mine), std::as_writable_bytes(std::span(all)));
    std::vector<volume::Rect> footprints;
    std::vector<RankWork> work;
    for (const Told& told : all) {
      footprints.push_back(told.footprint);
      work.push_back(told.work);
    }
    rebalancer_.after_image({0, request.volume}, work);
    partition = renderer_.partition(0, request);
    const Schedule chosen =
        schedule(Algorithm::direct_send, renderer_.visibility_order(0, request), footprints);
    Exchanged whole = exchange(std::move(image), chosen, request.op, Layout::rgba32f, communicator_);
    volume::Image drawn(request.window);
    for (int y = whole.image.rect.y; y < whole.image.rect.y + whole.image.rect.height; ++y)
      for (int x = whole.image.rect.x; x < whole.image.rect.x + whole.image.rect.width; ++x)
        std::copy_n(whole.image.at(x, y), 4, drawn.at(x, y));
    return drawn;
  }

  volume::Partition partition;  ///< that drew the last image

 private:
  void give(const Texture& texture, const std::vector<volume::TexelBox>& boxes) {
    const VolumeKey key{0, texture.description.id};
    const auto shares = renderer_.shares(key, boxes, communicator_.rank());
    std::vector<std::byte> bytes;
    for (const volume::TexelBox& share : shares) {
      const auto part = texels_of(texture, share);
      bytes.insert(bytes.end(), part.begin(), part.end());
    }
    renderer_.add_texels(key, shares, bytes);
  }

  Communicator& communicator_;
  RankRenderer renderer_;
  Rebalancer rebalancer_;
};

struct Figures {
  std::atomic<int> moves = 0;
  std::atomic<std::size_t> blocks = 0;
  std::atomic<std::size_t> from_cache = 0;

  BalanceSettings settings(Balance balance) {
    BalanceSettings settings{balance, {}, std::size_t(64) << 20};
    settings.moved = [this](const MoveFigures& move) {
      ++moves;
      blocks += move.blocks_received;
      from_cache += move.blocks_from_cache;
    };
    return settings;
  }
};

double image_by_one(const Texture& texture, const volume::RenderRequest& request, const volume::Image& drawn) {
  const auto service = embedded_service();
  upload(*service, texture);
  return largest_difference(image_of(*service, request), drawn);
}

TEST(Rebalancer, ImagesStayTheSameWhileBlocksTravelAndTexelsChange) {
  const unsigned seed = 2701;
  std::printf("seed %u\n", seed);
  const int most_ranks = takes_all_cases() ? 8 : 5;
  for (const Balance balance : {Balance::muller, Balance::predicted})
    for (int ranks = 2; ranks <= most_ranks; ++ranks) {
      Figures figures;
      double worst = 0;
      const TexelType type = ranks % 3 == 0 ? TexelType::f32 : TexelType::u8;
      const volume::Wrap wrap = ranks % 4 == 0 ? volume::Wrap::repeat : volume::Wrap::edge;
      run_ranks(ranks, [&](Communicator& communicator) {
        std::mt19937 random(seed);  // all ranks make the same scene
        Texture texture = scene(type, wrap);
        Rank rank(communicator, figures.settings(balance));
        rank.upload(texture);
        for (int drawn = 0; drawn < 40; ++drawn) {
          // The slow rank changes, so that blocks move there and back.
          const double relative_cost = communicator.rank() == (drawn < 20 ? 0 : ranks - 1) ? 4 : 1;
          if (drawn % 6 == 5) {
            ++texture.description.version;
            volume::TexelBox box = texture.description.stored;
            for (std::size_t k = 0; k < 3; ++k) {
              box.low[k] = int(random() % unsigned(box.high[k] - 1));
              box.high[k] = std::min(box.high[k], box.low[k] + 1 + int(random() % 30));
            }
            const Texture other = volume::testing::noise(texture.description, random());
            const auto part = texels_of(other, box);
            volume::copy_texels(box, volume::bytes_per_texel(type), box, part, texture.description.stored,
                                texture.texels);
            rank.change(texture, {box});
          }
          const volume::RenderRequest request = request_of(texture, drawn);
          const volume::Image image = rank.image(request, relative_cost);
          if (communicator.rank() == 0) worst = std::max(worst, image_by_one(texture, request, image));
        }
      });
      std::printf("%s, %d ranks: %d moves, %zu blocks travelled, %zu came from caches, at most %.2g apart\n",
                  balance == Balance::muller ? "muller" : "predicted", ranks, figures.moves.load(),
                  figures.blocks.load(), figures.from_cache.load(), worst);
      EXPECT_LE(worst, 1e-5);
      EXPECT_GT(figures.moves, 0);
      EXPECT_GT(figures.blocks, 0U);
    }
}

/// Shows only the part of the field at `place`, with a transfer function for each place.
volume::RenderRequest showing(const Texture& texture, int drawn, double place) {
  volume::RenderRequest request = request_of(texture, drawn);
  volume::TransferFunction table;
  for (int i = 0; i < 256; ++i) {
    const bool seen = std::abs(i / 255.0 - place) < 0.1;
    table.entries.push_back(seen ? volume::Rgba{0.1F, 0.05F, 0.02F, 0.1F} : volume::Rgba{});
  }
  request.classification = table;
  return request;
}

TEST(Rebalancer, CutsAVolumeAnewForWhatIsVisibleOfIt) {
  constexpr int ranks = 5;
  Figures figures;
  double worst = 0;
  std::vector<int> moves_after;
  run_ranks(ranks, [&](Communicator& communicator) {
    volume::VolumeDescription description = volume::testing::describe({73, 61, 49}, TexelType::u8);
    description.id = 7;
    Texture texture{description, {}};
    for (int z = 0; z < 49; ++z)
      for (int y = 0; y < 61; ++y)
        for (int x = 0; x < 73; ++x) texture.texels.push_back(std::byte((x + y + z) * 255 / (73 + 61 + 49)));
    Rank rank(communicator, figures.settings(Balance::off), volume::PartitionMethod::cost);
    rank.upload(texture);
    for (int drawn = 0; drawn < 24; ++drawn) {
      // Each transfer function is used for six images.
      const volume::RenderRequest request = showing(texture, drawn, drawn / 6 % 2 == 0 ? 0.2 : 0.8);
      const volume::Image image = rank.image(request, 1);
      if (communicator.rank() != 0) continue;
      worst = std::max(worst, image_by_one(texture, request, image));
      moves_after.push_back(figures.moves);
    }
  });
  EXPECT_LE(worst, 1e-5);
  EXPECT_GT(moves_after[0], 0) << "cut before the first image";
  EXPECT_GT(moves_after[6], moves_after[5]) << "cut for another table";
  EXPECT_EQ(moves_after[5], moves_after[1]) << "not cut where nothing is new";
  std::printf("%d moves, %zu blocks travelled, at most %.2g apart\n", figures.moves.load(),
              figures.blocks.load(), worst);
}

TEST(Rebalancer, AllRanksCutAlikeAndBlocksComeBackFromCaches) {
  Figures figures;
  constexpr int ranks = 4, images = 60;
  std::vector<std::vector<volume::Partition>> cuts(ranks);
  run_ranks(ranks, [&](Communicator& communicator) {
    const Texture texture = scene();
    Rank rank(communicator, figures.settings(Balance::predicted));
    rank.upload(texture);
    for (int drawn = 0; drawn < images; ++drawn) {
      rank.image(request_of(texture, 0), communicator.rank() == drawn / 15 % 2 ? 4 : 1);
      cuts[std::size_t(communicator.rank())].push_back(rank.partition);
    }
  });
  for (const auto& of_rank : cuts) EXPECT_EQ(of_rank, cuts[0]);
  std::printf("%d moves, %zu blocks travelled, %zu came from caches\n", figures.moves.load(),
              figures.blocks.load(), figures.from_cache.load());
  EXPECT_GT(figures.from_cache, 0U);
}

TEST(Rebalancer, SaysByHowMuchTimesDeviatedInTheImageBefore) {
  constexpr int images = 10;
  const auto moves_with = [](Balance balance, volume::PartitionMethod method) {
    std::vector<MoveFigures> moves;  // on rank 0
    run_ranks(2, [&](Communicator& communicator) {
      const Texture texture = scene();
      BalanceSettings settings;
      settings.balance = balance;
      settings.moved = [&](const MoveFigures& move) {
        if (communicator.rank() == 0) moves.push_back(move);
      };
      Rank rank(communicator, settings, method);
      rank.upload(texture);
      for (int drawn = 0; drawn < images; ++drawn)
        rank.image(request_of(texture, 0), communicator.rank() == 0 ? 4 : 1);
    });
    return moves;
  };
  for (const Balance balance : {Balance::muller, Balance::predicted}) {
    const auto moves = moves_with(balance, volume::PartitionMethod::blocks);
    ASSERT_FALSE(moves.empty());
    // One rank takes four times as long as the other for about as many samples: 3 / 2.5.
    EXPECT_NEAR(moves.front().deviation.value_or(0), 1.2, 0.3);
    for (const MoveFigures& move : moves) EXPECT_GT(move.deviation.value_or(0), 0);
  }
  const auto cuts = moves_with(Balance::off, volume::PartitionMethod::cost);
  ASSERT_FALSE(cuts.empty());
  EXPECT_FALSE(cuts.front().deviation) << "cut before the first image, when nothing was measured";
}

TEST(Rebalancer, ARefusedRequestMovesNothingAndLeavesTheGroupAlive) {
  Figures figures;
  run_ranks(3, [&](Communicator& communicator) {
    const Texture texture = scene();
    Rank rank(communicator, figures.settings(Balance::predicted));
    rank.upload(texture);
    volume::RenderRequest wrong = request_of(texture, 0);
    wrong.version = 99;
    EXPECT_THROW(rank.image(wrong, 1), RequestRefused);
    wrong = request_of(texture, 0);
    wrong.texture_to_clip = {};
    EXPECT_THROW(rank.image(wrong, 1), RequestRefused);
    EXPECT_EQ(figures.moves, 0);
    const volume::RenderRequest request = request_of(texture, 0);
    const volume::Image image = rank.image(request, 1);
    if (communicator.rank() == 0) {
      EXPECT_LE(image_by_one(texture, request, image), 1e-5);
    }
  });
}

TEST(Rebalancer, GivesNoRankMoreBlocksThanItHasMemoryFor) {
  const auto most_held = [](std::size_t memory_left) {
    Figures figures;
    std::size_t most = 0;
    run_ranks(2, [&](Communicator& communicator) {
      const Texture texture = scene();
      BalanceSettings settings = figures.settings(Balance::predicted);
      settings.memory_left = [=] { return memory_left; };
      Rank rank(communicator, settings);
      rank.upload(texture);
      for (int drawn = 0; drawn < 20; ++drawn) {
        rank.image(request_of(texture, 0), communicator.rank() == 0 ? 30 : 1);
        if (communicator.rank() != 0) continue;
        for (const volume::TexelBox& box : volume::boxes(rank.partition, texture.description))
          most = std::max(most, blocks_in(box));
      }
    });
    return most;
  };
  const std::size_t bound = most_held(0), free = most_held(std::size_t(1) << 30);
  std::printf("the busiest rank holds %zu blocks, and %zu where memory is left\n", bound, free);
  EXPECT_LT(bound, free);
  // Without memory left, a rank can hold what it holds, its ghost layer included.
  const Texture texture = scene();
  std::size_t even = 0;
  for (const volume::TexelBox& box :
       volume::boxes(volume::by_blocks(texture.description, 2), texture.description))
    even = std::max(even, blocks_in(box));
  EXPECT_LE(bound, even + even / 8);
}

/// Draws every image `times` times.
class Laborious : public volume::BrickRenderer {
 public:
  Laborious(const volume::BrickStore& store, int times)
      : renderer_(volume::cpu_renderer(store)), times_(times) {}
  void blocks_changed(std::span<const std::size_t> blocks) override { renderer_->blocks_changed(blocks); }

 private:
  void draw(const volume::RenderRequest& request, volume::Image& out, volume::FrameCounts& counts,
            volume::Occlusion* occlusion) override {
    for (int i = 1; i < times_; ++i) {
      volume::FrameCounts ignored;
      renderer_->render(request, out, ignored);
    }
    renderer_->render(request, out, counts, occlusion);
  }

  std::unique_ptr<volume::BrickRenderer> renderer_;
  int times_;
};

TEST(Rebalancer, WholeNodesWithARankSlowedToASixteenthShowTheSameImages) {
  for (const Balance balance : {Balance::muller, Balance::predicted}) {
    const ScratchFolder folder;
    const std::string path = folder / "control";
    Figures figures;
    std::jthread group;  // ends after the launcher
    Launcher launcher(path);
    group = std::jthread([&] {
      run_ranks(4, [&](Communicator& communicator) {
        const int times = communicator.rank() == 1 ? 16 : 1;
        NodeSettings settings;
        settings.make_renderer = [times](const volume::BrickStore& store) {
          return std::make_unique<Laborious>(store, times);
        };
        settings.balance = figures.settings(balance);
        run_node(communicator, socket_of_nodes(path), settings);
      });
    });
    ASSERT_TRUE(launcher.wait_for_group());
    const auto linked = remote_render_service(path, 20'000), embedded = embedded_service();
    const Texture texture = scene();
    upload(*linked, texture);
    upload(*embedded, texture);
    double worst = 0;
    // Times are measured here; sooner or later planes move.
    for (int drawn = 0; drawn < 20 || (figures.moves == 0 && drawn < 1000); ++drawn) {
      const volume::RenderRequest request = request_of(texture, drawn % 40);
      worst = std::max(worst, largest_difference(image_of(*linked, request), image_of(*embedded, request)));
    }
    std::printf("%d moves, at most %.2g apart\n", figures.moves.load(), worst);
    EXPECT_LE(worst, 1e-5);
    EXPECT_GT(figures.moves, 0);
    // Another volume with the same id begins with a partition of its own.
    Texture again = scene(TexelType::f32);
    upload(*linked, again);
    upload(*embedded, again);
    const volume::RenderRequest request = request_of(again, 3);
    EXPECT_LE(largest_difference(image_of(*linked, request), image_of(*embedded, request)), 1e-5);
  }
}

}  // namespace
}  // namespace understudy::compositor
