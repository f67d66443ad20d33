// SPDX-License-Identifier: Apache-2.0
#include "compositor/exchange/exchange.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <numeric>
#include <random>
#include <vector>

#include "compositor/blend.h"
#include "compositor/exchange/cost.h"
#include "compositor/exchange/counted_exchange.h"
#include "compositor/exchange/thread_communicator.h"
#include "tests/all_cases.h"
#include "tests/compositor/forwarding_communicator.h"
#include "volume/blending_operator.h"
#include "volume/image.h"
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

// Ranks with footprints of all kinds: none, one pixel, thin, large, far apart or overlapping.
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

// Compares with blending front to back in double precision, pixel by pixel.
double largest_error(const Scene& scene, const Image& image) {
  double worst = 0;
  for (int y = image.rect.y; y < image.rect.y + image.rect.height; ++y)
    for (int x = image.rect.x; x < image.rect.x + image.rect.width; ++x) {
      std::array<double, 4> sum;
      sum.fill(volume::neutral_value(scene.op));
      for (const Rank rank : scene.order) {
        const Image& part = scene.images[std::size_t(rank)];
        if (intersection(part.rect, {x, y, 1, 1}).empty()) continue;
        const float* pixel = part.at(x, y);
        const double clear = 1 - sum[3];
        for (std::size_t c = 0; c < 4; ++c) {
          if (scene.op == Operator::over) sum[c] += clear * pixel[c];
          if (scene.op == Operator::add) sum[c] += pixel[c];
          if (scene.op == Operator::max) sum[c] = std::max(sum[c], double(pixel[c]));
          if (scene.op == Operator::min) sum[c] = std::min(sum[c], double(pixel[c]));
        }
      }
      for (std::size_t c = 0; c < 4; ++c) worst = std::max(worst, std::abs(image.at(x, y)[c] - sum[c]));
    }
  return worst;
}

// Counts the bytes and messages that are really sent.
class CountingCommunicator : public testing::ForwardingCommunicator {
 public:
  CountingCommunicator(Communicator& communicator, std::atomic<std::uint64_t>& bytes,
                       std::atomic<int>& messages)
      : ForwardingCommunicator(communicator), bytes_(bytes), messages_(messages) {}
  void transfer(std::span<const Outgoing> outgoing, std::span<const Incoming> incoming) override {
    for (const Outgoing& message : outgoing) {
      EXPECT_FALSE(message.bytes.empty());
      EXPECT_NE(message.to, rank());
      bytes_ += message.bytes.size();
      ++messages_;
    }
    ForwardingCommunicator::transfer(outgoing, incoming);
  }

 private:
  std::atomic<std::uint64_t>& bytes_;
  std::atomic<int>& messages_;
};

struct Result {
  Image image;
  std::uint64_t bytes_told = 0;
  std::uint64_t bytes_counted = 0;
  int messages = 0;
};

Schedule schedule_of(const Scene& scene, Algorithm algorithm, std::span<const int> factors = {}) {
  return schedule(algorithm, scene.order, scene.footprints, factors);
}

enum class Messages { read_in_place, sent };

Result exchanged(const Scene& scene, const Schedule& schedule, Layout layout = Layout::rgba32f,
                 Messages how = Messages::read_in_place) {
  Result result;
  std::atomic<std::uint64_t> bytes = 0;
  std::atomic<int> messages = 0;
  run_ranks(
      int(scene.images.size()),
      [&](Communicator& communicator) {
        CountingCommunicator counting(communicator, bytes, messages);
        Exchanged done =
            exchange(scene.images[std::size_t(communicator.rank())], schedule, scene.op, layout, counting);
        if (communicator.rank() != 0) {
          EXPECT_TRUE(done.image.rgba.empty());
          return;
        }
        result.image = std::move(done.image);
        result.bytes_told = done.bytes;
      },
      how == Messages::read_in_place);
  result.bytes_counted = bytes;
  result.messages = messages;
  return result;
}

Result exchanged(const Scene& scene, Algorithm algorithm) {
  return exchanged(scene, schedule_of(scene, algorithm));
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
        const Result direct = exchanged(scene, Algorithm::direct_send),
                     one_by_one = exchanged(scene, Algorithm::serial);
        ASSERT_EQ(direct.image.rect, one_by_one.image.rect);
        ASSERT_EQ(direct.image.rgba, one_by_one.image.rgba);
        worst = std::max(worst, largest_error(scene, direct.image));
        ASSERT_EQ(direct.bytes_told, direct.bytes_counted);
        ASSERT_EQ(one_by_one.bytes_told, one_by_one.bytes_counted);
      }
  std::printf("seeds 1000 to 9311; largest distance from the product in double %.2g\n", worst);
  EXPECT_LE(worst, 1e-6);
}

