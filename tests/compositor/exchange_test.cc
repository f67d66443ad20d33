#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <random>
#include <vector>

#include "compositor/exchange/direct_send.h"
#include "compositor/exchange/serial.h"
#include "compositor/exchange/thread_link.h"
#include "tests/compositor/forwarding_link.h"
#include "volume/raycast/ray_caster.h"

namespace understudy::compositor {
namespace {

using volume::Image;
using volume::Operator;
using volume::Rect;

struct Scene {
  Operator op = Operator::over;
  std::vector<Image> images;  ///< by rank
  std::vector<Rank> order;
  std::vector<Rect> footprints;
};

// Ranks with footprints of all kinds: none, one pixel, thin, large, far apart or on top of each other.
Scene random_scene(Operator op, int ranks, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(0, 1);
  Scene scene;
  scene.op = op;
  for (int rank = 0; rank < ranks; ++rank) {
    Rect rect{int(random() % 60) - 20, int(random() % 40) - 10, 1 + int(random() % 30), 1 + int(random() % 30)};
    if (random() % 8 == 0) rect.width = 1;
    if (random() % 8 == 0) rect.height = 1;
    if (random() % 4 == 0) rect = {};
    Image& image = scene.images.emplace_back(rect);
    for (std::size_t p = 0; p < image.rgba.size(); p += 4) {
      const float alpha = random() % 8 == 0 ? float(random() % 2) : uniform(random);
      for (std::size_t c = 0; c < 3; ++c) image.rgba[p + c] = alpha * uniform(random);
      image.rgba[p + 3] = alpha;
    }
    scene.footprints.push_back(rect);
    scene.order.push_back(rank);
  }
  std::ranges::shuffle(scene.order, random);
  return scene;
}

// Front to back in double precision, one pixel after the other.
double largest_error(const Scene& scene, const Image& picture) {
  double worst = 0;
  for (int y = picture.rect.y; y < picture.rect.y + picture.rect.height; ++y)
    for (int x = picture.rect.x; x < picture.rect.x + picture.rect.width; ++x) {
      std::array<double, 4> sum;
      sum.fill(volume::neutral_value(scene.op));
      for (const Rank rank : scene.order) {
        const Image& image = scene.images[std::size_t(rank)];
        if (intersection(image.rect, {x, y, 1, 1}).empty()) continue;
        const float* pixel = image.at(x, y);
        const double clear = 1 - sum[3];
        for (std::size_t c = 0; c < 4; ++c) {
          if (scene.op == Operator::over) sum[c] += clear * pixel[c];
          if (scene.op == Operator::add) sum[c] += pixel[c];
          if (scene.op == Operator::max) sum[c] = std::max(sum[c], double(pixel[c]));
          if (scene.op == Operator::min) sum[c] = std::min(sum[c], double(pixel[c]));
        }
      }
      for (std::size_t c = 0; c < 4; ++c) worst = std::max(worst, std::abs(picture.at(x, y)[c] - sum[c]));
    }
  return worst;
}

// Counts the pixels that really travel.
class CountingLink : public testing::ForwardingLink {
 public:
  CountingLink(Link& link, std::atomic<std::uint64_t>& bytes, std::atomic<int>& messages)
      : ForwardingLink(link), bytes_(bytes), messages_(messages) {}
  void transfer(std::span<const Outgoing> outgoing, std::span<const Incoming> incoming) override {
    for (const Outgoing& message : outgoing) {
      EXPECT_FALSE(message.bytes.empty());
      EXPECT_NE(message.to, rank());
      bytes_ += message.bytes.size();
      ++messages_;
    }
    ForwardingLink::transfer(outgoing, incoming);
  }

