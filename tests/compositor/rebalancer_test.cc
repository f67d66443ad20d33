// Node groups whose blocks travel while pictures are drawn: the pictures stay the same.
#include "compositor/node/rebalancer.h"

#include <gmock/gmock.h>

#include <atomic>
#include <cstdio>
#include <mutex>
#include <random>

#include "compositor/balance/tree.h"
#include "compositor/exchange/exchange.h"
#include "compositor/exchange/schedule.h"
#include "compositor/exchange/thread_link.h"
#include "compositor/node/node.h"
#include "compositor/service/linked.h"
#include "tests/compositor/group_scene.h"
#include "volume/brick/texel_box.h"
#include "volume/partition.h"

namespace understudy::compositor {
namespace {

using namespace testing;
using volume::TexelType;

Texture scene(TexelType type = TexelType::u8, volume::Wrap wrap = volume::Wrap::edge) {
  volume::VolumeDescription description = volume::testing::describe({73, 61, 49}, type, wrap);
  description.id = 7;
  return volume::testing::sampled(description, volume::testing::marschner_lobb_field());
}

/// A picture of its own for each number: the camera turns.
volume::RenderRequest request_of(const Texture& texture, int picture) {
  using namespace volume::testing;
  using volume::multiply;
  const double angle = 0.05 * picture;
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

/// One rank, without sockets. Its time is not measured: it is its samples times its slowness, so that all that
/// happens is the same in every run.
class Rank {
 public:
  Rank(Link& link, const BalanceSettings& settings)
      : link_(link), renderer_(link.rank(), link.size()), rebalancer_(link, renderer_, settings) {}

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

  volume::Image picture(const volume::RenderRequest& asked, double slowness) {
    const volume::RenderRequest request = rebalancer_.before_picture(0, [&] { return asked; });
    volume::FrameCounts counts;
    volume::Image image = renderer_.render(0, request, counts);
    struct Told {
      volume::Rect footprint;
      RankWork work;
    } mine{image.rect, {double(counts.samples_taken) * slowness, counts.samples_taken}};
    std::vector<Told> all(std::size_t(link_.size()));
    link_.gather_to_all(bytes_of(mine), std::as_writable_bytes(std::span(all)));
    std::vector<volume::Rect> footprints;
    std::vector<RankWork> work;
    for (const Told& told : all) {
      footprints.push_back(told.footprint);
      work.push_back(told.work);
    }
    rebalancer_.after_picture({0, request.volume}, work);
    partition = renderer_.partition(0, request);
    const Schedule chosen =
        schedule(Algorithm::direct_send, renderer_.visibility_order(0, request), footprints);
    Exchanged whole = exchange(std::move(image), chosen, request.op, Layout::rgba32f, link_);
    volume::Image picture(request.window);
    for (int y = whole.picture.rect.y; y < whole.picture.rect.y + whole.picture.rect.height; ++y)
      for (int x = whole.picture.rect.x; x < whole.picture.rect.x + whole.picture.rect.width; ++x)
        std::copy_n(whole.picture.at(x, y), 4, picture.at(x, y));
    return picture;
  }

  volume::Partition partition;  ///< that drew the last picture

 private:
  void give(const Texture& texture, const std::vector<volume::TexelBox>& boxes) {
    const VolumeKey key{0, texture.description.id};
    const auto shares = renderer_.shares(key, boxes, link_.rank());
    std::vector<std::byte> bytes;
    for (const volume::TexelBox& share : shares) {
      const auto part = texels_of(texture, share);
      bytes.insert(bytes.end(), part.begin(), part.end());
    }
    renderer_.add_texels(key, shares, bytes);
  }

  Link& link_;
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

double picture_by_one(const Texture& texture, const volume::RenderRequest& request,
                      const volume::Image& picture) {
  const auto service = embedded_service();
  upload(*service, texture);
  return largest_difference(picture_of(*service, request), picture);
}

TEST(Rebalancer, PicturesStayTheSameWhileBlocksTravelAndTexelsChange) {
  const unsigned seed = 2701;
  std::printf("seed %u\n", seed);
  for (const Balance balance : {Balance::muller, Balance::predicted})
    for (int ranks = 2; ranks <= 8; ++ranks) {
      Figures figures;
      double worst = 0;
      const TexelType type = ranks % 3 == 0 ? TexelType::f32 : TexelType::u8;
      const volume::Wrap wrap = ranks % 4 == 0 ? volume::Wrap::repeat : volume::Wrap::edge;
      run_ranks(ranks, [&](Link& link) {
        std::mt19937 random(seed);  // all ranks make the same scene
        Texture texture = scene(type, wrap);
        Rank rank(link, figures.settings(balance));
        rank.upload(texture);
        for (int picture = 0; picture < 40; ++picture) {
          // The slow rank changes, so that blocks go there and back.
          const double slowness = link.rank() == (picture < 20 ? 0 : ranks - 1) ? 4 : 1;
          if (picture % 6 == 5) {
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
          const volume::RenderRequest request = request_of(texture, picture);
          const volume::Image image = rank.picture(request, slowness);
          if (link.rank() == 0) worst = std::max(worst, picture_by_one(texture, request, image));
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

TEST(Rebalancer, AllRanksCutAlikeAndBlocksComeBackFromCaches) {
  Figures figures;
  constexpr int ranks = 4, pictures = 60;
  std::vector<std::vector<volume::Partition>> cuts(ranks);
  run_ranks(ranks, [&](Link& link) {
    const Texture texture = scene();
    Rank rank(link, figures.settings(Balance::predicted));
    rank.upload(texture);
    for (int picture = 0; picture < pictures; ++picture) {
      rank.picture(request_of(texture, 0), link.rank() == picture / 15 % 2 ? 4 : 1);
      cuts[std::size_t(link.rank())].push_back(rank.partition);
    }
  });
  for (const auto& of_rank : cuts) EXPECT_EQ(of_rank, cuts[0]);
  std::printf("%d moves, %zu blocks travelled, %zu came from caches\n", figures.moves.load(),
              figures.blocks.load(), figures.from_cache.load());
  EXPECT_GT(figures.from_cache, 0U);
}

TEST(Rebalancer, ARefusedRequestMovesNothingAndLeavesTheGroupAlive) {
  Figures figures;
  run_ranks(3, [&](Link& link) {
    const Texture texture = scene();
    Rank rank(link, figures.settings(Balance::predicted));
    rank.upload(texture);
    volume::RenderRequest wrong = request_of(texture, 0);
    wrong.version = 99;
    EXPECT_THROW(rank.picture(wrong, 1), RequestRefused);
    wrong = request_of(texture, 0);
    wrong.texture_to_clip = {};
    EXPECT_THROW(rank.picture(wrong, 1), RequestRefused);
    EXPECT_EQ(figures.moves, 0);
    const volume::RenderRequest request = request_of(texture, 0);
    const volume::Image image = rank.picture(request, 1);
    if (link.rank() == 0) {
      EXPECT_LE(picture_by_one(texture, request, image), 1e-5);
    }
  });
}

TEST(Rebalancer, GivesNoRankMoreBlocksThanItHasMemoryFor) {
  const auto most_held = [](std::size_t memory_left) {
    Figures figures;
    std::size_t most = 0;
    run_ranks(2, [&](Link& link) {
      const Texture texture = scene();
      BalanceSettings settings = figures.settings(Balance::predicted);
      settings.memory_left = [=] { return memory_left; };
      Rank rank(link, settings);
      rank.upload(texture);
      for (int picture = 0; picture < 20; ++picture) {
        rank.picture(request_of(texture, 0), link.rank() == 0 ? 30 : 1);
        if (link.rank() != 0) continue;
        for (const volume::TexelBox& box : volume::boxes(rank.partition, texture.description))
          most = std::max(most, blocks_in(box));
      }
    });
    return most;
  };
  const std::size_t bound = most_held(0), free = most_held(std::size_t(1) << 30);
  std::printf("the busiest rank holds %zu blocks, and %zu where memory is left\n", bound, free);
  EXPECT_LT(bound, free);
  // Without memory left a rank holds what it held, its margin counted.
  const Texture texture = scene();
  std::size_t even = 0;
  for (const volume::TexelBox& box :
       volume::boxes(volume::by_blocks(texture.description, 2), texture.description))
    even = std::max(even, blocks_in(box));
  EXPECT_LE(bound, even + even / 8);
}

/// Draws every picture so many times.
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

TEST(Rebalancer, WholeNodesWithARankSlowedToASixteenthShowTheSamePictures) {
  for (const Balance balance : {Balance::muller, Balance::predicted}) {
    const ScratchFolder folder;
    const std::string path = folder / "control";
    Figures figures;
    std::jthread group;  // ends once the launcher has
    Launcher launcher(path);
    group = std::jthread([&] {
      run_ranks(4, [&](Link& link) {
        const int times = link.rank() == 1 ? 16 : 1;
        run_node(
            link, path, limits::stall_patience, {},
            [times](const volume::BrickStore& store) { return std::make_unique<Laborious>(store, times); },
            figures.settings(balance));
      });
    });
    ASSERT_TRUE(launcher.wait_for_group());
    const auto linked = linked_service(path, 20'000), embedded = embedded_service();
    const Texture texture = scene();
    upload(*linked, texture);
    upload(*embedded, texture);
    double worst = 0;
    // Times are real here; sooner or later they tell.
    for (int picture = 0; picture < 20 || (figures.moves == 0 && picture < 1000); ++picture) {
      const volume::RenderRequest request = request_of(texture, picture % 40);
      worst = std::max(worst, largest_difference(picture_of(*linked, request), picture_of(*embedded, request)));
    }
    std::printf("%d moves, at most %.2g apart\n", figures.moves.load(), worst);
    EXPECT_LE(worst, 1e-5);
    EXPECT_GT(figures.moves, 0);
    // Another volume under the same name begins with a division of its own.
    Texture again = scene(TexelType::f32);
    upload(*linked, again);
    upload(*embedded, again);
    const volume::RenderRequest request = request_of(again, 3);
    EXPECT_LE(largest_difference(picture_of(*linked, request), picture_of(*embedded, request)), 1e-5);
  }
}

}  // namespace
}  // namespace understudy::compositor