TEST(DirectSend, ServesSixteenAndMoreRanks) {
  for (const int ranks : {16, 23}) {
    const Scene scene = random_scene(Operator::over, ranks, unsigned(ranks));
    EXPECT_EQ(exchanged(scene, Algorithm::direct_send).image.rgba,
              exchanged(scene, Algorithm::serial).image.rgba);
  }
}

TEST(DirectSend, ImageCoversExactlyAllFootprints) {
  const Scene scene = random_scene(Operator::over, 5, 77);
  Rect whole;
  for (const Rect& footprint : scene.footprints) whole = bounding(whole, footprint);
  EXPECT_EQ(exchanged(scene, Algorithm::direct_send).image.rect, whole);
}

TEST(DirectSend, OneContributingRankMeansNoCompositing) {
  for (const std::size_t only : {std::size_t(0), std::size_t(2)}) {
    Scene scene = random_scene(Operator::over, 4, 5);
    for (std::size_t rank = 0; rank < 4; ++rank)
      scene.images[rank] = Image(rank == only ? Rect{1, 2, 3, 4} : Rect{});
    for (std::size_t rank = 0; rank < 4; ++rank) scene.footprints[rank] = scene.images[rank].rect;
    std::iota(scene.images[only].rgba.begin(), scene.images[only].rgba.end(), 0.0F);
    const Result result = exchanged(scene, Algorithm::direct_send);
    EXPECT_EQ(result.image.rgba, scene.images[only].rgba);
    EXPECT_EQ(result.messages, only == 0 ? 0 : 1);  // to rank 0, unchanged
  }
}

TEST(DirectSend, NothingToShowMeansNoMessage) {
  Scene scene = random_scene(Operator::max, 6, 5);
  for (std::size_t rank = 0; rank < 6; ++rank) scene.images[rank] = Image();
  std::ranges::fill(scene.footprints, Rect{});
  const Result result = exchanged(scene, Algorithm::direct_send);
  EXPECT_TRUE(result.image.rgba.empty());
  EXPECT_EQ(result.messages, 0);
}

TEST(DirectSend, BytesFollowTheFootprintsAndNotTheImage) {
  // Eight footprints of an eighth of the image each, side by side.
  Scene scene;
  for (int rank = 0; rank < 8; ++rank) {
    std::ranges::fill(scene.images.emplace_back(Rect{0, 16 * rank, 128, 16}).rgba, 0.5F);
    scene.footprints.push_back(scene.images.back().rect);
    scene.order.push_back(rank);
  }
  const Result result = exchanged(scene, Algorithm::direct_send);
  const std::uint64_t image = 128 * 128 * 16;
  std::printf("%llu bytes of an image of %llu\n", static_cast<unsigned long long>(result.bytes_counted),
              static_cast<unsigned long long>(image));
  EXPECT_LE(result.bytes_counted, image);
}

TEST(DirectSend, HoldsForManyThinLayersInOnePlace) {
  // One or two pixels of every rank, all in the same place.
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
  const double error = largest_error(scene, exchanged(scene, Algorithm::direct_send).image);
  std::printf("largest error over %d layers %.2g\n", layers, error);
  EXPECT_LE(error, 2e-6);
}

/// Returns the largest error of an image composed of `images` images, whose values were rounded each of
/// `travels` times they were sent: see transport/pixel_width.h. The error of a sum grows with the sum.
double bound_of(Layout layout, Operator op, int images, int travels) {
  const double largest = op == Operator::add ? images : 1;
  // Under a maximum or minimum, a single image's value is shown; otherwise all errors add up.
  const int roundings = op == Operator::over || op == Operator::add ? images + travels : travels;
  const double in_floats = 1e-6 * largest;
  switch (layout) {
    case Layout::rgba32f:
      return in_floats;
    case Layout::rgba16f:
      return in_floats + roundings * std::ldexp(largest, -11);
    case Layout::rgba8:
      return in_floats + roundings / 510.0;
  }
  return 0;
}