 private:
  std::atomic<std::uint64_t>& bytes_;
  std::atomic<int>& messages_;
};

struct Result {
  Image picture;
  std::uint64_t bytes_told = 0;
  std::uint64_t bytes_counted = 0;
  int messages = 0;
};

template <class Exchange>
Result exchanged(const Scene& scene, Exchange exchange) {
  Result result;
  std::atomic<std::uint64_t> bytes = 0;
  std::atomic<int> messages = 0;
  run_ranks(int(scene.images.size()), [&](Link& link) {
    CountingLink counting(link, bytes, messages);
    Exchanged done =
        exchange(scene.images[std::size_t(link.rank())], {scene.op, scene.order, scene.footprints}, counting);
    if (link.rank() != 0) {
      EXPECT_TRUE(done.picture.rgba.empty());
      return;
    }
    result.picture = std::move(done.picture);
    result.bytes_told = done.bytes;
  });
  result.bytes_counted = bytes;
  result.messages = messages;
  return result;
}

constexpr std::array all_operators{Operator::over, Operator::max, Operator::min, Operator::add};

TEST(DirectSend, EqualsSerialForAnyRankCountOperatorAndFootprint) {
  double worst = 0;
  for (int ranks = 1; ranks <= 9; ++ranks)
    for (const Operator op : all_operators)
      for (unsigned trial = 0; trial < 12; ++trial) {
        const unsigned seed = 1000 * unsigned(ranks) + 100 * unsigned(op) + trial;
        SCOPED_TRACE(::testing::Message() << "seed " << seed);
        const Scene scene = random_scene(op, ranks, seed);
        const Result direct = exchanged(scene, direct_send), one_by_one = exchanged(scene, serial);
        ASSERT_EQ(direct.picture.rect, one_by_one.picture.rect);
        ASSERT_EQ(direct.picture.rgba, one_by_one.picture.rgba);
        worst = std::max(worst, largest_error(scene, direct.picture));
        ASSERT_EQ(direct.bytes_told, direct.bytes_counted);
        ASSERT_EQ(one_by_one.bytes_told, one_by_one.bytes_counted);
      }
  std::printf("seeds 1000 to 9311; largest distance from the product in double %.2g\n", worst);
  EXPECT_LE(worst, 2e-6);
}

TEST(DirectSend, ServesSixteenAndMoreRanks) {
  for (const int ranks : {16, 23}) {
    const Scene scene = random_scene(Operator::over, ranks, unsigned(ranks));
    EXPECT_EQ(exchanged(scene, direct_send).picture.rgba, exchanged(scene, serial).picture.rgba);
  }
}

TEST(DirectSend, PictureCoversExactlyAllFootprints) {
  const Scene scene = random_scene(Operator::over, 5, 77);
  Rect whole;
  for (const Rect& footprint : scene.footprints) whole = bounding(whole, footprint);
  EXPECT_EQ(exchanged(scene, direct_send).picture.rect, whole);
}

TEST(DirectSend, OneContributingRankMeansNoCompositing) {
  for (const std::size_t only : {std::size_t(0), std::size_t(2)}) {
    Scene scene = random_scene(Operator::over, 4, 5);
    for (std::size_t rank = 0; rank < 4; ++rank)
      scene.images[rank] = Image(rank == only ? Rect{1, 2, 3, 4} : Rect{});
    for (std::size_t rank = 0; rank < 4; ++rank) scene.footprints[rank] = scene.images[rank].rect;
    std::iota(scene.images[only].rgba.begin(), scene.images[only].rgba.end(), 0.0F);
    const Result result = exchanged(scene, direct_send);
    EXPECT_EQ(result.picture.rgba, scene.images[only].rgba);
    EXPECT_EQ(result.messages, only == 0 ? 0 : 1);  // to rank 0, as it is
  }
}

TEST(DirectSend, NothingToShowMeansNoMessage) {
  Scene scene = random_scene(Operator::max, 6, 5);
  for (std::size_t rank = 0; rank < 6; ++rank) scene.images[rank] = Image();
  std::ranges::fill(scene.footprints, Rect{});
  const Result result = exchanged(scene, direct_send);
  EXPECT_TRUE(result.picture.rgba.empty());
  EXPECT_EQ(result.messages, 0);
}

TEST(DirectSend, BytesFollowTheFootprintsAndNotThePicture) {
  // Eight footprints of an eighth of the picture each, side by side.
  Scene scene;
  for (int rank = 0; rank < 8; ++rank) {
    scene.images.emplace_back(Rect{0, 16 * rank, 128, 16});
    scene.footprints.push_back(scene.images.back().rect);
    scene.order.push_back(rank);
  }
  const Result result = exchanged(scene, direct_send);
  const std::uint64_t picture = 128 * 128 * 16;
  std::printf("%llu bytes of a picture of %llu\n", static_cast<unsigned long long>(result.bytes_counted),
              static_cast<unsigned long long>(picture));
  EXPECT_LE(result.bytes_counted, picture);
}

TEST(DirectSend, HoldsForManyThinLayersInOnePlace) {
  // One pixel or two of every rank, all in the same place.
  Scene scene;
  std::mt19937 random(9);
  std::uniform_real_distribution<float> thin(0, 0.01F);
  constexpr int layers = 128;
  for (int rank = 0; rank < layers; ++rank) {
    Image& image = scene.images.emplace_back(Rect{0, 0, 2, 1});
    for (float& value : image.rgba) value = thin(random);
    scene.footprints.push_back(image.rect);
    scene.order.push_back(rank);
  }
  const double error = largest_error(scene, exchanged(scene, direct_send).picture);
  std::printf("largest error over %d layers %.2g\n", layers, error);
  EXPECT_LE(error, 2e-6);
}

TEST(ThreadLink, ARankThatFailsLeavesNobodyWaiting) {
  EXPECT_THROW(run_ranks(3,
                         [](Link& link) {
                           if (link.rank() == 1) throw std::runtime_error("rank 1 gives up");
                           std::byte byte{};
                           link.broadcast(1, {&byte, 1});
                         }),
               std::runtime_error);
}

}  // namespace
}  // namespace understudy::compositor
