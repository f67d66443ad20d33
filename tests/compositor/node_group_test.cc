// SPDX-License-Identifier: Apache-2.0
// Whole node groups in one process: ranks are threads, sockets are real.
#include "tests/compositor/node_group.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/socket.h>

#include <array>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <memory>
#include <random>
#include <utility>
#include <variant>
#include <vector>

#include "compositor/exchange/thread_communicator.h"
#include "compositor/node/clients.h"
#include "compositor/node/node.h"
#include "compositor/service/image_buffer.h"
#include "compositor/service/rank_renderer.h"
#include "compositor/service/remote_service.h"
#include "compositor/service/request_message.h"
#include "compositor/service/service_protocols.h"
#include "tests/compositor/forwarding_communicator.h"
#include "tests/compositor/group_scene.h"
#include "volume/brick/brick_store.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/kd_tree.h"
#include "volume/matrix.h"
#include "volume/request.h"

namespace understudy::compositor {
namespace {

using ::testing::HasSubstr;
using namespace testing;
using std::chrono::milliseconds;
using volume::Operator;
using volume::TexelType;

TEST_F(NodeGroupTest, IntegralsAreThoseOfOneProcess) {
  const Texture texture = some_texture();
  volume::RenderRequest request = some_request(texture);
  request.steps.emplace();
  request.steps->metric = {40, 0, 0, 0, 36, 0, 0, 0, 28};
  std::vector<volume::Pixel> pixels;
  for (int y = 0; y < 120; y += 13)
    for (int x = 0; x < 160; x += 13) pixels.push_back({x, y});
  const auto embedded = embedded_service();
  upload(*embedded, texture);
  const auto expected = embedded->integrals(request, pixels, 2000);
  ASSERT_EQ(expected.size(), pixels.size());
  EXPECT_GT(std::ranges::max(expected, {}, [](const auto& pixel) { return pixel[3]; })[3], 0.5);
  for (const int ranks : {1, 3, 4}) {
    const Group& group = start(ranks);
    const auto service = connect();
    upload(*service, texture);
    const auto integrals = service->integrals(request, pixels, 2000);
    ASSERT_EQ(integrals.size(), pixels.size()) << ranks;
    for (std::size_t i = 0; i < pixels.size(); ++i)
      for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(integrals[i][k], expected[i][k], 1e-6) << ranks;
    // An image after them, and as many integrals as time allows.
    EXPECT_FALSE(service->render(request).image.rect.empty());
    EXPECT_LE(service->integrals(request, pixels, 0).size(), pixels.size());
    request.steps.reset();
    EXPECT_THROW(service->integrals(request, pixels, 100), RequestRefused);
    request.steps = volume::RaySteps{.metric = {40, 0, 0, 0, 36, 0, 0, 0, 28}};
    launcher_->ask([](Broker& b) { b.dismiss_node_group(); });
    EXPECT_TRUE(eventually([&] { return group.ended(); }));
  }
}

TEST_F(NodeGroupTest, LinkedEqualsEmbeddedForAnyRankCountOperatorAndTexelType) {
  for (const int ranks : {1, 2, 3, 4, 7}) {
    Group& group = start(ranks);
    const auto linked = connect(), embedded = embedded_service();
    EXPECT_EQ(linked->nodes(), ranks);
    EXPECT_EQ(embedded->nodes(), 0);
    double worst = 0;
    for (const TexelType type : {TexelType::u8, TexelType::u16, TexelType::f32, TexelType::rgba8}) {
      const Texture texture = some_texture(1 + std::uint64_t(type), type);
      upload(*linked, texture);
      upload(*embedded, texture);
      for (const Operator op : {Operator::over, Operator::max, Operator::min, Operator::add}) {
        const volume::RenderRequest request = some_request(texture, op);
        const volume::Image expected = image_of(*embedded, request);
        worst = std::max(worst, largest_difference(image_of(*linked, request), expected));
        // The scene must show something.
        ASSERT_GT(largest_difference(expected, volume::Image(request.window)), 0.05);
      }
    }
    std::printf("%d ranks: at most %.2g apart\n", ranks, worst);
    EXPECT_LE(worst, 1e-5);
    launcher_->ask([](Broker& b) { b.dismiss_node_group(); });
    EXPECT_TRUE(eventually([&] { return group.ended(); }));
  }
}

TEST_F(NodeGroupTest, CountsAreSummedOverRanks) {
  start(4);
  const auto linked = connect(), embedded = embedded_service();
  const Texture texture = some_texture();
  upload(*linked, texture);
  upload(*embedded, texture);
  const volume::FrameCounts one = embedded->render(some_request(texture)).counts;
  const volume::FrameCounts four = linked->render(some_request(texture)).counts;
  EXPECT_EQ(four.samples, one.samples);
  EXPECT_GE(four.rays, one.rays);
  EXPECT_GT(four.bytes_exchanged, 0U);
  EXPECT_EQ(one.bytes_exchanged, 0U);
  EXPECT_EQ(four.nodes_idle, 0U);
}

TEST_F(NodeGroupTest, ImagesFollowAWindowThatGrowsAndShrinks) {
  start(2);
  const auto linked = connect(), embedded = embedded_service();
  const Texture texture = some_texture();
  upload(*linked, texture);
  upload(*embedded, texture);
  for (const int side : {1, 40, 300, 10, 700, 120}) {
    const auto request =
        volume::testing::request_for(texture, volume::testing::usual_camera(side, side), side, side, 40);
    EXPECT_LE(largest_difference(image_of(*linked, request), image_of(*embedded, request)), 1e-5) << side;
  }
}

TEST_F(NodeGroupTest, EachApplicationHasItsOwnVolumeIds) {
  start(3);
  const auto first = connect(), second = connect();
  const Texture lobes = some_texture(7);
  Texture flat = lobes;
  std::ranges::fill(flat.texels, std::byte(200));
  upload(*first, lobes);
  upload(*second, flat);
  const auto alone = embedded_service();
  upload(*alone, lobes);
  const volume::RenderRequest request = some_request(lobes);
  const volume::Image expected = image_of(*alone, request);
  EXPECT_LE(largest_difference(image_of(*first, request), expected), 1e-5);
  EXPECT_GT(largest_difference(image_of(*second, request), expected), 0.05);
  second->forget_volume(7);
  EXPECT_THROW(second->render(request), RequestRefused);
  EXPECT_LE(largest_difference(image_of(*first, request), expected), 1e-5);
}

TEST_F(NodeGroupTest, AVolumeThatIsBegunAgainIsReplaced) {
  start(2);
  const auto linked = connect(), embedded = embedded_service();
  Texture texture = some_texture();
  upload(*linked, texture);
  std::ranges::fill(texture.texels, std::byte(90));
  texture.description.version = 1;
  upload(*linked, texture);
  upload(*embedded, texture);
  volume::RenderRequest request = some_request(texture);
  EXPECT_THROW(linked->render(request), RequestRefused);  // asks for the old version
  request.version = 1;
  EXPECT_LE(largest_difference(image_of(*linked, request), image_of(*embedded, request)), 1e-5);
}

// Returns the texels of boxes of a texture, one box after the other.
std::vector<std::byte> texels_of(const Texture& texture, std::span<const volume::TexelBox> boxes) {
  const std::size_t texel = volume::bytes_per_texel(texture.description.type);
  std::vector<std::byte> bytes;
  for (const volume::TexelBox& box : boxes) {
    std::vector<std::byte> part(volume::texels_in(box) * texel);
    volume::copy_texels(box, texel, texture.description.stored, texture.texels, box, part);
    bytes.insert(bytes.end(), part.begin(), part.end());
  }
  return bytes;
}

TEST_F(NodeGroupTest, ChangedTexelsGiveTheImageOfAFreshVolumeBitForBit) {
  const unsigned seed = 1811;
  std::printf("seed %u\n", seed);
  std::mt19937 random(seed);
  for (const int ranks : {0, 1, 4}) {
    Group* group = ranks > 0 ? &start(ranks) : nullptr;
    const auto service = ranks > 0 ? connect() : embedded_service();
    for (const TexelType type : {TexelType::u8, TexelType::f32}) {
      Texture texture = some_texture(7, type);
      upload(*service, texture);
      volume::RenderRequest request = some_request(texture);
      const volume::Image before = image_of(*service, request);
      for (std::uint64_t version = 1; version <= 4; ++version) {
        std::vector<volume::TexelBox> boxes(1 + random() % 5);
        for (volume::TexelBox& box : boxes)
          for (std::size_t k = 0; k < 3; ++k) {
            box.low[k] = int(random() % unsigned(texture.description.size[k]));
            box.high[k] = box.low[k] + 1 + int(random() % unsigned(texture.description.size[k] - box.low[k]));
          }
        const Texture other = volume::testing::noise(texture.description, unsigned(random()));
        for (const volume::TexelBox& box : boxes)
          volume::copy_texels(box, volume::bytes_per_texel(type), texture.description.stored, other.texels,
                              texture.description.stored, texture.texels);
        service->begin_change(7, version);
        EXPECT_THROW(service->render(request), RequestRefused) << "in the midst of a change";
        service->add_texels(7, boxes, texels_of(texture, boxes));
        service->end_volume(7);
        request.version = version;
        const volume::Image changed = image_of(*service, request);
        EXPECT_GT(largest_difference(changed, before), 0.01) << "the change is to be seen";

        Texture fresh = texture;
        fresh.description.id = 8;
        fresh.description.version = version;
        upload(*service, fresh);
        volume::RenderRequest of_fresh = request;
        of_fresh.volume = 8;
        EXPECT_EQ(largest_difference(image_of(*service, of_fresh), changed), 0)
            << ranks << " ranks, version " << version;
      }
    }
    if (group == nullptr) continue;
    launcher_->ask([](Broker& b) { b.dismiss_node_group(); });
    EXPECT_TRUE(eventually([&] { return group->ended(); }));
  }
}

// Counted where they arrive.
TEST_F(NodeGroupTest, TexelsTravelOnlyToTheRanksThatShowThem) {
  struct Counts {
    std::atomic<std::uint64_t> received = 0, broadcast = 0;
  };
  // The ranks outlive this function.
  const auto shared_counts = std::make_shared<Counts>();
  Counts& counts = *shared_counts;
  class Counting : public ForwardingCommunicator {
   public:
    Counting(Communicator& communicator, Counts& counts)
        : ForwardingCommunicator(communicator), counts_(counts) {}
    void transfer(std::span<const Outgoing> outgoing, std::span<const Incoming> incoming) override {
      for (const Incoming& message : incoming) counts_.received += message.bytes.size();
      ForwardingCommunicator::transfer(outgoing, incoming);
    }
    void broadcast(Rank root, std::span<std::byte> bytes) override {
      if (rank() != root) counts_.broadcast += bytes.size();
      ForwardingCommunicator::broadcast(root, bytes);
    }

   private:
    Counts& counts_;
  };
  constexpr int ranks = 4;
  start(ranks, limits::stall_patience,
        [shared_counts](Communicator& communicator, const std::function<void(Communicator&)>& run) {
          Counting counting(communicator, *shared_counts);
          run(counting);
        });
  const auto linked = connect();
  const Texture texture = some_texture();
  const volume::KdTree tree(texture.description, ranks);
  std::vector<volume::TexelBox> shown;
  std::uint64_t all = 0;
  for (int rank = 0; rank < ranks; ++rank) {
    shown.push_back(volume::BrickStore::texels_shown(texture.description, tree.box(rank)));
    if (rank > 0) all += volume::texels_in(shown.back());
  }
  upload(*linked, texture);
  EXPECT_EQ(counts.received, all);
  EXPECT_LT(counts.received, texture.texels.size()) << "less than one copy travels";
  EXPECT_LT(counts.broadcast, texture.texels.size() / 2) << "orders and boxes, no texels";

  // One texel within one rank's share, then one that two ranks share.
  const volume::TexelBox& last = shown.back();
  const volume::TexelBox one{{last.high[0] - 1, last.high[1] - 1, last.high[2] - 1}, last.high};
  const volume::TexelBox shared = volume::intersection(shown[2], shown[3]);
  ASSERT_FALSE(volume::is_empty(shared));
  for (const auto& [box, copies] : {std::pair{one, 1U}, {shared, 2U}}) {
    counts.received = 0;
    linked->begin_change(7, copies);
    linked->add_texels(7, {&box, 1}, texels_of(texture, {&box, 1}));
    linked->end_volume(7);
    std::uint64_t expected = 0;
    for (int rank = 1; rank < ranks; ++rank)
      expected += volume::texels_in(volume::intersection(box, shown[std::size_t(rank)]));
    EXPECT_GE(expected, copies * volume::texels_in(box));
    EXPECT_LT(expected, (copies + 1) * volume::texels_in(box)) << "an edge of it may be in a third share";
    EXPECT_EQ(counts.received, expected);
  }
  // An unchanged volume under a new version costs no texels.
  counts.received = 0;
  linked->begin_change(7, 3);
  linked->end_volume(7);
  EXPECT_EQ(counts.received, 0U);
}

/// Segments that reach to the next plane; tables of different seeds give different images.
volume::RenderRequest some_slice_segments(const Texture& texture, int seed) {
  volume::RenderRequest request = some_request(texture);
  volume::PreIntegrationTable pairs;
  pairs.edge = 128;
  for (int back = 0; back < pairs.edge; ++back)
    for (int front = 0; front < pairs.edge; ++front) {
      const float f = float(front) / 127, b = float(back) / 127;
      pairs.entries.push_back({f, b, float(seed) / 8, 0.02F + 0.1F * std::abs(f - b) + 0.02F * float(seed)});
    }
  request.classification = pairs;
  volume::SliceSegment& slice_segment = request.slice_segment.emplace();
  const double square = volume::dot(request.planes.normal, request.planes.normal);
  for (std::size_t k = 0; k < 3; ++k) {
    slice_segment.offset[k] = request.planes.normal[k] * request.planes.spacing / square;
    slice_segment.reach[k] = std::abs(slice_segment.offset[k]);
  }
  return request;
}

// Counted where it arrives: on two of three ranks.
TEST_F(NodeGroupTest, APreIntegrationTableTravelsOnce) {
  // The ranks outlive this function.
  const auto counter = std::make_shared<std::atomic<std::uint64_t>>(0);
  class Counting : public ForwardingCommunicator {
   public:
    Counting(Communicator& communicator, std::atomic<std::uint64_t>& bytes)
        : ForwardingCommunicator(communicator), bytes_(bytes) {}
    void broadcast(Rank root, std::span<std::byte> bytes) override {
      if (rank() != root) bytes_ += bytes.size();
      ForwardingCommunicator::broadcast(root, bytes);
    }

   private:
    std::atomic<std::uint64_t>& bytes_;
  };
  start(3, limits::stall_patience,
        [counter](Communicator& communicator, const std::function<void(Communicator&)>& run) {
          Counting counting(communicator, *counter);
          run(counting);
        });
  std::atomic<std::uint64_t>& broadcast = *counter;
  Texture texture = some_texture();
  texture.description.ghost_layer = 8;
  const auto linked = connect(), other = connect(), embedded = embedded_service();
  for (RenderService* service : {linked.get(), other.get(), embedded.get()}) upload(*service, texture);

  constexpr std::uint64_t table = 2 * 128 * 128 * sizeof(volume::Rgba), no_table = 2 * 2000;
  std::vector<volume::Image> expected;
  for (int seed = 0; seed <= limits::max_kept_pre_integration_tables; ++seed)
    expected.push_back(image_of(*embedded, some_slice_segments(texture, seed)));
  const auto expect = [&](RenderService& service, int seed, bool sent) {
    broadcast = 0;
    const volume::Image image = image_of(service, some_slice_segments(texture, seed));
    EXPECT_LE(largest_difference(image, expected[std::size_t(seed)]), 1e-5) << seed;
    if (sent) {
      EXPECT_GE(broadcast, table) << seed;
      EXPECT_LT(broadcast, table + no_table) << seed;
    } else {
      EXPECT_LT(broadcast, no_table) << seed;
    }
  };
  ASSERT_GT(largest_difference(expected[0], expected[1]), 0.01) << "one can tell the tables apart";

  expect(*linked, 0, true);
  std::printf("%llu bytes with the table", static_cast<unsigned long long>(broadcast.load()));
  expect(*linked, 0, false);
  std::printf(", %llu without\n", static_cast<unsigned long long>(broadcast.load()));
  expect(*linked, 1, true);
  for (int turn = 0; turn < 2; ++turn) {
    expect(*linked, 0, false);
    expect(*linked, 1, false);
  }
  // Another application has its own places.
  expect(*other, 2, true);
  expect(*linked, 0, false);
  expect(*other, 2, false);
  // One table more than there are places: the least recently used one is dropped.
  for (int seed = 2; seed <= limits::max_kept_pre_integration_tables; ++seed) expect(*linked, seed, true);
  expect(*linked, 0, false);
  expect(*linked, 1, true);

  // A refused table is in no place, and neither is the one that was dropped for it.
  volume::RenderRequest bad = some_slice_segments(texture, 0);
  std::get<volume::PreIntegrationTable>(bad.classification).entries.pop_back();
  EXPECT_THROW(linked->render(bad), RequestRefused);
  EXPECT_THROW(linked->render(bad), RequestRefused);
  expect(*linked, 0, false);
  for (int seed = 1; seed < limits::max_kept_pre_integration_tables; ++seed)
    EXPECT_LE(
        largest_difference(image_of(*linked, some_slice_segments(texture, seed)), expected[std::size_t(seed)]),
        1e-5);
}

// An application refers to a table that it never sent.
TEST_F(NodeGroupTest, APreIntegrationTableThatIsNotThereIsARefusal) {
  start(2);
  const auto senseless = raw_client();
  senseless->send(NodeMessage::render, 2, encode(some_slice_segments(some_texture(), 0), 0), soon());
  const Message reply = senseless->receive(soon());
  EXPECT_EQ(reply.type, LauncherMessage::refused);
  EXPECT_THAT(decode_text(reply.payload), HasSubstr("holds no pre-integration table"));
}

TEST_F(NodeGroupTest, WhatIsWrongWithAVolumeThatWasGivenUpConcernsNoOther) {
  start(2);
  const auto linked = connect();
  const Texture texture = some_texture();
  upload(*linked, texture);
  volume::VolumeDescription senseless = texture.description;
  senseless.id = 8;
  senseless.size = {0, 1, 1};
  for (int i = 0; i < 2; ++i) {
    linked->begin_volume(senseless);
    EXPECT_GT(linked->render(some_request(texture)).counts.samples_taken, 0U);
    linked->begin_volume(senseless);
    EXPECT_NO_THROW(linked->forget_volume(8));
    linked->begin_volume(senseless);
    upload(*linked, texture);
  }
}

TEST_F(NodeGroupTest, LargeAndManyBoxesTravelInSeveralMessages) {
  start(2);
  const auto linked = connect(), embedded = embedded_service();
  Texture texture = volume::testing::sampled(volume::testing::describe({300, 200, 170}, TexelType::u8),
                                             volume::testing::marschner_lobb_field());
  for (RenderService* service : {linked.get(), embedded.get()}) {
    service->begin_volume(texture.description);
    service->add_texels(7, {&texture.description.stored, 1}, texture.texels);
    service->end_volume(7);
  }
  std::vector<volume::TexelBox> points;
  for (std::size_t i = 0; i < limits::max_boxes_per_message + 10; ++i) {
    const std::array<int, 3> at{int(i % 300), int(i / 300) + 80, 60};
    points.push_back({at, {at[0] + 1, at[1] + 1, at[2] + 90}});
  }
  const std::vector<std::byte> texels(points.size() * 90, std::byte(220));
  for (RenderService* service : {linked.get(), embedded.get()}) {
    service->begin_change(7, 1);
    service->add_texels(7, points, texels);
    service->end_volume(7);
  }
  volume::RenderRequest request = some_request(texture);
  request.version = 1;
  EXPECT_LE(largest_difference(image_of(*linked, request), image_of(*embedded, request)), 1e-5);
}

// Both services refuse senseless requests alike, with a reason, and go on serving.
TEST_F(NodeGroupTest, SenselessRequestsAreRefusedAndTheServiceGoesOn) {
  start(3);
  for (const auto& service : {connect(), embedded_service()}) {
    const Texture texture = some_texture();
    const volume::RenderRequest good = some_request(texture);
    EXPECT_THROW(service->render(good), RequestRefused);  // unknown volume

    service->begin_volume(texture.description);
    EXPECT_THROW(service->render(good), RequestRefused);  // incomplete
    EXPECT_THROW(service->end_volume(texture.description.id), RequestRefused);

    service->begin_volume(texture.description);
    const volume::TexelBox first_slice{{0, 0, 0}, {41, 37, 1}}, outside{{0, 0, 28}, {41, 37, 30}};
    EXPECT_THROW(
        service->add_texels(texture.description.id, {&first_slice, 1}, std::span(texture.texels).first(5)),
        RequestRefused);
    for (const auto& [box, texels] : {std::pair{outside, 2}, {volume::TexelBox{{0, 0, 0}, {41, 36, 1}}, 1}}) {
      service->begin_volume(texture.description);
      const auto bytes = std::span(texture.texels).first(volume::texels_in(box));
      // A later call may report the error.
      EXPECT_THROW(
          {
            service->add_texels(texture.description.id, {&box, 1}, bytes);
            service->end_volume(texture.description.id);
          },
          RequestRefused)
          << texels;
    }
    EXPECT_THROW(
        {
          service->begin_change(99, 1);
          service->end_volume(99);
        },
        RequestRefused);

    volume::VolumeDescription senseless = texture.description;
    const auto begin_and_end = [&] {
      service->begin_volume(senseless);
      service->end_volume(senseless.id);
    };
    senseless.size = {0, 1, 1};
    EXPECT_THROW(begin_and_end(), RequestRefused);
    senseless.size = {16384, 16384, 16384};
    senseless.stored = {{0, 0, 0}, senseless.size};
    senseless.type = TexelType::rgba8;
    EXPECT_THROW(begin_and_end(), RequestRefused);

    upload(*service, texture);
    volume::RenderRequest bad = good;
    bad.texture_to_clip.fill(0);
    EXPECT_THROW(service->render(bad), RequestRefused);
    bad = good;
    bad.texture_to_clip[5] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(service->render(bad), RequestRefused);
    bad = good;
    bad.window = {0, 0, 100'000, 100'000};
    EXPECT_THROW(service->render(bad), RequestRefused);
    bad = good;
    std::get<volume::TransferFunction>(bad.classification).entries.resize(1);
    EXPECT_THROW(service->render(bad), RequestRefused);

    EXPECT_GT(service->render(good).counts.samples_taken, 0U);
  }
}

TEST_F(NodeGroupTest, AnErrorOnOneRankIsARefusalByAll) {
  // Rank 1 reads garbage where the others read the request.
  std::atomic<bool> armed = false;
  class Corrupting : public ForwardingCommunicator {
   public:
    Corrupting(Communicator& communicator, std::atomic<bool>& armed)
        : ForwardingCommunicator(communicator), armed_(armed) {}
    void broadcast(Rank root, std::span<std::byte> bytes) override {
      ForwardingCommunicator::broadcast(root, bytes);
      if (rank() == 1 && bytes.size() > 256 && armed_.exchange(false))
        std::ranges::fill(bytes, std::byte(0xff));
    }

   private:
    std::atomic<bool>& armed_;
  };
  start(3, limits::stall_patience,
        [&](Communicator& communicator, const std::function<void(Communicator&)>& run) {
          Corrupting corrupting(communicator, armed);
          run(corrupting);
        });
  const auto linked = connect();
  const Texture texture = some_texture();
  upload(*linked, texture);
  armed = true;
  EXPECT_THROW(linked->render(some_request(texture)), RequestRefused);
  EXPECT_GT(linked->render(some_request(texture)).counts.samples_taken, 0U);

  // A volume is not kept in part if some ranks refused a slice range, because they had received it before.
  linked->begin_volume(texture.description);
  linked->add_texels(texture.description.id, {&texture.description.stored, 1}, texture.texels);
  const volume::TexelBox first_slice{{0, 0, 0}, {41, 37, 1}};
  linked->add_texels(texture.description.id, {&first_slice, 1}, std::span(texture.texels).first(41 * 37));
  EXPECT_THROW(linked->end_volume(texture.description.id), RequestRefused);
  EXPECT_THROW(linked->end_volume(texture.description.id), RequestRefused);
  upload(*linked, texture);
  EXPECT_GT(linked->render(some_request(texture)).counts.samples_taken, 0U);
}

TEST_F(NodeGroupTest, AStuckApplicationHoldsUpNobodyAndIsDroppedInTheEnd) {
  start(2, milliseconds(200));
  const auto stuck = raw_client();
  MessageHeader header{.type = NodeMessage::render};
  header.payload_bytes = 1000;
  ASSERT_GT(::send(stuck->fd(), &header, sizeof header, MSG_NOSIGNAL), 0);
  const auto linked = connect();
  const Texture texture = some_texture();
  upload(*linked, texture);
  EXPECT_GT(linked->render(some_request(texture)).counts.samples_taken, 0U);
  EXPECT_THROW(stuck->receive(soon()), ConnectionLost);
}

TEST_F(NodeGroupTest, GarbageIsDroppedAndDisturbsNobody) {
  start(2);
  const auto linked = connect();
  const Texture texture = some_texture();
  upload(*linked, texture);
  const auto garbage = raw_client(), wrong_type = raw_client(), huge = raw_client();
  const std::string text(1000, 'x');
  ASSERT_GT(::send(garbage->fd(), text.data(), text.size(), MSG_NOSIGNAL), 0);
  wrong_type->send(LauncherMessage::hello_nodes, 2, encode(Hello{3}), soon());
  MessageHeader header{.type = NodeMessage::render};
  header.payload_bytes = std::uint64_t(1) << 62;
  ASSERT_GT(::send(huge->fd(), &header, sizeof header, MSG_NOSIGNAL), 0);
  for (const auto& each : {garbage.get(), wrong_type.get(), huge.get()})
    EXPECT_THROW(each->receive(soon()), ConnectionLost);
  // A message that is malformed only in its content is answered.
  const auto senseless = raw_client();
  senseless->send(NodeMessage::render, 2, encode_text("no request"), soon());
  const Message answer = senseless->receive(soon());
  EXPECT_EQ(answer.type, LauncherMessage::refused);
  EXPECT_THAT(decode_text(answer.payload), HasSubstr("render request: field"));
  EXPECT_GT(linked->render(some_request(texture)).counts.samples_taken, 0U);
}

TEST_F(NodeGroupTest, ImageBufferThatCouldVanishIsNotUsed) {
  start(1);
  const auto client = raw_client();
  const FileDescriptor unsealed(::memfd_create("unsealed", MFD_CLOEXEC | MFD_ALLOW_SEALING));
  ASSERT_EQ(::ftruncate(unsealed.get(), 4096), 0);
  client->send(NodeMessage::image_buffer, 2, encode_size(4096), soon(), unsealed.get());
  EXPECT_THAT(decode_text(client->receive(soon()).payload), HasSubstr("sealed"));
  const ImageBuffer small = ImageBuffer::create(4096);
  client->send(NodeMessage::image_buffer, 3, encode_size(8192), soon(), small.fd());
  EXPECT_THAT(decode_text(client->receive(soon()).payload), HasSubstr("smaller"));
  client->send(NodeMessage::image_buffer, 4, encode_size(4096), soon());
  EXPECT_THAT(decode_text(client->receive(soon()).payload), HasSubstr("no descriptor"));
}

TEST_F(NodeGroupTest, ALostGroupIsReportedAndANewConnectionWorks) {
  start(2);
  const Texture texture = some_texture();
  auto linked = connect();
  upload(*linked, texture);
  const volume::RenderRequest request = some_request(texture);
  const volume::Image before = image_of(*linked, request);
  launcher_->ask([](Broker& b) { b.dismiss_node_group(); });
  EXPECT_TRUE(eventually([&] { return groups_.back()->ended(); }));
  std::string first;
  try {
    linked->render(request);
    ADD_FAILURE() << "an image without a group";
  } catch (const ServiceLost& lost) {
    first = lost.what();
    EXPECT_THAT(first, HasSubstr(path_));
    EXPECT_EQ(first.find('\n'), std::string::npos);
  }
  // Later calls throw at once, with the same reason.
  try {
    linked->end_volume(1);
    ADD_FAILURE();
  } catch (const ServiceLost& lost) {
    EXPECT_EQ(lost.what(), first);
  }
  start(3);
  linked = connect();
  EXPECT_EQ(linked->nodes(), 3);
  EXPECT_THROW(linked->render(request), RequestRefused);  // the volume must be uploaded to the new group
  upload(*linked, texture);
  EXPECT_LE(largest_difference(image_of(*linked, request), before), 1e-5);
}

TEST_F(NodeGroupTest, AnApplicationMayComeBeforeTheGroup) {
  std::unique_ptr<RenderService> linked;
  std::jthread application([&] { linked = connect(); });
  EXPECT_TRUE(eventually([&] { return launcher_->ask([](Broker& b) { return b.clients_waiting() == 1; }); }));
  start(2);
  application.join();
  EXPECT_EQ(linked->nodes(), 2);
}

TEST_F(NodeGroupTest, WithoutAGroupPatienceEndsInServiceLost) {
  try {
    remote_render_service(path_, 50);
    ADD_FAILURE();
  } catch (const ServiceLost& lost) {
    EXPECT_THAT(lost.what(), HasSubstr("within 50 ms"));
  }
  launcher_->ask([](Broker& b) { b.turn_away("MPI is not installed: apt install openmpi-bin"); });
  try {
    connect();
    ADD_FAILURE();
  } catch (const ServiceLost& lost) {
    EXPECT_THAT(lost.what(), HasSubstr("apt install openmpi-bin"));
  }
  EXPECT_THROW(remote_render_service("/nowhere/at/all", 50), ServiceLost);
  EXPECT_THROW(remote_render_service(std::string(300, 'x'), 50), ServiceLost);
}

// A node group that accepts applications and then misbehaves.
class BadGroup {
 public:
  BadGroup(const std::string& path, Launcher& launcher)
      : control_(connect_to(path, soon()), service_protocols) {
    control_.send(LauncherMessage::hello_nodes, 1, encode(Hello{1}), soon());
    EXPECT_TRUE(launcher.wait_for_group());
  }
  Connection take_in() {
    Connection client(control_.receive(soon()).attached, service_protocols);
    client.send(LauncherMessage::accepted, 1, encode(Hello{1}), soon());
    return client;
  }

