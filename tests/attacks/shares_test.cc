// SPDX-License-Identifier: Apache-2.0
// A client that requests too much: more samples than anybody needs, endless images, volumes until memory is
// full, node groups that die repeatedly. Other clients keep their share, and the service continues.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "apps/understudy/launch/restarts.h"
#include "compositor/node/turns.h"
#include "compositor/rendered.h"
#include "compositor/service/rank_renderer.h"
#include "tests/attacks/server.h"
#include "tests/clients/command_test.h"
#include "volume/request.h"

namespace attacks {
namespace {

using namespace understudy::compositor;
using namespace understudy;
using namespace std::chrono_literals;
using ::testing::HasSubstr;

TEST(TurnsOfClients, WhoAskedForMuchRestsAsLongAsItTookForEachOfTheOthers) {
  Turns turns;
  const Deadline start = Clock::now();
  turns.served(1, start, start + 1000ms, false);
  turns.served(2, start + 1000ms, start + 2000ms, false);
  EXPECT_EQ(turns.rests_until(3), Deadline());
  turns.served(3, start + 2000ms, start + 4000ms, false);
  EXPECT_EQ(turns.rests_until(3), start + 8000ms);
  EXPECT_LE(turns.rests_until(1), start + 4000ms);
}

TEST(TurnsOfClients, WhoLeavesAndComesAgainStillRestsWhileOthersAreThere) {
  Turns turns;
  const Deadline start = Clock::now();
  turns.served(1, start, start + 5ms, false);
  turns.served(2, start + 5ms, start + 3005ms, false);
  const Deadline rested = turns.rests_until(2);
  ASSERT_EQ(rested, start + 6005ms);
  turns.forget(2);
  turns.served(1, start + 5000ms, start + 5005ms, false);
  EXPECT_EQ(turns.rests_until(3), rested);
  EXPECT_EQ(turns.rests_until(4), rested);
  turns.served(3, rested, rested + 5ms, false);
  EXPECT_LE(turns.rests_until(3), rested + 5ms);
}

TEST(TurnsOfClients, WhoComesWhereNobodyAsksNeedNotRest) {
  Turns turns;
  const Deadline start = Clock::now();
  turns.served(1, start, start + 5ms, false);
  turns.served(2, start + 5ms, start + 3005ms, false);
  turns.forget(2);
  EXPECT_EQ(turns.rests_until(3), start + 5ms + limits::active_within);
  turns.forget(1);
  EXPECT_EQ(turns.rests_until(3), Deadline());
}

TEST(TurnsOfClients, ManyThatAskForNextToNothingCostNoMoreThanOneThatAsksForMuch) {
  Turns turns;
  Deadline now = Clock::now();
  const auto serve = [&](std::uint64_t client, std::chrono::milliseconds took) {
    turns.served(client, now, now + took, false);
    now += took;
  };
  const auto rest_after_an_image_beside = [&](std::chrono::milliseconds of_each) {
    serve(100, 500ms);
    now = turns.rests_until(100);
    for (std::uint64_t client = 0; client < 10; ++client) serve(client, of_each);
    serve(100, 500ms);
    return turns.rests_until(100) - now;
  };
  EXPECT_EQ(rest_after_an_image_beside(1ms), 500ms);
  EXPECT_EQ(rest_after_an_image_beside(10ms), 500ms);
  EXPECT_EQ(rest_after_an_image_beside(100ms), 2000ms) << "they use a second of the nodes";
}

TEST(TurnsOfClients, NobodyRestsForWhoRestsItself) {
  Turns turns;
  const Deadline start = Clock::now();
  turns.served(1, start, start + 5ms, false);
  turns.served(2, start + 5ms, start + 1005ms, true);
  ASSERT_EQ(turns.rests_until(2), start + 2005ms);
  // Otherwise the nodes would be idle in the meantime.
  turns.served(1, start + 1005ms, start + 1105ms, false);
  EXPECT_LE(turns.rests_until(1), start + 1105ms);
  // The other client may send a request during this rest.
  turns.served(1, start + 1900ms, start + 1980ms, false);
  EXPECT_EQ(turns.rests_until(1), start + 1980ms + 55ms);
}

TEST(TurnsOfClients, WhoIsRefusedRestsLongerThanOthersRestForIt) {
  Turns turns;
  const Deadline start = Clock::now();
  turns.served(1, start - 1ms, start, true);
  turns.served(2, start, start + 100ms, false);
  EXPECT_EQ(turns.rests_until(2), start + 101ms);
  turns.served(1, start + 101ms, start + 102ms, true);
  EXPECT_EQ(turns.rests_until(1), start + 102ms + limits::short_request);
  // A request that is given up after some time counts as served.
  turns.served(1, start + 200ms, start + 1200ms, true);
  EXPECT_EQ(turns.rests_until(1), start + 2200ms);
  turns.served(2, start + 2200ms, start + 2300ms, false);
  EXPECT_EQ(turns.rests_until(2), start + 2400ms);
}

TEST(TurnsOfClients, WhoIsAloneNeverRests) {
  Turns turns;
  const Deadline start = Clock::now();
  turns.served(1, start, start + 5ms, false);
  // The other client has been silent for a long time.
  turns.served(2, start + 60s, start + 63s, false);
  EXPECT_LE(turns.rests_until(2), start + 63s);
}

TEST(TurnsOfClients, NobodyRestsForLongerThanAClientWaits) {
  Turns turns;
  const Deadline start = Clock::now();
  for (std::uint64_t client = 1; client < 60; ++client) turns.served(client, start, start + 100ms, false);
  turns.served(60, start + 100ms, start + 6100ms, false);
  EXPECT_EQ(turns.rests_until(60), start + 6100ms + limits::longest_rest);
  EXPECT_LT(limits::longest_rest, limits::render_patience);
}

TEST(LostGroups, AreForgivenWithTime) {
  launcher::Restarts restarts;
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(restarts.after(launcher::restart_forgiven_after)) << i;
}

TEST(LostGroups, ThatDieAtOnceAreStartedABoundedNumberOfTimesWithGrowingPauses) {
  launcher::Restarts restarts;
  auto before = 0ms;
  for (int i = 0; i < launcher::max_restarts; ++i) {
    const auto pause = restarts.after(1s);
    ASSERT_TRUE(pause) << i;
    EXPECT_GT(*pause, before);
    before = *pause;
  }
  EXPECT_FALSE(restarts.after(1s));
}

volume::VolumeDescription cube(volume::VolumeId id, int edge) {
  volume::VolumeDescription description;
  description.id = id;
  description.size = {edge, edge, edge};
  description.stored = {{0, 0, 0}, description.size};
  return description;
}

TEST(MemoryOfClients, IsBoundedForOneAndForAll) {
  constexpr std::uint64_t volume_bytes = 64 * 64 * 64;
  RankRenderer renderer(0, 1, volume::cpu_renderer, {3 * volume_bytes, 2 * volume_bytes, 0ms});
  const auto refusal = [&](std::uint64_t client, volume::VolumeId id) -> std::string {
    try {
      renderer.begin(client, cube(id, 64));
    } catch (const RequestRefused& refused) {
      return refused.what();
    }
    return {};
  };
  EXPECT_EQ(refusal(1, 1), "");
  EXPECT_EQ(refusal(1, 2), "");
  EXPECT_THAT(refusal(1, 3), HasSubstr("of this client it holds"));
  EXPECT_EQ(refusal(1, 2), "") << "in its own place";
  EXPECT_EQ(refusal(2, 1), "");
  EXPECT_THAT(refusal(2, 2), HasSubstr("for all its clients"));
  renderer.forget_client(1);
  EXPECT_EQ(refusal(2, 2), "");
}

TEST(MemoryOfClients, IsThatOfTheMachineOrOfItsControlGroup) {
  const ClientLimits alone = client_limits(1, 0ms);
  EXPECT_GT(alone.bytes_in_all, 0U);
  EXPECT_LT(alone.bytes_in_all, usable_memory());
  EXPECT_EQ(client_limits(4, 0ms).bytes_in_all, alone.bytes_in_all / 4);
  EXPECT_EQ(client_limits(1, 6s).bytes_of_client, alone.bytes_in_all / 2);
}

/// Rays without termination through `samples` planes.
volume::RenderRequest request_of(int edge, int samples) {
  volume::RenderRequest request;
  request.volume = 7;
  request.texture_to_clip = {2, 0, 0, -1, 0, 2, 0, -1, 0, 0, 2, -1, 0, 0, 0, 1};
  request.viewport = request.window = {0, 0, edge, edge};
  request.planes = {{0, 0, 1}, 0.5 / samples, 1.0 / samples, samples};
  volume::TransferFunction function;
  function.low = 0;
  function.high = 1;
  function.entries.assign(256, {0.5F, 0.5F, 0.5F, 1e-6F});
  request.classification = function;
  return request;
}

class Shares : public clients::CommandTest {
 protected:
  static std::unique_ptr<LoadingService> client_of(const Server& server) {
    auto service = server.loading_service();
    LoadRequest load;
    load.volume = cube(7, 64);
    load.file = "synthetic:64x64x64";
    service->begin_load(load);
    while (!std::ranges::all_of(service->continue_load(7), &RankLoad::done)) continue;
    return service;
  }
  static std::vector<float> image(RenderService& service) {
    const Rendered rendered = service.render(request_of(64, 64));
    return {rendered.image.rgba.begin(), rendered.image.rgba.end()};
  }
  static std::string refusal(RenderService& service, const volume::RenderRequest& request) {
    try {
      service.render(request);
    } catch (const RequestRefused& refused) {
      return refused.what();
    }
    return {};
  }
};

TEST_F(Shares, MoreSamplesThanAnybodyNeedsAreRefusedAtOnce) {
  Server server(file(""));
  const auto attacker = client_of(server);
  EXPECT_THAT(refusal(*attacker, request_of(1024, 1 << 22)), HasSubstr("samples is over the limit"));
  EXPECT_FALSE(image(*attacker).empty());
  EXPECT_EQ(server.process().err(), "");
}

TEST_F(Shares, AnImageThatTakesTooLongIsGivenUpAndTheNextOnesAreRight) {
  Server server(file(""), {"--image-time", "100"});
  const auto attacker = client_of(server);
  const auto neighbour = client_of(server);
  const std::vector<float> right = image(*neighbour);
  EXPECT_THAT(refusal(*attacker, request_of(1024, 1 << 18)), HasSubstr("took longer than 100 ms"));
  EXPECT_EQ(image(*attacker), right);
  EXPECT_EQ(image(*neighbour), right);
  EXPECT_EQ(server.process().err(), "");
}

TEST_F(Shares, TheClientBesideItKeepsItsImages) {
  Server server(file(""), {"--image-time", "300"});
  const auto neighbour = client_of(server);
  const std::vector<float> right = image(*neighbour);
  std::jthread attack([&](const std::stop_token& stop) {
    const auto attacker = client_of(server);
    while (!stop.stop_requested()) refusal(*attacker, request_of(1024, 1 << 18));
  });
  for (int i = 0; i < 10; ++i) EXPECT_EQ(image(*neighbour), right);
  attack.request_stop();
  attack.join();
  EXPECT_EQ(server.process().err(), "");
}

}  // namespace
}  // namespace attacks