TEST(Exchange, EveryAlgorithmLayoutAndOperatorGivesTheProductInDouble) {
  std::printf("largest errors; seeds 1000 to 16302\n%-16s", "");
  for (const char* const op : {"over", "max", "min", "add"}) std::printf("%10s", op);
  std::printf("\n");
  for (const Layout layout : {Layout::rgba32f, Layout::rgba16f, Layout::rgba8}) {
    for (std::size_t a = 0; a < algorithm_count; ++a) {
      std::printf("%-11s %2zu B", std::string(name_of(Algorithm(a))).c_str(), bytes_per_pixel(layout));
      for (const Operator op : all_operators) {
        double worst = 0;
        for (const int ranks : numbers_of_ranks())
          for (unsigned trial = 0; trial < 3; ++trial) {
            const unsigned seed = 1000 * unsigned(ranks) + 100 * unsigned(op) + trial;
            SCOPED_TRACE(::testing::Message() << name_of(Algorithm(a)) << " seed " << seed);
            Scene scene = random_scene(op, ranks, seed);
            // Bytes cannot exceed 1, sums can.
            if (op == Operator::add && layout == Layout::rgba8)
              for (Image& image : scene.images)
                for (float& value : image.rgba) value /= float(ranks);
            Schedule plan = schedule_of(scene, Algorithm(a));
            plan.packed = trial > 0;
            const Result result = exchanged(scene, plan, layout);
            ASSERT_EQ(result.image.rect, plan.whole);
            ASSERT_EQ(result.bytes_told, result.bytes_counted);
            const double error = largest_error(scene, result.image);
            ASSERT_LE(error, bound_of(layout, op, ranks, int(plan.rounds.size())));
            worst = std::max(worst, error);
          }
        std::printf("%10.1e", worst);
      }
      std::printf("\n");
    }
  }
}

TEST(Exchange, MessagesThatAreReadInPlaceAreThoseThatAreSent) {
  for (std::size_t a = 0; a < algorithm_count; ++a)
    for (const Layout layout : {Layout::rgba32f, Layout::rgba16f, Layout::rgba8})
      for (const Operator op : all_operators) {
        SCOPED_TRACE(name_of(Algorithm(a)));
        const Scene scene = random_scene(op, 5, 31 + unsigned(a));
        Schedule plan = schedule_of(scene, Algorithm(a));
        plan.packed = layout != Layout::rgba32f;
        const Result in_place = exchanged(scene, plan, layout),
                     sent = exchanged(scene, plan, layout, Messages::sent);
        EXPECT_EQ(in_place.image.rgba, sent.image.rgba);
        EXPECT_EQ(in_place.bytes_told, sent.bytes_counted);
        EXPECT_EQ(in_place.messages, sent.messages);
      }
}

TEST(Exchange, RadixKHoldsForAnyFactors) {
  const Scene scene = [] {
    Scene all = random_scene(Operator::over, 12, 3);
    for (std::size_t rank = 0; rank < 12; ++rank)
      if (all.footprints[rank].empty()) {
        all.images[rank] = Image({int(rank), 0, 5, 5});
        std::ranges::fill(all.images[rank].rgba, 0.25F);
        all.footprints[rank] = all.images[rank].rect;
      }
    return all;
  }();
  for (const std::vector<int>& factors :
       std::vector<std::vector<int>>{{12}, {2, 6}, {6, 2}, {3, 4}, {2, 3, 2}}) {
    const Result result = exchanged(scene, schedule_of(scene, Algorithm::radix_k, factors));
    EXPECT_LE(largest_error(scene, result.image), 2e-6);
  }
  EXPECT_THROW(schedule_of(scene, Algorithm::radix_k, std::vector<int>{5, 2}), std::invalid_argument);
  EXPECT_EQ(radix_factors(96), (std::vector<int>{4, 4, 2, 3}));
}

TEST(Exchange, MessagesAndPixelsAreThoseOfItsCost) {
  for (std::size_t a = 0; a < algorithm_count; ++a)
    for (const int ranks : {2, 3, 8, 13}) {
      SCOPED_TRACE(::testing::Message() << name_of(Algorithm(a)) << ' ' << ranks);
      const Scene scene = random_scene(Operator::add, ranks, unsigned(ranks));
      Schedule plan = schedule_of(scene, Algorithm(a));
      const ExchangeCost counted = cost(plan, Layout::rgba32f, {});
      const Result sparing = exchanged(scene, plan);
      EXPECT_EQ(std::uint64_t(sparing.messages), counted.messages);
      // Messages that cannot be compressed may get longer by packing.
      EXPECT_LE(sparing.bytes_counted,
                most_packed_bytes(counted.pixels_sent) + 2 * head_bytes * counted.messages);
      plan.clear_pixels_travel = true;
      const Result all = exchanged(scene, plan);
      EXPECT_EQ(std::uint64_t(all.messages), counted.messages);
      EXPECT_EQ(all.bytes_counted, counted.bytes_sent);
      EXPECT_EQ(all.image.rgba, sparing.image.rgba);
    }
}

