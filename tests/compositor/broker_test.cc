// SPDX-License-Identifier: Apache-2.0
#include "compositor/service/broker.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>

#include <fstream>
#include <memory>
#include <vector>

#include "compositor/service/service_protocols.h"
#include "tests/compositor/scratch_folder.h"

namespace understudy::compositor {
namespace {

using testing::eventually;
using ::testing::HasSubstr;
using testing::open_descriptors;
using testing::ScratchFolder;

Deadline soon() {
  return Clock::now() + std::chrono::seconds(20);
}

// A broker that the test steps, with peers in the same thread.
class BrokerTest : public ::testing::Test {
 protected:
  std::unique_ptr<Connection> connect() { return connect(path_); }
  static std::unique_ptr<Connection> connect(const std::string& path) {
    return std::make_unique<Connection>(connect_to(path, soon()), service_protocols);
  }
  std::unique_ptr<Connection> client() {
    auto result = connect();
    result->send(LauncherMessage::hello_client, 1, Bytes{}, soon());
    return result;
  }
  std::unique_ptr<Connection> nodes(int ranks = 4) {
    auto result = connect(sockets_.nodes);
    result->send(LauncherMessage::hello_nodes, 1, encode(Hello{ranks}), soon());
    return result;
  }
  void step() {
    for (int i = 0; i < 5; ++i) broker_->step(std::chrono::milliseconds(0));
  }
  // Receives what the launcher sends to a node group: the descriptor of an application.
  static FileDescriptor handed_over(Connection& nodes) {
    Message message = nodes.receive(soon());
    EXPECT_EQ(message.type, LauncherMessage::client);
    EXPECT_TRUE(message.attached);
    return std::move(message.attached);
  }

  ScratchFolder folder_;
  BrokerSockets sockets_{folder_ / "control", folder_ / "nodes"};
  const std::string& path_ = sockets_.applications;
  std::vector<std::string> said_;
  std::unique_ptr<Broker> broker_ = std::make_unique<Broker>(
      sockets_, [this](const std::string& line) { said_.push_back(line); },
      BrokerPatience{std::chrono::milliseconds(300)});
};

TEST_F(BrokerTest, ItsSocketsArePrivateAndGoWithIt) {
  struct stat file {};
  for (const std::string& path : {sockets_.applications, sockets_.nodes}) {
    ASSERT_EQ(::stat(path.c_str(), &file), 0);
    EXPECT_EQ(file.st_mode & 07777, 0600U);
    EXPECT_TRUE(S_ISSOCK(file.st_mode));
  }
  broker_.reset();
  EXPECT_NE(::stat(sockets_.applications.c_str(), &file), 0);
  EXPECT_NE(::stat(sockets_.nodes.c_str(), &file), 0);
}

TEST_F(BrokerTest, AnApplicationCannotPoseAsTheNodes) {
  const auto application = client();
  const auto impostor = connect();
  impostor->send(LauncherMessage::hello_nodes, 1, encode(Hello{4}), soon());
  step();
  EXPECT_FALSE(broker_->node_group_ready());
  EXPECT_EQ(broker_->clients_waiting(), 1U);
  EXPECT_THROW(impostor->receive(soon()), ConnectionLost);
  ASSERT_EQ(said_.size(), 1U);
  EXPECT_THAT(said_.front(), HasSubstr("wants to be the nodes"));
  const auto group = nodes(7);
  step();
  EXPECT_EQ(broker_->ranks(), 7);
}

TEST_F(BrokerTest, ASecondLauncherAtTheSamePathIsRefusedAndDoesNoHarm) {
  try {
    Broker second(sockets_);
    ADD_FAILURE() << "both listen";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("in use by another launcher"));
  }
  EXPECT_NO_THROW(connect());
}

TEST_F(BrokerTest, ASocketFileLeftByADeadLauncherIsReplaced) {
  broker_.reset();
  const std::string copy = folder_ / "left";
  { const FileDescriptor dead = listen_at(copy); }  // closed, but the file stays
  ASSERT_TRUE(std::filesystem::exists(copy));
  EXPECT_NO_THROW((Broker{{copy, sockets_.nodes}}));
}

TEST_F(BrokerTest, AFileThatIsNoSocketIsLeftAlone) {
  const std::string file = folder_ / "file";
  std::ofstream(file) << "precious";
  EXPECT_THROW((Broker{{file, folder_ / "others"}}), std::runtime_error);
  EXPECT_EQ(std::filesystem::file_size(file), 8U);
}

TEST_F(BrokerTest, ImpossiblePathsAreNamed) {
  EXPECT_THROW((Broker{{std::string(200, 'x'), folder_ / "others"}}), std::runtime_error);
  EXPECT_THROW((Broker{{"", folder_ / "others"}}), std::runtime_error);
  try {
    Broker nowhere({"/nowhere/at/all", folder_ / "others"});
    ADD_FAILURE();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("/nowhere/at/all"));
  }
}

