// SPDX-License-Identifier: Apache-2.0
// Failures of real nodes, and what follows: the right image or none, one log line, and nothing left behind.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/socket.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "compositor/rendered.h"
#include "compositor/service/image_buffer.h"
#include "compositor/service/remote_service.h"
#include "compositor/service/request_message.h"
#include "compositor/service/service_protocols.h"
#include "tests/compositor/group_resources.h"
#include "tests/compositor/group_scene.h"
#include "tests/compositor/mpi_group.h"
#include "volume/image.h"
#include "volume/request.h"

namespace understudy::compositor {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using namespace testing;
using std::chrono::milliseconds;

Deadline soon() {
  return Clock::now() + std::chrono::seconds(20);
}

// A launcher and a group of real nodes. When both have ended, nothing may be left.
class Faults : public ::testing::Test {
 protected:
  void TearDown() override {
    launcher_.reset();
    if (group_) group_->wait();
    group_.reset();
    folder_.reset();
    EXPECT_EQ(before_.more(), "");
  }

  void start(int ranks, const BrokerPatience& patience = {}) {
    launcher_ = std::make_unique<Launcher>(path_, patience);
    group_ = std::make_unique<MpiGroup>(ranks, socket_of_nodes(path_));
    ASSERT_TRUE(launcher_->wait_for_group());
  }
  std::unique_ptr<RenderService> connect(const Patience& patience = {}) {
    return remote_render_service(path_, patience);
  }
  // An application that need not obey the protocol, accepted by rank 0.
  std::unique_ptr<Connection> raw_client() {
    auto result = std::make_unique<Connection>(connect_to(path_, soon()), service_protocols);
    result->send(LauncherMessage::hello_client, 1, Bytes{}, soon());
    EXPECT_EQ(result->receive(soon()).type, LauncherMessage::accepted);
    return result;
  }
  // Ranks by the order of their start, which is that of ranks.
  pid_t rank(std::size_t number) const {
    std::vector<pid_t> ranks = group_->ranks();
    std::ranges::sort(ranks);
    return number < ranks.size() ? ranks[number] : 0;
  }
  std::ptrdiff_t descriptors_of_rank_0() const {
    std::error_code gone;
    return std::distance(std::filesystem::directory_iterator(
                             std::filesystem::path("/proc") / std::to_string(rank(0)) / "fd", gone),
                         {});
  }
  void expect_right_image(RenderService& service) {
    const auto embedded = embedded_service();
    upload(*embedded, texture_);
    EXPECT_LE(largest_difference(image_of(service, request_), image_of(*embedded, request_)), 1e-5);
  }