TEST(Exchange, UntouchedPixelsAreNotSent) {
  Scene scene;
  for (int rank = 0; rank < 4; ++rank) {
    Image& image = scene.images.emplace_back(Rect{0, 0, 64, 64});
    for (int y = 0; y < 4; ++y) std::fill_n(image.at(8, 16 * rank + y), 4 * 4, 0.5F);
    scene.footprints.push_back(image.rect);
    scene.order.push_back(rank);
  }
  for (const Operator op : {Operator::over, Operator::max, Operator::add}) {
    scene.op = op;
    for (std::size_t a = 0; a < algorithm_count; ++a) {
      const Result result = exchanged(scene, Algorithm(a));
      EXPECT_LE(result.bytes_counted, std::uint64_t(64 * 64 * 16) / 10) << name_of(Algorithm(a));
      EXPECT_LE(largest_error(scene, result.image), 2e-6);
    }
  }
}

TEST(Exchange, MinimumLeavesUntouchedPixelsAloneInAnyLayout) {
  Scene scene;
  scene.op = Operator::min;
  for (int rank = 0; rank < 3; ++rank) {
    Image& image = scene.images.emplace_back(Rect{0, 0, 9, 3});
    std::ranges::fill(image.rgba, volume::neutral_value(Operator::min));
    std::fill_n(image.at(rank, rank), 4, 1.0F);
    scene.footprints.push_back(image.rect);
    scene.order.push_back(rank);
  }
  for (const Layout layout : {Layout::rgba32f, Layout::rgba16f, Layout::rgba8}) {
    const Result result = exchanged(scene, schedule_of(scene, Algorithm::binary_swap), layout);
    EXPECT_EQ(result.image.at(0, 0)[0], 1.0F);
    EXPECT_EQ(result.image.at(8, 0)[0], volume::neutral_value(Operator::min));
  }
}

TEST(Exchange, PartsAreGatheredDirectlyFromRanksThatReachTheImage) {
  std::uint64_t travelled = 0, gathered = 0;
  for (std::size_t a = 0; a < algorithm_count; ++a)
    for (const int ranks : {1, 2, 3, 5, 8})
      for (const Operator op : all_operators)
        for (unsigned trial = 0; trial < 4; ++trial) {
          const unsigned seed = 1000 * unsigned(ranks) + 100 * unsigned(op) + trial;
          SCOPED_TRACE(::testing::Message() << name_of(Algorithm(a)) << " seed " << seed);
          Scene scene = random_scene(op, ranks, seed);
          if (trial == 0)  // no pixel is untouched, so all pixels of every rectangle are sent
            for (Image& image : scene.images)
              for (float& value : image.rgba) value = 0.5F + value / 4;
          Schedule plan = schedule_of(scene, Algorithm(a));
          const Result usual = exchanged(scene, plan);
          std::vector<bool> reached_by;
          reached_by.reserve(std::size_t(ranks));
          for (int rank = 0; rank < ranks; ++rank)
            reached_by.push_back(trial < 2 || (seed + unsigned(rank)) % 3 > 0);
          write_gathered(plan, reached_by);
          // What the memory held before must not show.
          std::vector<float> memory(4 * plan.whole.pixels(), -7);
          std::atomic<std::uint64_t> bytes = 0;
          std::atomic<int> messages = 0;
          std::uint64_t told = 0;
          run_ranks(ranks, [&](Communicator& communicator) {
            CountingCommunicator counting(communicator, bytes, messages);
            const auto me = std::size_t(communicator.rank());
            const Exchanged done = exchange(scene.images[me], plan, op, Layout::rgba32f, counting,
                                            me == 0 || reached_by[me] ? std::span(memory) : std::span<float>());
            EXPECT_TRUE(done.image.rgba.empty());
            if (me == 0) told = done.bytes;
          });
          ASSERT_EQ(memory, usual.image.rgba);
          ASSERT_EQ(told, bytes);
          ASSERT_EQ(std::uint64_t(messages), cost(plan, Layout::rgba32f, {}).messages);
          if (Algorithm(a) == Algorithm::direct_send && trial < 2) {
            travelled += bytes;
            gathered += usual.bytes_counted;
          }
        }
  std::printf("direct-send: %llu bytes travel instead of %llu\n", static_cast<unsigned long long>(travelled),
              static_cast<unsigned long long>(gathered));
  EXPECT_LT(double(travelled), 0.8 * double(gathered));
}