TEST_F(BrokerTest, HoldsApplicationsUntilANodeGroupIsThereAndHandsThemOver) {
  const auto first = client(), second = client();
  step();
  EXPECT_EQ(broker_->clients_waiting(), 2U);
  EXPECT_FALSE(broker_->node_group_ready());
  const auto group = nodes(7);
  step();
  EXPECT_TRUE(broker_->node_group_ready());
  EXPECT_EQ(broker_->ranks(), 7);
  EXPECT_EQ(broker_->clients_waiting(), 0U);
  EXPECT_EQ(broker_->clients_handed_over(), 2U);
  // From now on the two communicate without the broker.
  Connection served(handed_over(*group), service_protocols);
  served.send(LauncherMessage::accepted, 1, encode(Hello{7}), soon());
  EXPECT_EQ(decode_hello(first->receive(soon()).payload).ranks, 7);
}

TEST_F(BrokerTest, AnApplicationThatComesLaterIsHandedOverAtOnce) {
  const auto group = nodes();
  step();
  const auto late = client();
  step();
  EXPECT_TRUE(handed_over(*group));
}

TEST_F(BrokerTest, NoticesALostNodeGroupAndHoldsApplicationsForTheNext) {
  auto group = nodes();
  step();
  EXPECT_FALSE(broker_->lost());
  group.reset();
  step();
  EXPECT_TRUE(broker_->lost());
  EXPECT_FALSE(broker_->node_group_ready());
  EXPECT_EQ(said_.size(), 1U);
  const auto waiting = client();
  step();
  EXPECT_EQ(broker_->clients_waiting(), 1U);
  const auto next = nodes();
  step();
  EXPECT_FALSE(broker_->lost());
  EXPECT_TRUE(handed_over(*next));
}

TEST_F(BrokerTest, DismissingAGroupEndsItsConnectionAndIsNoLoss) {
  const auto group = nodes();
  step();
  broker_->dismiss_node_group();
  EXPECT_FALSE(broker_->node_group_ready());
  EXPECT_FALSE(broker_->lost());
  EXPECT_THROW(group->receive(soon()), ConnectionLost);
}

TEST_F(BrokerTest, ASecondGroupIsSentAway) {
  const auto group = nodes(3), second = nodes(5);
  step();
  EXPECT_EQ(broker_->ranks(), 3);
  EXPECT_THROW(second->receive(soon()), ConnectionLost);
  ASSERT_EQ(said_.size(), 1U);
  EXPECT_THAT(said_[0], HasSubstr("second node group"));
}

TEST_F(BrokerTest, GarbageIsDroppedWithOneLineAndDisturbsNobody) {
  const auto rude = connect();
  const std::string garbage = "GET / HTTP/1.1\r\nHost: understudy\r\n\r\n";
  ASSERT_GT(::send(rude->fd(), garbage.data(), garbage.size(), MSG_NOSIGNAL), 0);
  const auto polite = client();
  step();
  EXPECT_EQ(broker_->clients_waiting(), 1U);
  ASSERT_EQ(said_.size(), 1U);
  EXPECT_THAT(said_[0], HasSubstr("not a message of Understudy"));
}

TEST_F(BrokerTest, AHelloThatPromisesAHugePayloadIsDropped) {
  const auto rude = connect();
  MessageHeader header{.type = LauncherMessage::hello_client};
  header.payload_bytes = std::uint64_t(1) << 60;
  ASSERT_GT(::send(rude->fd(), &header, sizeof header, MSG_NOSIGNAL), 0);
  step();
  EXPECT_THROW(rude->receive(soon()), ConnectionLost);
  EXPECT_EQ(said_.size(), 1U);
}