 private:
  Connection control_;
};

TEST_F(NodeGroupTest, AGroupThatNeverAnswersIsGivenUp) {
  BadGroup group(socket_of_nodes(path_), *launcher_);
  std::unique_ptr<RenderService> linked;
  std::jthread application([&] { linked = remote_render_service(path_, {.reply = milliseconds(50)}); });
  const Connection taken = group.take_in();
  application.join();
  try {
    linked->end_volume(1);
    ADD_FAILURE();
  } catch (const ServiceLost& lost) {
    EXPECT_THAT(lost.what(), HasSubstr("did not answer in time"));
  }
}

TEST_F(NodeGroupTest, AGroupThatDoesNotReadIsGivenUp) {
  BadGroup group(socket_of_nodes(path_), *launcher_);
  std::unique_ptr<RenderService> linked;
  std::jthread application([&] { linked = remote_render_service(path_, {.send = milliseconds(50)}); });
  const Connection taken = group.take_in();
  application.join();
  const std::vector<std::byte> slice(std::size_t(8) << 20);
  const volume::TexelBox box{{0, 0, 0}, {2048, 4096, 1}};
  EXPECT_THROW(linked->add_texels(1, {&box, 1}, slice), ServiceLost);
}

TEST_F(NodeGroupTest, AnswersThatCannotBeTrueEndTheConnection) {
  BadGroup group(socket_of_nodes(path_), *launcher_);
  const volume::RenderRequest request = some_request(some_texture());
  const std::vector<std::function<void(Connection&, const Message&)>> lies{
      // An image outside the window.
      [](Connection& c, const Message& m) {
        c.send(NodeMessage::rendered, m.sequence, encode(RenderedReply{{0, 0, 100, 100}, {}}), soon());
      },
      // More pixels than the image buffer holds.
      [](Connection& c, const Message& m) {
        c.send(NodeMessage::rendered, m.sequence, encode(RenderedReply{{0, 0, 8000, 8000}, {}}), soon());
      },
      // The answer to another request, the wrong kind of answer, an empty answer, no message at all.
      [](Connection& c, const Message& m) {
        c.send(NodeMessage::rendered, m.sequence + 1, encode(RenderedReply{}), soon());
      },
      [](Connection& c, const Message& m) { c.send(NodeMessage::done, m.sequence, Bytes{}, soon()); },
      [](Connection& c, const Message& m) { c.send(NodeMessage::rendered, m.sequence, Bytes{}, soon()); },
      [](Connection& c, const Message&) { ::send(c.fd(), "x marks the spot, not a header", 30, MSG_NOSIGNAL); },
      // The end of the connection instead of an image; half an answer, and nothing more.
      [](Connection& c, const Message&) { ::shutdown(c.fd(), SHUT_RDWR); },
      [](Connection& c, const Message& m) {
        MessageHeader header{.type = NodeMessage::rendered};
        header.sequence = m.sequence;
        header.payload_bytes = 100;
        ::send(c.fd(), &header, sizeof header, MSG_NOSIGNAL);
        ::shutdown(c.fd(), SHUT_RDWR);
      },
  };
  for (const auto& lie : lies) {
    std::jthread liar([&] {
      Connection client = group.take_in();
      const Message memory = client.receive(soon());
      EXPECT_TRUE(memory.attached);
      client.send(NodeMessage::done, memory.sequence, Bytes{}, soon());
      lie(client, client.receive(soon()));
    });
    const auto linked = connect();
    EXPECT_THROW(linked->render(request), ServiceLost);
    EXPECT_THROW(linked->render(request), ServiceLost);
  }
}

TEST(Clients, AreServedOnIfOneTooManyHasGoneAlready) {
  const ScratchFolder folder;
  const std::string path = folder / "control";
  const FileDescriptor listening = listen_at(path);
  Clients clients(path, 1, limits::stall_patience);
  Connection launcher(
      FileDescriptor(::accept4(listening.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC)),
      service_protocols);
  std::vector<FileDescriptor> applications;
  for (std::size_t i = 0; i <= limits::max_clients; ++i) {
    std::array<int, 2> ends{};
    ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends.data()), 0);
    const FileDescriptor passed_on(ends[1]);
    FileDescriptor application(ends[0]);
    if (i < limits::max_clients) applications.push_back(std::move(application));
    application = {};  // the last one has gone
    launcher.send(LauncherMessage::client, 0, Bytes{}, soon(), passed_on.get());
  }
  Connection first(std::move(applications.front()), service_protocols);
  first.send(NodeMessage::forget_volume, 1, encode_id(7), soon());
  EXPECT_TRUE(std::holds_alternative<Clients::Request>(clients.next()));
}