TEST(Exchange, PartsThatOverlapAreNotWrittenDirectly) {
  const Scene scene = random_scene(Operator::over, 4, 12);
  Schedule plan = schedule_of(scene, Algorithm::serial);
  const ExchangeCost before = cost(plan, Layout::rgba32f, {});
  write_gathered(plan, std::vector<bool>(4, true));
  EXPECT_EQ(cost(plan, Layout::rgba32f, {}).bytes_sent, before.bytes_sent);
  plan = schedule_of(scene, Algorithm::direct_send);
  const std::uint64_t gathered = cost(plan, Layout::rgba32f, {}).bytes_sent;
  write_gathered(plan, std::vector<bool>(4, true));
  EXPECT_LT(cost(plan, Layout::rgba32f, {}).bytes_sent, gathered);
}

TEST(Exchange, AutoTakesFewMessagesWhereLatencyRulesAndFewBytesWhereBandwidthDoes) {
  Scene scene;
  for (int rank = 0; rank < 16; ++rank) {
    scene.footprints.push_back({0, 0, 256, 256});
    scene.order.push_back(rank);
  }
  const auto chosen = [&](const MessageCost& communicator) {
    const Schedule best = cheapest(scene.order, scene.footprints, Layout::rgba32f, communicator);
    for (std::size_t a = 0; a < algorithm_count; ++a)
      EXPECT_LE(cost(best, Layout::rgba32f, communicator).seconds,
                cost(schedule_of(scene, Algorithm(a)), Layout::rgba32f, communicator).seconds);
    return cost(best, Layout::rgba32f, communicator);
  };
  const ExchangeCost slow_start = chosen({.latency = 1, .per_byte = 0, .per_pixel = 0}),
                     narrow = chosen({.latency = 0, .per_byte = 1, .per_pixel = 0});
  EXPECT_LT(slow_start.messages, narrow.messages);
  EXPECT_LT(narrow.most_pixels_sent, slow_start.most_pixels_sent + 1);
}

TEST(Exchange, AutoMovesLeastInAllWhereRanksShareOneProcessor) {
  Scene scene;
  for (int rank = 0; rank < 8; ++rank) {
    scene.footprints.push_back({0, 0, 256, 256});
    scene.order.push_back(rank);
  }
  const auto sent = [&](double ranks_at_once) {
    const MessageCost communicator{1e-6, 1e-9, 1e-9, ranks_at_once};
    return cost(cheapest(scene.order, scene.footprints, Layout::rgba32f, communicator), Layout::rgba32f,
                communicator)
        .pixels_sent;
  };
  EXPECT_EQ(sent(1), 7U * 256 * 256) << "every image once, as serial and tree do";
  EXPECT_GT(sent(8), 7U * 256 * 256) << "in regions, and these once more";
}

TEST(Exchange, CostOfAFullImageIsThatOfThePapers) {
  // Magallon, Hopf, Ertl 2001, section 3.2: serial sends N - 1 images to one rank; direct-send sends (N - 1)/N
  // of an image from each rank, and as much again in regions to rank 0.
  constexpr int ranks = 8;
  constexpr std::uint64_t image = 256 * 256;
  std::vector<Rank> order(ranks);
  std::iota(order.begin(), order.end(), 0);
  const std::vector<Rect> footprints(ranks, Rect{0, 0, 256, 256});
  const auto of = [&](Algorithm algorithm) {
    return cost(schedule(algorithm, order, footprints), Layout::rgba32f, {});
  };
  EXPECT_EQ(of(Algorithm::serial).pixels_sent, (ranks - 1) * image);
  EXPECT_EQ(of(Algorithm::tree).pixels_sent, (ranks - 1) * image);
  const std::uint64_t tiles_gathered = image * (ranks - 1) / ranks;
  EXPECT_EQ(of(Algorithm::direct_send).pixels_sent, (ranks - 1) * image + tiles_gathered);
  EXPECT_EQ(of(Algorithm::direct_send).messages, ranks * (ranks - 1) + ranks - 1);
  // Halves, quarters, eighths: as many pixels, in 3 messages from each rank instead of 7.
  EXPECT_EQ(of(Algorithm::binary_swap).pixels_sent, (ranks - 1) * image + tiles_gathered);
  EXPECT_EQ(of(Algorithm::binary_swap).messages, ranks * 3 + ranks - 1);
}

