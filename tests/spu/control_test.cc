// SPDX-License-Identifier: Apache-2.0
// What `understudy ctl` says to a viewer, and the viewer's end: whatever comes in, it goes on and serves
// others.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "compositor/transport/socket.h"
#include "spu/control/control_folder.h"
#include "spu/control/control_message.h"
#include "spu/control/control_server.h"

namespace understudy::spu {
namespace {

namespace fs = std::filesystem;
using compositor::FileDescriptor;
using ::testing::HasSubstr;

std::string refusal_of(std::string_view line) {
  try {
    control_request_in(line);
  } catch (const BadControlRequest& bad) {
    return bad.what();
  }
  return "";
}

TEST(ControlMessage, ARequestComesBackFromItsLine) {
  const std::vector<ControlRequest> requests{
      {.command = ControlCommand::status},
      {.command = ControlCommand::substitution, .on = true},
      {.command = ControlCommand::substitution, .on = false},
      {.command = ControlCommand::tint, .on = true},
      {.command = ControlCommand::budget, .error = "2/255"},
      {.command = ControlCommand::budget, .error = "none", .time = "30ms"}};
  for (const ControlRequest& request : requests) {
    const std::string line = line_of(request);
    EXPECT_EQ(line.find('\n'), line.size() - 1);
    EXPECT_EQ(control_request_in(line), request) << line;
  }
}

TEST(ControlMessage, WhatIsNoRequestIsRefusedWithAReason) {
  const std::array<std::array<std::string, 2>, 14> lines{{
      {"", "JSON"},
      {"[]", "JSON object"},
      {"\xff\xfe{", "JSON"},
      {std::string(3000, '['), "JSON"},
      {R"({"command":"status"})", "version"},
      {R"({"version":2,"command":"status"})", "version 1"},
      {R"({"version":"1","command":"status"})", "version"},
      {R"({"version":1})", "no command"},
      {R"({"version":1,"command":7})", "no command"},
      {R"({"version":1,"command":"exit"})", "unknown"},
      {R"({"version":1,"command":"substitution"})", "true or false"},
      {R"({"version":1,"command":"tint","on":"yes"})", "true or false"},
      {R"({"version":1,"command":"budget"})", "neither"},
      {R"({"version":1,"command":"budget","error":"-1"})", "--error"},
  }};
  for (const auto& [line, reason] : lines) EXPECT_THAT(refusal_of(line), HasSubstr(reason)) << line;
  EXPECT_THAT(refusal_of(R"({"version":1,"command":"budget","time":30})"), HasSubstr("--time"));
}

TEST(ControlMessage, AnswersAreOneLineWithTheVersion) {
  const std::string answer = control_answer({{"text", "two\nlines \xff"}});
  EXPECT_EQ(answer.find('\n'), answer.size() - 1);
  const auto json = nlohmann::json::parse(answer);
  EXPECT_EQ(json["version"], control_version);
  EXPECT_EQ(json["ok"], true);
  EXPECT_EQ(nlohmann::json::parse(control_refusal("no"))["error"], "no");
}

/// A folder of this test's own, removed at its end.
class Control : public ::testing::Test {
 protected:
  Control() {
    std::string name = (fs::temp_directory_path() / "understudy-control-test-XXXXXX").string();
    top_ = ::mkdtemp(name.data());
  }
  ~Control() override { fs::remove_all(top_); }

  fs::path folder() const { return top_ / "control"; }
  fs::path top_;
};

TEST_F(Control, TheFolderIsPrivate) {
  make_control_folder(folder());
  struct stat about {};
  ASSERT_EQ(::stat(folder().c_str(), &about), 0);
  EXPECT_EQ(about.st_mode & 07777, 0700U);
  EXPECT_NO_THROW(make_control_folder(folder())) << "exists already";
}

TEST_F(Control, AFolderThatOthersCanReadOrThatIsALinkIsRefused) {
  make_control_folder(folder());
  for (const mode_t mode : {0701U, 0710U, 0755U, 0777U, 01777U}) {
    ::chmod(folder().c_str(), mode);
    EXPECT_THROW(make_control_folder(folder()), std::runtime_error) << mode;
    EXPECT_THROW(control_sockets(folder()), std::runtime_error) << mode;
  }
  ::chmod(folder().c_str(), 0700);
  EXPECT_NO_THROW(require_control_folder(folder()));
  fs::create_directory_symlink(folder(), top_ / "link");
  EXPECT_THROW(make_control_folder(top_ / "link"), std::runtime_error);
  std::ofstream(top_ / "file") << "";
  EXPECT_THROW(make_control_folder(top_ / "file"), std::runtime_error);
  if (::geteuid() != 0) return;
  ASSERT_EQ(::chown(folder().c_str(), 65534, 65534), 0);
  EXPECT_THROW(make_control_folder(folder()), std::runtime_error);
}

TEST_F(Control, OnlySocketsOfTheDeadAreRemoved) {
  make_control_folder(folder());
  EXPECT_TRUE(control_sockets(top_ / "nothing").empty());
  const FileDescriptor living = compositor::listen_at(control_socket(folder(), 20));
  { const FileDescriptor dead = compositor::listen_at(control_socket(folder(), 3)); }
  std::ofstream(folder() / "notes.txt") << "";
  std::ofstream(folder() / "-7.sock") << "";
  ASSERT_EQ(control_sockets(folder()).size(), 2U);
  EXPECT_EQ(control_sockets(folder()).front().process, 3);
  remove_dead_control_sockets(folder());
  ASSERT_EQ(control_sockets(folder()).size(), 1U);
  EXPECT_EQ(control_sockets(folder()).front().process, 20);
  EXPECT_TRUE(fs::exists(folder() / "notes.txt"));
}

TEST_F(Control, AFolderWithoutSocketsGoes) {
  make_control_folder(folder());
  { const FileDescriptor dead = compositor::listen_at(control_socket(folder(), 3)); }
  remove_dead_control_sockets(folder());
  EXPECT_FALSE(fs::exists(folder()));
}

class ControlServerTest : public Control {
 protected:
  ControlServerTest() { make_control_folder(folder()); }

