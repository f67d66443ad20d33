// SPDX-License-Identifier: Apache-2.0
// Connections whose other end is busy, and connections whose other end has gone.
#include "compositor/transport/tcp/tcp_connection.h"

#include <dlfcn.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <random>
#include <thread>
#include <vector>

#include "compositor/service/service_protocols.h"
#include "tests/compositor/tcp/session.h"

namespace {

/// Whether hosts also have an address of a family that no kernel knows, before all others.
bool has_address_of_no_family = false;

}  // namespace

/// In place of the C library's.
extern "C" int getaddrinfo(const char* host, const char* service, const addrinfo* wanted, addrinfo** found) {
  static const auto real = reinterpret_cast<decltype(&::getaddrinfo)>(::dlsym(RTLD_NEXT, "getaddrinfo"));
  const int error = real(host, service, wanted, found);
  if (error != 0 || !has_address_of_no_family) return error;
  auto* const first = static_cast<addrinfo*>(std::malloc(sizeof(addrinfo)));  // freeaddrinfo() calls free()
  *first = **found;
  first->ai_family = AF_MAX;
  first->ai_canonname = nullptr;
  first->ai_next = *found;
  *found = first;
  return 0;
}

namespace understudy::compositor::testing {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;

/// More than connections and machines buffer.
constexpr std::size_t much = std::size_t(64) << 20;
constexpr milliseconds patience(600);

/// Cannot be compressed.
std::vector<std::byte> noise() {
  std::vector<std::byte> bytes(much);
  std::generate(bytes.begin(), bytes.end(),
                [random = std::mt19937(1)]() mutable { return std::byte(random()); });
  return bytes;
}

class TcpConnectionTest : public ::testing::Test {
 protected:
  TcpConnectionTest() {
    auto [near, far] = connected_sockets();
    const auto [near_keys, far_keys] = keys_of_session(secret_of("sixteen bytes or more"));
    near_.emplace(AuthenticatedSocket{std::move(near), near_keys}, service_protocols, 2 * much, patience);
    far_.emplace(AuthenticatedSocket{std::move(far), far_keys}, service_protocols, 2 * much, patience);
  }

  /// Sends signs of life until its thread is asked to stop.
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

TEST(TcpSocket, TriesTheNextAddressWhereThereIsNoSocketForOne) {
  const FileDescriptor listening = listen_at(TcpAddress{"127.0.0.1", 0});
  has_address_of_no_family = true;
  EXPECT_NO_THROW(connect_to(own_address(listening.get()), Clock::now() + std::chrono::seconds(10)));
  has_address_of_no_family = false;
}

/// An attacker between two connections.
class TamperedConnectionTest : public ::testing::Test {
 protected:
  TamperedConnectionTest() {
    auto [near, near_line] = connected_sockets();
    auto [far_line, far] = connected_sockets();
    const auto [near_keys, far_keys] = keys_of_session(secret_of("sixteen bytes or more"));
    near_.emplace(AuthenticatedSocket{std::move(near), near_keys}, service_protocols, much);
    far_.emplace(AuthenticatedSocket{std::move(far), far_keys}, service_protocols, much);
    near_line_ = std::move(near_line);
    far_line_ = std::move(far_line);
  }

  void say(const std::string& text) {
    const Bytes payload = std::as_bytes(std::span(text));
    near_->send(NodeMessage::add_texels, 1, {&payload, 1});
  }
  /// Returns what the near end has sent.
  std::vector<std::byte> intercepted() {
    std::vector<std::byte> bytes(1 << 16);
    EXPECT_TRUE(wait_until_ready(near_line_.get(), POLLIN, Clock::now() + std::chrono::seconds(10)));
    const ssize_t got = ::recv(near_line_.get(), bytes.data(), bytes.size(), 0);
    bytes.resize(std::size_t(std::max<ssize_t>(got, 0)));
    return bytes;
  }
  void hand_on(std::span<const std::byte> bytes) {
    EXPECT_EQ(::send(far_line_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL), ssize_t(bytes.size()));
  }
  /// Returns why the far end ends the session; empty if it has received a message.
  std::string end_of_session() {
    try {
      far_->receive();
    } catch (const MalformedMessage& error) {
      return error.what();
    }
    return {};
  }

  std::optional<TcpConnection> near_;
  std::optional<TcpConnection> far_;
  FileDescriptor near_line_;
  FileDescriptor far_line_;
};

TEST_F(TamperedConnectionTest, ReadsNothing) {
  const std::string words = "/scans/of_somebody.nrrd glTexImage3D and then some texels";
  say(words);
  const std::vector<std::byte> line = intercepted();
  ASSERT_GT(line.size(), words.size());
  const std::string text(reinterpret_cast<const char*>(line.data()), line.size());
  for (std::size_t i = 0; i + 4 <= words.size(); ++i)
    EXPECT_EQ(text.find(words.substr(i, 4)), std::string::npos) << words.substr(i, 4);
  EXPECT_EQ(text.find("USDY"), std::string::npos);
  hand_on(line);
  EXPECT_EQ(end_of_session(), "");
}

TEST_F(TamperedConnectionTest, AFlippedByteEndsTheSession) {
  say("some texels");
  std::vector<std::byte> line = intercepted();
  line.back() ^= std::byte(1);
  hand_on(line);
  EXPECT_THAT(end_of_session(), HasSubstr("changed, replayed or left out on its way"));
}

TEST_F(TamperedConnectionTest, AReplayedRecordEndsTheSession) {
  say("the first, behind the head of the stream");
  hand_on(intercepted());
  EXPECT_EQ(end_of_session(), "");
  say("some texels");
  const std::vector<std::byte> line = intercepted();
  hand_on(line);
  EXPECT_EQ(end_of_session(), "");
  hand_on(line);
  EXPECT_THAT(end_of_session(), HasSubstr("changed, replayed or left out on its way"));
}

TEST_F(TamperedConnectionTest, AMessageWithoutEncryptionEndsTheSession) {
  MessageHeader header;
  header.type = NodeMessage::done;
  const std::vector<std::byte> head(stream_head_bytes);
  hand_on(head);
  hand_on(std::as_bytes(std::span(&header, 1)));
  EXPECT_THAT(end_of_session(), HasSubstr("changed on its way"));
}

}  // namespace
}  // namespace understudy::compositor::testing