// Records the length of every message that a rank sends, and the bytes that it receives.
class RecordingCommunicator : public testing::ForwardingCommunicator {
 public:
  struct Sent {
    Rank to = 0;
    std::uint64_t bytes = 0;
    bool operator==(const Sent&) const = default;
  };

  using ForwardingCommunicator::ForwardingCommunicator;
  void transfer(std::span<const Outgoing> outgoing, std::span<const Incoming> incoming) override {
    for (const Outgoing& message : outgoing) sent.push_back({message.to, message.bytes.size()});
    ForwardingCommunicator::transfer(outgoing, incoming);
    for (const Incoming& message : incoming) received += *message.received;
  }

  std::vector<Sent> sent;
  std::uint64_t received = 0;
};

// Executes the schedule, and compares each message with the one counted beforehand.
void expect_counted(const Scene& scene, const Schedule& plan, Layout layout,
                    const std::vector<bool>& reached_by = {}) {
  std::vector<PixelMask> masks;
  for (const Image& image : scene.images) masks.push_back(mask_of(image.view(), scene.op));
  const CountedExchange counted = counted_exchange(plan, masks, scene.op, layout);
  std::vector<float> memory(reached_by.empty() ? 0 : 4 * plan.whole.pixels());
  std::uint64_t told = 0;
  run_ranks(int(scene.images.size()), [&](Communicator& communicator) {
    RecordingCommunicator recording(communicator);
    const auto me = std::size_t(communicator.rank());
    const bool reaches = !reached_by.empty() && (me == 0 || reached_by[me]);
    const Exchanged done = exchange(scene.images[me], plan, scene.op, layout, recording,
                                    reaches ? std::span(memory) : std::span<float>());
    if (me == 0) told = done.bytes;
    std::vector<RecordingCommunicator::Sent> expected;
    for (const CountedRound& round : counted.rounds)
      for (const CountedMessage& message : round.messages)
        if (message.from == communicator.rank()) expected.push_back({message.to, message.bytes});
    EXPECT_EQ(recording.sent, expected);
    EXPECT_EQ(recording.sent.size(), counted.ranks[me].messages_sent);
    EXPECT_EQ(recording.received, counted.ranks[me].bytes_received);
  });
  EXPECT_EQ(told, counted.bytes);
  EXPECT_EQ(cost(plan, layout, {}).messages, counted.messages);
  std::uint64_t of_rounds = 0, of_ranks = 0;
  for (const RankTraffic& rank : counted.ranks) of_ranks += rank.bytes_sent;
  for (const CountedRound& round : counted.rounds)
    for (const RankTraffic& rank : round.ranks) of_rounds += rank.bytes_received;
  EXPECT_EQ(of_rounds, counted.bytes);
  EXPECT_EQ(of_ranks, counted.bytes);
}

TEST(CountedExchange, EqualsEveryMessageOfEveryAlgorithmLayoutOperatorAndRankCount) {
  for (const Layout layout : {Layout::rgba32f, Layout::rgba16f, Layout::rgba8})
    for (std::size_t a = 0; a < algorithm_count; ++a)
      for (const int ranks : numbers_of_ranks())
        for (const Operator op : all_operators)
          for (unsigned trial = 0; trial < 3; ++trial) {
            // Narrow numbers follow the same masks: one trial for each number of ranks is enough.
            if (layout != Layout::rgba32f && trial != unsigned(ranks) % 3) continue;
            const unsigned seed = 1000 * unsigned(ranks) + 100 * unsigned(op) + trial;
            SCOPED_TRACE(::testing::Message() << name_of(Algorithm(a)) << " seed " << seed);
            Scene scene = random_scene(op, ranks, seed);
            for (Image& image : scene.images)
              for (std::size_t p = 0; p < image.rgba.size(); p += 4) {
                // Which pixels are touched; never so faintly that bytes round them to untouched ones.
                const bool touched = trial == 0 || (trial == 1 ? image.rgba[p + 3] > 0.5F : p / 4 % 11 == 0);
                for (std::size_t c = p; c < p + 4; ++c)
                  image.rgba[c] = touched ? 0.25F + image.rgba[c] / 2 : volume::neutral_value(op);
              }
            Schedule plan = schedule_of(scene, Algorithm(a));
            plan.clear_pixels_travel = trial == 2 && seed % 2 == 0;
            expect_counted(scene, plan, layout);
            std::vector<bool> reached_by;
            reached_by.reserve(std::size_t(ranks));
            for (int rank = 0; rank < ranks; ++rank)
              reached_by.push_back(trial < 2 || (seed + unsigned(rank)) % 3 > 0);
            write_gathered(plan, reached_by);
            expect_counted(scene, plan, layout, reached_by);
            if (HasFailure()) return;
          }
}

