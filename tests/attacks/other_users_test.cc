// SPDX-License-Identifier: Apache-2.0
// Other users of this machine: a foreign listener at the nodes' socket receives nothing, foreign clients are
// not served, and files that others could change are not trusted.
#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>

#include "compositor/service/broker.h"
#include "compositor/service/service_protocols.h"
#include "compositor/transport/peer.h"
#include "compositor/transport/runtime_folder.h"
#include "compositor/transport/tcp/secret.h"
#include "tests/attacks/other_user.h"
#include "tests/attacks/small_viewer.h"
#include "tests/clients/command_test.h"

namespace attacks {
namespace {

namespace fs = std::filesystem;
using namespace understudy::compositor;
using clients::Outcome;
using clients::operator+;
using ::testing::HasSubstr;

Deadline soon() {
  return Clock::now() + std::chrono::seconds(20);
}

class OtherUsers : public clients::CommandTest {
 protected:
  OtherUsers() {
    // All users can access this folder, like /tmp.
    fs::permissions(file(""), fs::perms::owner_all | fs::perms::group_exec | fs::perms::others_exec);
    fs::create_directory(shared());
    ::chmod(shared().c_str(), 01777);
  }
  fs::path shared() const { return file("shared"); }
  std::string socket() const { return shared() / "nodes.sock"; }
};

/// Listens for one client; returns the number of bytes received, at most 200, or 201 without a client.
int bytes_received_at(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::copy_n(path.data(), std::min(path.size(), sizeof address.sun_path - 1), address.sun_path);
  const FileDescriptor listener(::socket(AF_UNIX, SOCK_STREAM, 0));
  ::bind(listener.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address);
  ::chmod(path.c_str(), 0777);
  ::listen(listener.get(), 5);
  if (!wait_until_ready(listener.get(), POLLIN, Clock::now() + std::chrono::seconds(60))) return 201;
  const FileDescriptor client(::accept(listener.get(), nullptr, nullptr));
  std::array<char, 4096> bytes{};
  int received = 0;
  for (ssize_t got = 1; got > 0 && received < 200;) {
    got = ::recv(client.get(), bytes.data(), bytes.size(), 0);
    received += int(std::max<ssize_t>(got, 0));
  }
  return std::min(received, 200);
}

TEST_F(OtherUsers, AListenerMustBeOfTheUserThatIsExpected) {
  const FileDescriptor listener = listen_at(socket());
  const FileDescriptor client = connect_to(socket(), soon());
  EXPECT_EQ(peer_user(client.get()), ::geteuid());
  EXPECT_NO_THROW(require_listener_of(::geteuid(), client.get(), socket()));
  EXPECT_THROW(require_listener_of(::geteuid() + 1, client.get(), socket()), ForeignListener);
}

TEST_F(OtherUsers, WhoListensWhereNodesAreExpectedGetsNothingAndTheSummarySaysSo) {
  if (!can_be_another_user()) GTEST_SKIP() << "needs root, to be another user";
  OtherUser listener([this] { return bytes_received_at(socket()); });
  ASSERT_TRUE(clients::comes_true([this] { return fs::exists(socket()); }));
  const Outcome outcome = run_well(clients::under({"--connect", socket()}) + small_viewer(file("volume.raw")));
  EXPECT_EQ(listener.finish(), 0);
  EXPECT_THAT(outcome.err, HasSubstr(fmt::format("user {} listens at '{}'", other_user_id, socket())));
  EXPECT_THAT(outcome.err, HasSubstr("another user listens where the render nodes should"));
}

TEST_F(OtherUsers, WhoConnectsIsNotServed) {
  if (!can_be_another_user()) GTEST_SKIP() << "needs root, to be another user";
  Broker broker({socket(), file("nodes.sock")}, [](const std::string&) {});
  ::chmod(socket().c_str(), 0777);
  OtherUser client([this] {
    const FileDescriptor connection(::socket(AF_UNIX, SOCK_STREAM, 0));
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::copy_n(socket().data(), socket().size(), address.sun_path);
    if (::connect(connection.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) return 2;
    char byte = 0;
    return ::recv(connection.get(), &byte, 1, 0) <= 0 ? 0 : 1;
  });
  const auto served = connect_to(socket(), soon());
  Connection own(FileDescriptor(::dup(served.get())), service_protocols);
  own.send(LauncherMessage::hello_client, 1, Bytes{}, soon());
  ASSERT_TRUE(clients::comes_true([&] {
    broker.step(std::chrono::milliseconds(5));
    return broker.clients_waiting() == 1;
  }));
  // The other client may have connected after this one.
  for (int i = 0; i < 20; ++i) broker.step(std::chrono::milliseconds(5));
  EXPECT_EQ(client.finish(), 0);
  EXPECT_EQ(broker.clients_waiting(), 1U);
}

TEST_F(OtherUsers, AFolderThatOthersMayWriteIntoIsNoRuntimeFolder) {
  EXPECT_FALSE(is_private_folder(shared()));
  EXPECT_FALSE(is_private_folder("/tmp"));
  EXPECT_FALSE(is_private_folder(file("nothing")));
  fs::create_directory(file("own"));
  ::chmod(file("own").c_str(), 0700);
  EXPECT_TRUE(is_private_folder(file("own")));
  if (!can_be_another_user()) GTEST_SKIP() << "the rest needs root, to be another user";
  ASSERT_EQ(::chown(file("own").c_str(), other_user_id, other_user_id), 0);
  EXPECT_FALSE(is_private_folder(file("own")));
}

TEST_F(OtherUsers, ASecretThatAnotherUserCanChangeIsNone) {
  if (!can_be_another_user()) GTEST_SKIP() << "needs root, to be another user";
  bool made = false;
  const std::string secret = file("secret").string();
  read_or_make_secret(secret, made);
  EXPECT_TRUE(made);
  ASSERT_EQ(::chown(secret.c_str(), other_user_id, other_user_id), 0);
  try {
    read_secret(secret);
    ADD_FAILURE() << "believed";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("use a copy of your own"));
  }
}

}  // namespace
}  // namespace attacks