TEST(NodeGroup, ALauncherThatIsNotThereEndsAllRanks) {
  run_ranks(3, [](Communicator& communicator) {
    EXPECT_EQ(run_node(communicator, "/nowhere/at/all"), communicator.rank() != 0);
  });
}

TEST(NodeGroup, LeavesNoDescriptorBehind) {
  const auto before = open_descriptors();
  {
    const ScratchFolder folder;
    const std::string path = folder / "control";
    auto launcher = std::make_unique<Launcher>(path);
    Group group(2, socket_of_nodes(path));
    ASSERT_TRUE(launcher->wait_for_group());
    for (int i = 0; i < 3; ++i) {
      const auto linked = remote_render_service(path, 20'000);
      const Texture texture = some_texture();
      upload(*linked, texture);
      for (const int side : {10, 50, 90}) {
        linked->render(
            volume::testing::request_for(texture, volume::testing::usual_camera(side, side), side, side, 20));
      }
    }
    launcher.reset();
  }
  EXPECT_EQ(open_descriptors(), before);
}

TEST(RankRenderer, ForgetsWhatAnApplicationLeaves) {
  RankRenderer renderer(0, 1);
  for (std::uint64_t client = 1; client <= 2; ++client)
    for (std::uint64_t id = 1; id <= 3; ++id) renderer.begin(client, some_texture(id).description);
  EXPECT_EQ(renderer.volumes(), 6U);
  renderer.forget_client(1);
  EXPECT_EQ(renderer.volumes(), 3U);
  renderer.forget({2, 3});
  renderer.forget({2, 3});
  EXPECT_EQ(renderer.volumes(), 2U);
}

TEST(RankRenderer, KeepsNoMoreVolumesOfOneApplicationThanTheLimit) {
  RankRenderer renderer(0, 1);
  volume::VolumeDescription tiny = volume::testing::describe({2, 2, 2}, TexelType::u8);
  for (tiny.id = 0; tiny.id < limits::max_volumes_per_client; ++tiny.id) renderer.begin(1, tiny);
  EXPECT_THROW(renderer.begin(1, tiny), RequestRefused);
  EXPECT_NO_THROW(renderer.begin(2, tiny));
  tiny.id = 0;
  EXPECT_NO_THROW(renderer.begin(1, tiny));  // replaces one
}

}  // namespace
}  // namespace understudy::compositor
