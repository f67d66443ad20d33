// SPDX-License-Identifier: Apache-2.0
// mpirun and real understudy-node processes, and what happens when one of them is killed.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "apps/bench/frame_parts.h"
#include "compositor/rendered.h"
#include "compositor/service/remote_service.h"
#include "tests/all_cases.h"
#include "tests/compositor/group_scene.h"
#include "tests/compositor/mpi_group.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/request.h"

namespace understudy::compositor {
namespace {

using namespace testing;

TEST(MpiNode, ImagesEqualTheEmbeddedOnesForAnyNumberOfRanks) {
  const auto embedded = embedded_service();
  const Texture texture = some_texture();
  upload(*embedded, texture);
  for (const int ranks : {1, 2, 3, 4, 7}) {
    const ScratchFolder folder;
    const std::string path = folder / "control";
    auto launcher = std::make_unique<Launcher>(path);
    MpiGroup group(ranks, socket_of_nodes(path));
    const auto linked = remote_render_service(path, 60'000);
    EXPECT_EQ(linked->nodes(), ranks);
    upload(*linked, texture);
    double worst = 0;
    volume::FrameCounts counts;
    for (const volume::Operator op : {volume::Operator::over, volume::Operator::max}) {
      const volume::RenderRequest request = some_request(texture, op);
      const Rendered rendered = linked->render(request);
      counts = rendered.counts;
      worst = std::max(worst, largest_difference(whole_image(rendered, request), image_of(*embedded, request)));
    }
    std::printf(
        "%d ranks: at most %.2g apart; last frame %.2f ms to render, %.2f ms to composite, %llu bytes\n", ranks,
        worst, counts.render_ms, counts.composite_ms, static_cast<unsigned long long>(counts.bytes_exchanged));
    EXPECT_LE(worst, 1e-5);
    // All ranks end in an orderly way when the launcher closes its connection.
    launcher.reset();
    EXPECT_EQ(group.wait(), 0);
  }
}

TEST(MpiNode, ImagesStayTheSameWhileRanksAreBalanced) {
  // All that is visible lies in one corner: divided by blocks, one rank would have all of it.
  const auto embedded = embedded_service();
  Texture texture = some_texture();
  const auto corner = [](const volume::Vec3& t) {
    return t[0] < 0.4 && t[1] < 0.5 && t[2] < 0.5 ? t[0] + 0.5 : 0;
  };
  texture = volume::testing::sampled(texture.description, corner);
  upload(*embedded, texture);
  const std::vector<std::vector<std::string>> ways{
      {"--balance", "muller"}, {"--balance", "predicted"}, {"--sort", "last", "--partition", "cost"}};
  for (const std::vector<std::string>& way : ways) {
    const ScratchFolder folder;
    const std::string path = folder / "control";
    Launcher launcher(path);
    MpiGroup group(4, socket_of_nodes(path), way);
    const auto linked = remote_render_service(path, 60'000);
    upload(*linked, texture);
    double worst = 0;
    for (int image = 0; image < 15; ++image) {
      volume::RenderRequest request = some_request(texture);
      auto& entries = std::get<volume::TransferFunction>(request.classification).entries;
      if (image % 5 == 4) std::ranges::reverse(entries);  // now the rest of the volume shows
      worst = std::max(worst, largest_difference(image_of(*linked, request), image_of(*embedded, request)));
    }
    std::printf("%s: at most %.2g apart\n", way.back().c_str(), worst);
    EXPECT_LE(worst, 1e-5) << way.back();
  }
}

TEST(MpiNode, EveryExchangeAndLayoutGivesTheEmbeddedImage) {
  const auto embedded = embedded_service();
  const Texture texture = some_texture();
  upload(*embedded, texture);
  const volume::RenderRequest request = some_request(texture);
  const volume::Image expected = image_of(*embedded, request);
  const std::vector<std::pair<std::vector<std::string>, double>> ways{
      {{"--exchange", "serial"}, 1e-5},
      {{"--exchange", "tree"}, 1e-5},
      {{"--exchange", "direct-send"}, 1e-5},
      {{"--exchange", "binary-swap"}, 1e-5},
      {{"--exchange", "radix-k"}, 1e-5},
      {{"--exchange", "radix-k", "--overlap", "on"}, 1e-5},
      {{"--exchange", "tree", "--pixels", "half"}, 6.0 / 2048},
      {{"--exchange", "auto", "--pixels", "byte"}, 6.0 / 510}};
  for (const auto& [options, bound] : ways) {
    const ScratchFolder folder;
    const std::string path = folder / "control";
    Launcher launcher(path);
    MpiGroup group(3, socket_of_nodes(path), options);
    const auto linked = remote_render_service(path, 60'000);
    upload(*linked, texture);
    const Rendered rendered = linked->render(request);
    const double apart = largest_difference(whole_image(rendered, request), expected);
    std::printf("%-12s %-5s at most %.2g apart, %llu bytes\n", options[1].c_str(),
                options.size() > 2 ? options[3].c_str() : "float", apart,
                static_cast<unsigned long long>(rendered.counts.bytes_exchanged));
    EXPECT_LE(apart, bound) << options[1];
  }
}

TEST(MpiNode, SendsTheBytesAndMessagesThatAreCountedFromThePartsOfAnImage) {
  const Texture texture = some_texture();
  const auto count = [&](const volume::RenderRequest& request, int ranks, Algorithm algorithm, Gather gather) {
    const volume::KdTree tree(texture.description, ranks);
    return bench::counted(bench::cast_parts(texture.description, texture.texels, request, tree), algorithm,
                          gather, request.op, Layout::rgba32f);
  };
  for (int ranks = 1; ranks <= 8; ++ranks)
    for (std::size_t a = 0; a < algorithm_count; ++a) {
      // All algorithms for some numbers of ranks, one for the others; both ways of gathering. (Groups take
      // seconds to start; `./run bench scaling` measures all combinations.)
      const bool all_algorithms = ranks == 3 || (takes_all_cases() && (ranks == 2 || ranks == 5 || ranks == 8));
      if (!all_algorithms && a != std::size_t(ranks) % algorithm_count) continue;
      const Gather gather = (ranks + int(a)) % 2 == 0 ? Gather::direct : Gather::root;
      const std::string name(name_of(Algorithm(a))), way = gather == Gather::direct ? "direct" : "root";
      SCOPED_TRACE(::testing::Message() << ranks << " ranks, " << name << ", " << way);
      const ScratchFolder folder;
      const std::string path = folder / "control";
      Launcher launcher(path);
      MpiGroup group(ranks, socket_of_nodes(path),
                     {"--exchange", name, "--gather", way, "--overlap", "off", "--packed", "off"});
      const auto linked = remote_render_service(path, 60'000);
      upload(*linked, texture);
      for (const volume::Operator op : {volume::Operator::over, volume::Operator::max, volume::Operator::min}) {
        volume::RenderRequest request = some_request(texture, op);
        const CountedExchange counted = count(request, ranks, Algorithm(a), gather);
        const Rendered rendered = linked->render(request);
        EXPECT_EQ(rendered.counts.bytes_exchanged, counted.bytes);
        EXPECT_EQ(rendered.counts.messages, counted.messages);
      }
    }
}

// How often the threads of a process have given up a processor.
long long waits_of(pid_t process) {
  long long waits = 0;
  for (const auto& thread : std::filesystem::directory_iterator(fmt::format("/proc/{}/task", process))) {
    std::ifstream status(thread.path() / "status");
    for (std::string line; std::getline(status, line);)
      if (line.starts_with("voluntary_ctxt_switches:")) waits += std::stoll(line.substr(line.find(':') + 1));
  }
  return waits;
}

TEST(MpiNode, AGroupWithoutWorkLeavesTheProcessorsToOthers) {
  const ScratchFolder folder;
  const std::string path = folder / "control";
  Launcher launcher(path);
  MpiGroup group(4, socket_of_nodes(path));
  const auto linked = remote_render_service(path, 60'000);
  const Texture texture = some_texture();
  upload(*linked, texture);
  image_of(*linked, some_request(texture));
  std::map<pid_t, long long> before;
  for (const pid_t rank : group.ranks()) before[rank] = waits_of(rank);
  ASSERT_EQ(before.size(), 4U);
  std::this_thread::sleep_for(std::chrono::seconds(2));
  for (const auto& [rank, waits] : before) {
    const long long more = waits_of(rank) - waits;
    std::printf("rank's process %d woke %lld times in two seconds\n", rank, more);
    EXPECT_LE(more, 200);  // a rank that polls once a millisecond: 2000
  }
}

TEST(MpiNode, AKilledRankEndsInServiceLostAndANewGroupTakesOver) {
  const ScratchFolder folder;
  const std::string path = folder / "control";
  Launcher launcher(path);
  const Texture texture = some_texture();
  const volume::RenderRequest request = some_request(texture);
  volume::Image before;
  {
    MpiGroup group(3, socket_of_nodes(path));
    const auto linked = remote_render_service(path, 60'000);
    upload(*linked, texture);
    before = image_of(*linked, request);
    const std::vector<pid_t> ranks = group.ranks();
    ASSERT_EQ(ranks.size(), 3U);
    ::kill(ranks.back(), SIGKILL);
    // The group may answer a few more times before MPI notices; it must never hang.
    EXPECT_THROW(for (;;) image_of(*linked, request), ServiceLost);
    EXPECT_TRUE(launcher.wait_for_loss());
    EXPECT_NE(group.wait(), 0);
  }
  MpiGroup next(2, socket_of_nodes(path));
  const auto linked = remote_render_service(path, 60'000);
  upload(*linked, texture);
  EXPECT_LE(largest_difference(image_of(*linked, request), before), 1e-5);
}

TEST(MpiNode, AHangingRankEndsInServiceLostWithinTheTimeLimit) {
  const ScratchFolder folder;
  const std::string path = folder / "control";
  Launcher launcher(path);
  const Texture texture = some_texture();
  MpiGroup group(2, socket_of_nodes(path));
  const auto linked = remote_render_service(path, Patience{.render = std::chrono::milliseconds(2000)});
  upload(*linked, texture);
  linked->render(some_request(texture));
  const std::vector<pid_t> ranks = group.ranks();
  ASSERT_EQ(ranks.size(), 2U);
  for (const pid_t rank : ranks) ::kill(rank, SIGSTOP);
  EXPECT_THROW(linked->render(some_request(texture)), ServiceLost);
  for (const pid_t rank : ranks) ::kill(rank, SIGCONT);
}

TEST(MpiNode, ALauncherThatIsNotThereEndsTheGroupWithAMessage) {
  MpiGroup group(2, "/nowhere/at/all");
  EXPECT_NE(group.wait(), 0);
}

}  // namespace
}  // namespace understudy::compositor