  GroupResources before_;
  std::optional<ScratchFolder> folder_ = std::optional<ScratchFolder>(std::in_place);
  std::string path_ = *folder_ / "control";
  std::unique_ptr<Launcher> launcher_;
  std::unique_ptr<MpiGroup> group_;
  const Texture texture_ = some_texture();
  const volume::RenderRequest request_ = some_request(texture_);
};

class StoppedRank : public Faults, public ::testing::WithParamInterface<int> {};

TEST_P(StoppedRank, ForFiveSecondsOnlyDelaysTheImage) {
  start(3);
  const auto linked = connect();
  upload(*linked, texture_);
  const pid_t stopped = rank(std::size_t(GetParam()));
  ASSERT_EQ(::kill(stopped, SIGSTOP), 0);
  std::jthread again([&] {
    std::this_thread::sleep_for(std::chrono::seconds(5));
    ::kill(stopped, SIGCONT);
  });
  expect_right_image(*linked);
  expect_right_image(*linked);
  EXPECT_FALSE(launcher_->ask([](Broker& b) { return b.lost(); }));
  EXPECT_TRUE(launcher_->said().empty());
}

TEST_P(StoppedRank, ForGoodIsNoticedByTheLauncher) {
  start(3, {.silence = milliseconds(4000), .unwanted = milliseconds(500)});
  const auto linked = connect({.reply = milliseconds(1000), .render = milliseconds(1000)});
  upload(*linked, texture_);
  ASSERT_EQ(::kill(rank(std::size_t(GetParam())), SIGSTOP), 0);
  EXPECT_THROW(linked->render(request_), ServiceLost);
  EXPECT_TRUE(launcher_->wait_for_loss());
  EXPECT_THAT(launcher_->said(), Contains(HasSubstr("hang")));
  EXPECT_EQ(launcher_->said().size(), 1U);
  // As the launcher does with such a group.
  for (const pid_t pid : group_->ranks()) ::kill(pid, SIGKILL);
}

TEST_P(StoppedRank, OrOneThatIsKilledLeavesNothing) {
  start(3);
  const auto linked = connect();
  upload(*linked, texture_);
  ASSERT_EQ(::kill(rank(std::size_t(GetParam())), SIGKILL), 0);
  EXPECT_THROW(for (;;) linked->render(request_), ServiceLost);
  EXPECT_TRUE(launcher_->wait_for_loss());
  EXPECT_EQ(launcher_->said().size(), 1U);
}

INSTANTIATE_TEST_SUITE_P(Rank, StoppedRank, ::testing::Values(0, 1));

TEST_F(Faults, ApplicationsThatLeaveInTheMidstOfAnImageDisturbNobody) {
  start(3);
  const auto linked = connect();
  upload(*linked, texture_);
  expect_right_image(*linked);
  const std::ptrdiff_t descriptors = descriptors_of_rank_0();
  Texels all{texture_.description.id, {texture_.description.stored}, texture_.texels};
  for (int time = 0; time < 20; ++time) {
    const auto client = raw_client();
    const auto ask = [&](MessageType type, const std::vector<std::byte>& payload, int attach = -1) {
      client->send(type, 2, payload, soon(), attach);
      EXPECT_EQ(client->receive(soon()).type, NodeMessage::done);
    };
    ask(NodeMessage::begin_volume, encode(texture_.description));
    std::vector<std::byte> texels = encode_texels_head(all);
    texels.insert(texels.end(), all.texels.begin(), all.texels.end());
    texels.resize((texels.size() + 7) / 8 * 8);
    ask(NodeMessage::add_texels, texels);
    ask(NodeMessage::end_volume, encode_id(all.volume));
    const ImageBuffer memory = ImageBuffer::create(160 * 120 * 16);
    ask(NodeMessage::image_buffer, encode_size(160 * 120 * 16), memory.fd());
    client->send(NodeMessage::render, 3, encode(request_), soon());
    // The application leaves without the image.
  }
  expect_right_image(*linked);
  EXPECT_TRUE(eventually([&] { return descriptors_of_rank_0() == descriptors; })) << descriptors_of_rank_0();
  EXPECT_TRUE(launcher_->said().empty());
}

TEST_F(Faults, MessagesThatEndTooEarlyDisturbNobody) {
  start(2);
  const auto linked = connect();
  upload(*linked, texture_);
  const std::ptrdiff_t descriptors = descriptors_of_rank_0();
  const std::vector<std::byte> request = encode(request_);
  MessageHeader header{.type = NodeMessage::render};
  header.payload_bytes = request.size();
  std::vector<std::byte> message(sizeof header);
  std::memcpy(message.data(), &header, sizeof header);
  message.insert(message.end(), request.begin(), request.end());
  for (const std::size_t length : {std::size_t(1), sizeof header - 1, sizeof header, message.size() - 1}) {
    const auto client = raw_client();
    ASSERT_EQ(::send(client->fd(), message.data(), length, MSG_NOSIGNAL), ssize_t(length));
  }
  // A complete message whose content ends too early is answered.
  const auto senseless = raw_client();
  senseless->send(NodeMessage::render, 2, Bytes(request).first(request.size() / 2 / 8 * 8), soon());
  EXPECT_EQ(senseless->receive(soon()).type, LauncherMessage::refused);
  expect_right_image(*linked);
  EXPECT_TRUE(eventually([&] { return descriptors_of_rank_0() == descriptors + 1; }));
}

TEST_F(Faults, AnotherVersionOfTheProtocolIsTurnedAway) {
  start(2);
  MessageHeader header{.type = LauncherMessage::hello_client};
  ++header.type.version;
  // Refused by the launcher, with one line, and by rank 0.
  const Connection pending(connect_to(path_, soon()), service_protocols);
  ASSERT_GT(::send(pending.fd(), &header, sizeof header, MSG_NOSIGNAL), 0);
  EXPECT_TRUE(eventually([&] { return launcher_->said().size() == 1; }));
  EXPECT_THAT(launcher_->said(), Contains(HasSubstr("version")));
  const auto client = raw_client();
  header.type = NodeMessage::end_volume;
  ++header.type.version;
  ASSERT_GT(::send(client->fd(), &header, sizeof header, MSG_NOSIGNAL), 0);
  EXPECT_THROW(client->receive(soon()), ConnectionLost);
  const auto linked = connect();
  upload(*linked, texture_);
  expect_right_image(*linked);
}

TEST_F(Faults, AThousandConnectionsAtOnceLeaveTheFirstApplicationItsImages) {
  // Both ends of all connections are in this process.
  rlimit descriptors{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &descriptors), 0);
  if (descriptors.rlim_max < 4096) GTEST_SKIP() << "this process may not open 4,096 files (ulimit -n)";
  descriptors.rlim_cur = std::max<rlim_t>(descriptors.rlim_cur, 4096);
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &descriptors), 0);
  start(2);
  const auto linked = connect();
  upload(*linked, texture_);
  expect_right_image(*linked);
  const std::ptrdiff_t of_rank_0 = descriptors_of_rank_0();
  int accepted = 0, refused = 0;
  {
    std::vector<std::unique_ptr<Connection>> crowd;
    for (int i = 0; i < 1000; ++i) {
      crowd.push_back(std::make_unique<Connection>(connect_to(path_, soon()), service_protocols));
      try {
        crowd.back()->send(LauncherMessage::hello_client, 1, Bytes{}, soon());
      } catch (const ConnectionLost&) {
        // It was refused before it had sent its hello; the reason can be received.
      }
    }
    expect_right_image(*linked);
    for (const auto& one : crowd) {
      const MessageType answer = one->receive(soon()).type;
      accepted += answer == LauncherMessage::accepted;
      refused += answer == LauncherMessage::refused;
    }
  }
  std::printf("of 1000, %d were taken in, %d refused\n", accepted, refused);
  EXPECT_EQ(accepted + refused, 1000);
  EXPECT_LT(accepted, int(limits::max_clients));
  EXPECT_TRUE(eventually([&] { return descriptors_of_rank_0() == of_rank_0; })) << descriptors_of_rank_0();
  expect_right_image(*linked);
  const auto next = connect();
  upload(*next, texture_);
  expect_right_image(*next);
}