TEST_F(BrokerTest, ARequestInsteadOfAHelloIsDropped) {
  const auto rude = connect();
  rude->send(NodeMessage::end_volume, 1, encode_id(1), soon());
  step();
  EXPECT_THROW(rude->receive(soon()), ConnectionLost);
}

TEST_F(BrokerTest, AProbeThatConnectsAndLeavesIsNotSpokenOf) {
  connect().reset();
  step();
  EXPECT_TRUE(said_.empty()) << said_[0];
}

TEST_F(BrokerTest, APendingClientWhoLeavesInTheMidstOfAWordIsSpokenOf) {
  const auto pending = connect();
  ASSERT_EQ(::send(pending->fd(), "U", 1, MSG_NOSIGNAL), 1);
  step();
  ASSERT_EQ(::shutdown(pending->fd(), SHUT_RDWR), 0);
  step();
  ASSERT_EQ(said_.size(), 1U);
  EXPECT_THAT(said_[0], HasSubstr("closed the connection"));
}

TEST_F(BrokerTest, APendingClientWhoSaysNothingIsDroppedInTheEndAndHoldsUpNobody) {
  const auto silent = connect();
  MessageHeader header{.type = LauncherMessage::hello_client};
  const auto half = connect();
  ASSERT_GT(::send(half->fd(), &header, sizeof header / 2, MSG_NOSIGNAL), 0);
  const auto polite = client();
  step();
  EXPECT_EQ(broker_->clients_waiting(), 1U);
  EXPECT_TRUE(eventually([&] {
    broker_->step(std::chrono::milliseconds(10));
    return said_.size() == 2;
  }));
  EXPECT_EQ(broker_->clients_waiting(), 1U);
}

TEST_F(BrokerTest, AnApplicationThatLeavesWhileItWaitsIsForgotten) {
  auto leaving = client();
  step();
  leaving.reset();
  step();
  EXPECT_EQ(broker_->clients_waiting(), 0U);
  EXPECT_TRUE(said_.empty());  // this is no error
}

TEST_F(BrokerTest, TurnsApplicationsAwayWithTheReasonUntilAGroupComes) {
  const auto before = client();
  step();
  broker_->turn_away("MPI is not installed");
  const auto after = client();
  step();
  for (const auto& each : {before.get(), after.get()}) {
    const Message message = each->receive(soon());
    EXPECT_EQ(message.type, LauncherMessage::refused);
    EXPECT_EQ(decode_text(message.payload), "MPI is not installed");
  }
  const auto group = nodes();
  const auto late = client();
  step();
  EXPECT_TRUE(handed_over(*group));
}

TEST_F(BrokerTest, WaitingApplicationsAreBounded) {
  std::vector<std::unique_ptr<Connection>> crowd;
  for (std::size_t i = 0; i < limits::max_clients + 1; ++i) {
    crowd.push_back(client());
    step();
  }
  EXPECT_EQ(broker_->clients_waiting(), limits::max_clients);
  EXPECT_EQ(crowd.back()->receive(soon()).type, LauncherMessage::refused);
}

TEST(Broker, LeavesNoDescriptorBehind) {
  const auto before = open_descriptors();
  {
    const ScratchFolder folder;
    const std::string path = folder / "control";
    const std::string path_of_nodes = folder / "nodes";
    Broker broker({path, path_of_nodes}, [](const std::string&) {});
    Connection nodes(connect_to(path_of_nodes, soon()), service_protocols);
    nodes.send(LauncherMessage::hello_nodes, 1, encode(Hello{1}), soon());
    std::vector<Connection> clients;
    for (int i = 0; i < 5; ++i) {
      clients.emplace_back(connect_to(path, soon()), service_protocols);
      clients.back().send(LauncherMessage::hello_client, 1, Bytes{}, soon());
      broker.step(std::chrono::milliseconds(0));
    }
    broker.step(std::chrono::milliseconds(0));
    EXPECT_EQ(broker.clients_handed_over(), 5U);
  }
  EXPECT_EQ(open_descriptors(), before);
}

}  // namespace
}  // namespace understudy::compositor
