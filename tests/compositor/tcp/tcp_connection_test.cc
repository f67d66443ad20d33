// SPDX-License-Identifier: Apache-2.0
// Links whose other end is busy, and such whose other end is gone.
#include "compositor/transport/tcp/tcp_connection.h"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <optional>
#include <random>
#include <thread>
#include <vector>

#include "compositor/service/service_protocols.h"
#include "compositor/transport/tcp/tcp_socket.h"

namespace understudy::compositor::testing {
namespace {

using std::chrono::milliseconds;

/// More than lines and machines keep on the way.
constexpr std::size_t much = std::size_t(64) << 20;
constexpr milliseconds patience(600);

/// Nothing is gained by compressing it.
std::vector<std::byte> noise() {
  std::vector<std::byte> bytes(much);
  std::generate(bytes.begin(), bytes.end(),
                [random = std::mt19937(1)]() mutable { return std::byte(random()); });
  return bytes;
}

class TcpConnectionTest : public ::testing::Test {
 protected:
  TcpConnectionTest() {
    const FileDescriptor listening = listen_at(TcpAddress{"127.0.0.1", 0});
    const Deadline deadline = Clock::now() + std::chrono::seconds(10);
    FileDescriptor near = connect_to(own_address(listening.get()), deadline);
    EXPECT_TRUE(wait_until_ready(listening.get(), POLLIN, deadline));
    FileDescriptor far(::accept4(listening.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
    set_connection_options(far.get());
    near_.emplace(std::move(near), service_protocols, 2 * much, patience);
    far_.emplace(std::move(far), service_protocols, 2 * much, patience);
  }

  /// Until its thread is asked to stop.
  std::jthread far_says_that_it_is_there() {
    return std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        far_->send_alive();
        std::this_thread::sleep_for(patience / 8);
      }
    });
  }

  const std::vector<std::byte> payload_ = noise();
  std::optional<TcpConnection> near_;
  std::optional<TcpConnection> far_;
};

TEST_F(TcpConnectionTest, APeerThatIsBusyForLongIsWaitedFor) {
  std::jthread there = far_says_that_it_is_there();
  std::optional<Message> message;
  std::jthread busy([&] {
    std::this_thread::sleep_for(4 * patience);
    message = far_->receive();
  });
  const Bytes payload(payload_);
  near_->send(NodeMessage::add_texels, 3, {&payload, 1});
  busy.join();
  ASSERT_TRUE(message.has_value());
  EXPECT_EQ(message->sequence, 3U);
  EXPECT_EQ(message->payload, payload_);
}

TEST_F(TcpConnectionTest, APeerThatTakesNothingAndSaysNothingIsGone) {
  const Bytes payload(payload_);
  EXPECT_THROW(near_->send(NodeMessage::add_texels, 0, {&payload, 1}), ConnectionAbandoned);
}

TEST_F(TcpConnectionTest, WhoWaitsForASilentPeerIsTold) {
  EXPECT_THROW(near_->receive(), ConnectionAbandoned);
}

TEST_F(TcpConnectionTest, WhoOnlySaysThatHeIsThereSendsNoMessage) {
  std::optional<std::jthread> there = far_says_that_it_is_there();
  std::jthread later([&] {
    std::this_thread::sleep_for(4 * patience);
    there.reset();
    const Bytes nothing;
    far_->send(NodeMessage::done, 5, {&nothing, 1});
  });
  EXPECT_EQ(near_->receive().sequence, 5U);
  EXPECT_EQ(near_->received().messages, 1U);
}

}  // namespace
}  // namespace understudy::compositor::testing