TEST_F(Faults, ImagesThatAreTooLargeOrEmptyAreRefusedOrEmpty) {
  start(2);
  const auto linked = connect();
  upload(*linked, texture_);
  volume::RenderRequest request = request_;
  request.window = request.viewport = {0, 0, 16384, 16384};
  EXPECT_THROW(linked->render(request), RequestRefused);
  // Rank 0 checks this itself, too.
  const auto client = raw_client();
  client->send(NodeMessage::render, 2, encode(request), soon());
  const Message answer = client->receive(soon());
  EXPECT_EQ(answer.type, LauncherMessage::refused);
  std::printf("16384 x 16384: %s\n", decode_text(answer.payload).c_str());
  for (const volume::Rect& nothing : {volume::Rect{0, 0, 0, 0}, volume::Rect{20, 20, 0, 10}}) {
    request = request_;
    request.window = nothing;
    for (const bool whole : {false, true}) {
      if (whole) request.viewport = nothing;
      try {
        EXPECT_TRUE(linked->render(request).image.rect.empty());
      } catch (const RequestRefused& refused) {
        std::printf("%d x %d: %s\n", nothing.width, nothing.height, refused.what());
      }
    }
  }
  // No rank has anything to show: the volume lies beside the window.
  request = request_;
  // x becomes x + 3 w.
  for (std::size_t column = 0; column < 4; ++column)
    request.texture_to_clip[column] += 3 * request.texture_to_clip[12 + column];
  const Rendered beside = linked->render(request);
  EXPECT_TRUE(beside.image.rect.empty());
  EXPECT_EQ(beside.counts.nodes_idle, 2U);
  expect_right_image(*linked);
}

TEST_F(Faults, MoreRanksThanVoxelsGiveTheRightImage) {
  start(7);
  const auto linked = connect(), embedded = embedded_service();
  volume::VolumeId id = 20;
  for (const std::array<int, 3>& size :
       {std::array{7, 1, 1}, std::array{2, 2, 2}, std::array{1, 1, 1}, std::array{3, 1, 2}}) {
    volume::VolumeDescription description = volume::testing::describe(size, volume::TexelType::u8);
    description.id = ++id;
    const Texture texture =
        volume::testing::sampled(description, [](const volume::Vec3& t) { return 0.3 + 0.6 * t[0] * t[1]; });
    upload(*linked, texture);
    upload(*embedded, texture);
    const volume::RenderRequest request = some_request(texture);
    const volume::Image expected = image_of(*embedded, request);
    EXPECT_LE(largest_difference(image_of(*linked, request), expected), 1e-5) << size[0] << size[1] << size[2];
    EXPECT_GT(largest_difference(expected, volume::Image(request.window)), 0.05);
  }
}

}  // namespace
}  // namespace understudy::compositor