TEST(CountedExchange, LeavesOutOfTheCostOfFootprintsWhatNoSampleHasReached) {
  const Scene scene = random_scene(Operator::over, 12, 8);
  const Schedule plan = schedule_of(scene, Algorithm::radix_k);
  std::vector<PixelMask> nothing, everything;
  for (const Image& image : scene.images) {
    nothing.emplace_back(image.rect);
    std::ranges::fill(everything.emplace_back(image.rect).touched, std::uint8_t(1));
  }
  const ExchangeCost bound = cost(plan, Layout::rgba32f, {});
  EXPECT_EQ(counted_exchange(plan, nothing, Operator::over, Layout::rgba32f).bytes,
            bound.messages * head_bytes);
  EXPECT_LE(counted_exchange(plan, everything, Operator::over, Layout::rgba32f).bytes, bound.bytes_sent);
  EXPECT_THROW(counted_exchange(plan, {}, Operator::over, Layout::rgba32f), std::invalid_argument);
}

TEST(ExchangeSettings, KnowTheNamesThatUsersGive) {
  ExchangeSettings settings;
  for (std::size_t a = 0; a < algorithm_count; ++a) {
    EXPECT_TRUE(set_algorithm(settings, name_of(Algorithm(a))));
    EXPECT_EQ(settings.algorithm, Algorithm(a));
  }
  EXPECT_FALSE(set_algorithm(settings, "tre"));
  EXPECT_EQ(settings.algorithm, Algorithm::radix_k);
  EXPECT_TRUE(set_algorithm(settings, "auto"));
  EXPECT_FALSE(settings.algorithm);
  EXPECT_TRUE(set_layout(settings, "half"));
  EXPECT_FALSE(set_layout(settings, ""));
  EXPECT_EQ(settings.layout, Layout::rgba16f);
  EXPECT_TRUE(set_gather(settings, "root"));
  EXPECT_FALSE(set_gather(settings, "away"));
  EXPECT_EQ(settings.gather, Gather::root);
  EXPECT_TRUE(set_overlap(settings, "off"));
  EXPECT_FALSE(set_overlap(settings, "perhaps"));
  EXPECT_EQ(settings.overlap, Overlap::off);
  EXPECT_TRUE(set_packed(settings, "on"));
  EXPECT_FALSE(set_packed(settings, ""));
  EXPECT_EQ(settings.packed, true);
  EXPECT_TRUE(set_packed(settings, "auto"));
  EXPECT_FALSE(settings.packed);
}

/// Returns the rectangle of a message, over pixels that are all `blank`.
Image read(const PixelMessage& message, const Rect& rect, Layout layout, float blank) {
  Image image(rect);
  std::ranges::fill(image.rgba, blank);
  PixelReader reader(message, rect, layout);
  for (int y = rect.y; y < rect.y + rect.height; ++y)
    reader.read_row({image.at(rect.x, y), 4 * std::size_t(rect.width)});
  reader.end();
  return image;
}

PixelMessage arrived(PixelMessage message) {
  message.received() = message.size();
  return message;
}

// Bit for bit, for any numbers, including those that an image should not contain.
TEST(PixelMessages, FloatsArriveAsTheyWere) {
  std::mt19937 random(31);
  for (const Operator op : all_operators)
    for (int trial = 0; trial < 300; ++trial) {
      Image image({-2, 5, 1 + int(random() % 300), 1 + int(random() % 9)});
      std::ranges::fill(image.rgba, volume::neutral_value(op));
      // Spans and holes of any length, with similar or arbitrary numbers.
      const bool alike = random() % 2 == 0;
      for (std::size_t at = random() % 40; at < image.rgba.size() / 4; at += random() % 40)
        for (std::size_t left = random() % 120; left > 0 && at < image.rgba.size() / 4; --left, ++at)
          for (std::size_t c = 0; c < 4; ++c)
            image.rgba[4 * at + c] =
                alike ? 0.5F + 0.001F * float(random() % 8) : std::bit_cast<float>(std::uint32_t(random()));
      const PixelMessage message =
          arrived(encode_pixels(image, image.rect, op, Layout::rgba32f, trial % 3 > 0));
      EXPECT_LE(message.size(), space_for_pixels(image.rect, Layout::rgba32f).size());
      const Image same = read(message, image.rect, Layout::rgba32f, volume::neutral_value(op));
      ASSERT_EQ(std::memcmp(same.rgba.data(), image.rgba.data(), sizeof(float) * image.rgba.size()), 0)
          << trial;
    }
}