  fs::path socket() const { return control_socket(folder(), 1); }

  FileDescriptor connect() const {
    return compositor::connect_to(socket(), compositor::Clock::now() + std::chrono::seconds(60));
  }
  static void send(const FileDescriptor& to, std::string_view text) {
    EXPECT_EQ(::send(to.get(), text.data(), text.size(), MSG_NOSIGNAL), ssize_t(text.size()));
  }
  /// Until the end of a line, or of the connection.
  static std::string received(const FileDescriptor& from) {
    std::string text;
    for (char byte = 0; text.empty() || text.back() != '\n'; text += byte) {
      EXPECT_TRUE(compositor::wait_until_ready(from.get(), POLLIN,
                                               compositor::Clock::now() + std::chrono::seconds(60)));
      if (::recv(from.get(), &byte, 1, 0) <= 0) return text;
    }
    return text;
  }
  /// Answers with the length of the line.
  static std::string length(std::string_view line) { return std::to_string(line.size()) + "\n"; }
};

TEST_F(ControlServerTest, AnswersEveryLineOfAConnectionInTurn) {
  ControlServer server(socket(), length);
  const FileDescriptor client = connect();
  send(client, "abc\n\nhalf");
  EXPECT_EQ(received(client), "3\n");
  EXPECT_EQ(received(client), "0\n");
  send(client, " a line\n");
  EXPECT_EQ(received(client), "11\n");
}

TEST_F(ControlServerTest, ALineThatIsTooLongClosesItsConnectionAlone) {
  ControlServer server(socket(), length);
  const FileDescriptor other = connect();
  const FileDescriptor client = connect();
  send(client, std::string(max_control_request_bytes, 'x') + "\n");
  EXPECT_EQ(received(client), "");
  const FileDescriptor longest = connect();
  send(longest, std::string(max_control_request_bytes - 1, 'x') + "\n");
  EXPECT_EQ(received(longest), std::to_string(max_control_request_bytes - 1) + "\n");
  send(other, "a\n");
  EXPECT_EQ(received(other), "1\n");
}

TEST_F(ControlServerTest, AnAnswerThatFailsClosesItsConnectionAlone) {
  ControlServer server(socket(), [](std::string_view line) -> std::string {
    if (line == "fail") throw std::runtime_error("failed");
    return "fine\n";
  });
  const FileDescriptor client = connect();
  send(client, "fail\n");
  EXPECT_EQ(received(client), "");
  const FileDescriptor next = connect();
  send(next, "\n");
  EXPECT_EQ(received(next), "fine\n");
}

TEST_F(ControlServerTest, MoreConnectionsThanAllowedCloseTheOldest) {
  ControlServer server(socket(), length);
  std::vector<FileDescriptor> idle;
  for (std::size_t i = 0; i < 3 * max_control_connections; ++i) idle.push_back(connect());
  const FileDescriptor client = connect();
  send(client, "a\n");
  EXPECT_EQ(received(client), "1\n");
  send(idle.back(), "bc\n");
  EXPECT_EQ(received(idle.back()), "2\n");
  EXPECT_EQ(received(idle.front()), "");
}

TEST_F(ControlServerTest, AClientThatReadsNothingStopsNobody) {
  const std::string large(std::size_t(8) << 20U, 'x');
  ControlServer server(socket(),
                       [&](std::string_view line) { return line == "large" ? large + "\n" : "small\n"; });
  const FileDescriptor mute = connect();
  send(mute, "large\n");
  const FileDescriptor client = connect();
  send(client, "\n");
  EXPECT_EQ(received(client), "small\n");
}

TEST_F(ControlServerTest, StoppingRemovesTheSocketAndItsFolder) {
  ControlServer server(socket(), length);
  const FileDescriptor idle = connect();
  server.stop(std::chrono::seconds(60));
  EXPECT_FALSE(fs::exists(socket()));
  EXPECT_FALSE(fs::exists(folder()));
  EXPECT_EQ(received(idle), "");
}

TEST_F(ControlServerTest, AForkedChildDoesNotKeepItsParentsSocketAlive) {
  std::array<int, 2> hold{};
  std::array<int, 2> ready{};
  ASSERT_EQ(::pipe(hold.data()), 0);
  ASSERT_EQ(::pipe(ready.data()), 0);
  pid_t child = 0;
  char byte = 0;
  {
    ControlServer server(socket(), length);
    child = ::fork();
    if (child == 0) {
      server.leave_to_parent();
      ::close(hold[1]);
      (void)!::write(ready[1], &byte, 1);
      (void)!::read(hold[0], &byte, 1);
      ::_exit(0);
    }
    EXPECT_EQ(::read(ready[0], &byte, 1), 1);
    // As a process that is killed leaves it.
    fs::create_hard_link(socket(), control_socket(folder(), 2));
  }
  EXPECT_EQ(compositor::attempt_to_connect(control_socket(folder(), 2)).error, ECONNREFUSED);
  for (const int end : {hold[0], hold[1], ready[0], ready[1]}) ::close(end);
  ::waitpid(child, nullptr, 0);
}

}  // namespace
}  // namespace understudy::spu
