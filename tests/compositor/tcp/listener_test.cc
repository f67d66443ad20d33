// SPDX-License-Identifier: Apache-2.0
// The listener with clients that are not accepted: they disturb no accepted client, and leave nothing behind.
#include "compositor/transport/tcp/listener.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>

#include <atomic>
#include <mutex>
#include <thread>

#include "compositor/service/service_protocols.h"
#include "compositor/transport/tcp/tcp_connection.h"
#include "compositor/transport/tcp/tcp_socket.h"
#include "tests/compositor/scratch_folder.h"
#include "tests/compositor/tcp/session.h"

namespace understudy::compositor {
namespace {

using testing::eventually;
using ::testing::HasSubstr;
using testing::open_descriptors;
using testing::secret_of;

Deadline soon() {
  return Clock::now() + std::chrono::seconds(20);
}

/// A listener that is stepped on a thread; accepted clients are kept.
class ListenerTest : public ::testing::Test {
 protected:
  void open(const ListenerLimits& limits = {std::chrono::milliseconds(1000), 64}) {
    listener_.emplace(
        TcpAddress{"127.0.0.1", 0}, secret_, [this](const ConnectionRequest&) { return verdict_.load(); },
        [this](AuthenticatedSocket client, const ConnectionRequest& connection_request) {
          if (forgets_) listener_->forget();
          accepted_.push_back(std::move(client));
          last_wishes_ = connection_request;
        },
        [this](const std::string& line) { said_.push_back(line); }, limits);
    address_ = listener_->address();
    thread_ = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        std::vector<pollfd> fds;
        listener_->poll_fds(fds);
        ::poll(fds.data(), fds.size(), 1);
        const std::scoped_lock lock(mutex_);
        listener_->step();
      }
    });
  }
  template <class Ask>
  auto ask(Ask ask) {
    const std::scoped_lock lock(mutex_);
    return ask();
  }
  std::size_t accepted() {
    return ask([&] { return accepted_.size(); });
  }
  std::string said() {
    return ask([&] {
      std::string all;
      for (const std::string& line : said_) all += line + "\n";
      return all;
    });
  }
  FileDescriptor pending() { return connect_to(address_, soon()); }
  static bool is_closed(const FileDescriptor& socket) {
    char byte = 0;
    return wait_until_ready(socket.get(), POLLIN, soon()) && ::recv(socket.get(), &byte, 1, 0) <= 0;
  }

  const Credentials secret_ = secret_of("sixteen bytes or more");
  std::atomic<AdmissionVerdict> verdict_ = AdmissionVerdict::accepted;
  std::mutex mutex_;
  std::vector<AuthenticatedSocket> accepted_;
  bool forgets_ = false;  ///< as the process of a client does
  ConnectionRequest last_wishes_;
  std::vector<std::string> said_;
  std::optional<Listener> listener_;
  TcpAddress address_;
  std::jthread thread_;
};