TEST(PixelMessages, NeighboursThatAreAlikeTakeLess) {
  Image image({0, 0, 256, 64});
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 256; ++x)
      for (int c = 0; c < 4; ++c) image.at(x, y)[c] = float(0.5 + 0.2 * std::sin(0.02 * (x + 3 * y + 9 * c)));
  for (const Layout layout : {Layout::rgba32f, Layout::rgba16f, Layout::rgba8}) {
    const PixelMessage message = encode_pixels(image, image.rect, Operator::over, layout, true);
    const double taken = double(message.size()) / double(image.rect.pixels());
    std::printf("%.2f bytes a pixel instead of %zu\n", taken, bytes_per_pixel(layout));
    EXPECT_LE(taken, 0.75 * double(bytes_per_pixel(layout)));
  }
}

TEST(PixelMessages, BlendAsTheirPixelsDo) {
  std::mt19937 random(32);
  for (const bool packed : {false, true})
    for (const Layout layout : {Layout::rgba32f, Layout::rgba16f, Layout::rgba8})
      for (const Operator op : all_operators) {
        Image back({0, 0, 700, 2}), front(back.rect);
        for (Image* const image : {&back, &front})
          for (float& value : image->rgba) value = float(random() % 1000) / 1000;
        const PixelMessage message = arrived(encode_pixels(back, back.rect, op, layout, packed));
        Image expected = front;
        blend(op, expected.rgba, read(message, back.rect, layout, volume::neutral_value(op)).rgba);
        PixelReader reader(message, back.rect, layout);
        for (int y = 0; y < 2; ++y) reader.blend_row_behind(op, {front.at(0, y), 4 * std::size_t(700)});
        reader.end();
        EXPECT_EQ(front.rgba, expected.rgba);
      }
}

TEST(PixelMessages, ThatDoNotFitTheirRectangleAreRefused) {
  Image image({0, 0, 37, 5});
  std::fill_n(image.at(2, 2), 4 * 23, 1.0F);
  std::fill_n(image.at(30, 3), 4, 0.5F);
  for (const bool packed : {false, true})
    for (const Layout layout : {Layout::rgba32f, Layout::rgba16f, Layout::rgba8}) {
      const PixelMessage message = encode_pixels(image, image.rect, Operator::over, layout, packed);
      const std::vector<std::byte> whole(message.bytes().begin(), message.bytes().end());
      const auto decode = [&](const std::vector<std::byte>& bytes) {
        PixelMessage arrived = space_for_pixels(image.rect, layout);
        std::ranges::copy(bytes, arrived.room().begin());
        arrived.received() = bytes.size();
        return read(arrived, image.rect, layout, 0);
      };
      // 0, 1/2 and 1: halves represent all three, bytes all but 1/2.
      EXPECT_EQ(decode(whole).rgba == image.rgba, layout != Layout::rgba8);
      for (std::size_t length = 0; length < whole.size(); ++length)
        EXPECT_THROW(decode({whole.begin(), whole.begin() + std::ptrdiff_t(length)}), RankLost) << length;
      for (std::size_t i = 8; i < whole.size(); ++i)
        for (const auto flip : {std::byte{0x80}, std::byte{0x0f}, std::byte{0x01}}) {
          std::vector<std::byte> changed = whole;
          changed[i] ^= flip;
          try {
            EXPECT_EQ(decode(changed).rgba.size(), image.rgba.size());
          } catch (const RankLost&) {
          }
        }
    }
}

TEST(ThreadCommunicator, ARankThatFailsLeavesNobodyWaiting) {
  EXPECT_THROW(run_ranks(3,
                         [](Communicator& communicator) {
                           if (communicator.rank() == 1) throw std::runtime_error("rank 1 gives up");
                           std::byte byte{};
                           communicator.broadcast(1, {&byte, 1});
                         }),
               std::runtime_error);
}

}  // namespace
}  // namespace understudy::compositor