TEST_F(ListenerTest, AClientWithTheSecretIsLetInWithItsWishes) {
  open();
  AuthenticatedSocket socket =
      connect_tcp(address_, secret_, {Destination::gl_server, Layout::rgba16f, 50, false}, soon());
  ASSERT_TRUE(eventually([&] { return accepted() == 1; }));
  EXPECT_EQ(last_wishes_.to, Destination::gl_server);
  EXPECT_EQ(last_wishes_.pixels, Layout::rgba16f);
  // Both ends are a connection now.
  TcpConnection here(std::move(socket), service_protocols, 1 << 20);
  TcpConnection there(std::move(accepted_.front()), service_protocols, 1 << 20);
  const std::vector<std::byte> words(300'000, std::byte(7));
  const Bytes payload(words);
  std::jthread sender([&] { here.send(NodeMessage::add_texels, 9, {&payload, 1}); });
  const Message message = there.receive();
  EXPECT_EQ(message.sequence, 9U);
  EXPECT_EQ(message.payload, words);
  EXPECT_EQ(said(), "");
}

TEST_F(ListenerTest, WhoOnlyAsksIsToldAndGoes) {
  open();
  ConnectionRequest connection_request;
  connection_request.only_asks = true;
  EXPECT_NO_THROW(connect_tcp(address_, secret_, connection_request, soon()));
  EXPECT_EQ(accepted(), 0U);
  const auto refusal = [&](AdmissionVerdict verdict) {
    verdict_ = verdict;
    try {
      connect_tcp(address_, secret_, connection_request, soon());
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(refusal(AdmissionVerdict::too_many), HasSubstr("try again later"));
  EXPECT_THAT(refusal(AdmissionVerdict::not_offered), HasSubstr("--gl-server"));
}

TEST_F(ListenerTest, NoEncryptionIsAWishThatBothEndsMustHave) {
  open();
  ConnectionRequest connection_request;
  connection_request.plain = true;
  AuthenticatedSocket socket = connect_tcp(address_, secret_, connection_request, soon());
  EXPECT_FALSE(socket.keys.has_value());
  ASSERT_TRUE(eventually([&] { return accepted() == 1; }));
  EXPECT_FALSE(accepted_.front().keys.has_value());
  verdict_ = AdmissionVerdict::not_plain;
  EXPECT_THROW(connect_tcp(address_, secret_, connection_request, soon()), std::runtime_error);
  EXPECT_EQ(accepted(), 1U);
}

TEST_F(ListenerTest, AWrongSecretIsSaidOnBothSides) {
  open();
  const Credentials other = secret_of("what somebody made up");
  try {
    connect_tcp(address_, other, {}, soon());
    ADD_FAILURE() << "was let in";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("copy its --secret-file"));
    EXPECT_THAT(error.what(), HasSubstr(address_.text()));
  }
  EXPECT_TRUE(eventually([&] { return said().find("127.0.0.1:") != std::string::npos; }));
  EXPECT_THAT(said(), HasSubstr("--secret-file"));
  EXPECT_EQ(accepted(), 0U);
}

TEST_F(ListenerTest, GarbageTruncationAndSilenceEndInBoundedTime) {
  open({std::chrono::milliseconds(300), 64});
  const auto says = [&](const std::vector<std::byte>& words) {
    FileDescriptor socket = pending();
    EXPECT_EQ(::send(socket.get(), words.data(), words.size(), MSG_NOSIGNAL), ssize_t(words.size()));
    return socket;
  };
  const FileDescriptor silent = pending();
  const FileDescriptor garbage = says(std::vector<std::byte>(5000, std::byte('G')));
  ClientHandshake handshake(secret_, {});
  std::vector<std::byte> half = handshake.hello();
  half.resize(20);
  const FileDescriptor truncated = says(half);
  EXPECT_TRUE(is_closed(garbage));
  EXPECT_TRUE(is_closed(truncated));
  EXPECT_TRUE(is_closed(silent));
  EXPECT_TRUE(eventually([&] { return ask([&] { return listener_->pending_clients() == 0; }); }));
  EXPECT_EQ(accepted(), 0U);
}

TEST_F(ListenerTest, AProcessForAClientKeepsNoPendingClient) {
  forgets_ = true;
  open({std::chrono::minutes(10), 64});
  const FileDescriptor before = pending();
  ASSERT_TRUE(eventually([&] { return ask([&] { return listener_->pending_clients(); }) == 1; }));
  const AuthenticatedSocket client = connect_tcp(address_, secret_, {}, soon());
  ASSERT_TRUE(eventually([&] { return accepted() == 1; }));
  EXPECT_TRUE(is_closed(before));
}

TEST_F(ListenerTest, AServerThatIsNoneIsSaidToBeNone) {
  const FileDescriptor listener = listen_at(TcpAddress{"127.0.0.1", 0});
  const TcpAddress address = own_address(listener.get());
  const auto failure = [&](Deadline until) {
    try {
      connect_tcp(address, secret_, {}, until);
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(failure(Clock::now() + std::chrono::milliseconds(200)), HasSubstr("it says nothing"));
  std::jthread garbage([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      const FileDescriptor peer(::accept4(listener.get(), nullptr, nullptr, SOCK_CLOEXEC));
      const std::string words(200, 'H');
      if (peer) ::send(peer.get(), words.data(), words.size(), MSG_NOSIGNAL);
      if (peer) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  });
  EXPECT_THAT(failure(soon()), HasSubstr("look at host and port"));
}

TEST_F(ListenerTest, NobodyListensIsSaid) {
  TcpAddress address;
  {
    const FileDescriptor listener = listen_at(TcpAddress{"127.0.0.1", 0});
    address = own_address(listener.get());
  }
  EXPECT_THROW(connect_tcp(address, secret_, {}, soon()), std::runtime_error);
  EXPECT_THROW(connect_tcp({"no-such-host.invalid", 1}, secret_, {}, soon()), std::runtime_error);
}

TEST_F(ListenerTest, AThousandUnauthenticatedClientsDisturbNoClientAndLeaveNothing) {
  open({std::chrono::milliseconds(2000), 64});
  const auto before = open_descriptors();
  {
    std::vector<FileDescriptor> crowd;
    std::jthread flood([&] {
      const std::vector<std::byte> garbage(100, std::byte('x'));
      const ClientHandshake handshake(secret_, {});
      for (int i = 0; i < 1000; ++i) {
        FileDescriptor socket = pending();
        // Some send nothing, some garbage, some begin correctly and never finish.
        if (i % 3 == 1) ::send(socket.get(), garbage.data(), garbage.size(), MSG_NOSIGNAL);
        if (i % 3 == 2) ::send(socket.get(), handshake.hello().data(), hello_bytes, MSG_NOSIGNAL);
        crowd.push_back(std::move(socket));
      }
    });
    ConnectionRequest asking;
    asking.only_asks = true;
    for (int i = 0; i < 50; ++i) EXPECT_NO_THROW(connect_tcp(address_, secret_, asking, soon())) << i;
    const AuthenticatedSocket client = connect_tcp(address_, secret_, {}, soon());
    EXPECT_TRUE(eventually([&] { return accepted() == 1; }));
    flood.join();
    EXPECT_LE(ask([&] { return listener_->pending_clients(); }), 64U);
    EXPECT_NO_THROW(connect_tcp(address_, secret_, asking, soon()));
    EXPECT_LT(ask([&] { return said_.size(); }), 20U) << "a line for each of them helps nobody";
  }
  EXPECT_TRUE(eventually([&] { return ask([&] { return listener_->pending_clients() == 0; }); }));
  ask([&] { accepted_.clear(); });
  EXPECT_EQ(open_descriptors(), before);
}

}  // namespace
}  // namespace understudy::compositor
