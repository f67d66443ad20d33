// SPDX-License-Identifier: Apache-2.0
// Files that Understudy did not create are not removed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <iterator>

#include "apps/understudy/launch/run_folder.h"
#include "compositor/transport/socket.h"
#include "compositor/transport/socket_file.h"
#include "tests/clients/command_test.h"

namespace attacks {
namespace {

namespace fs = std::filesystem;
using namespace understudy::compositor;
using ::testing::HasSubstr;
using understudy::launcher::RunFolder;

using OwnFiles = clients::CommandTest;

void put(const fs::path& file) {
  std::ofstream(file) << "precious";
}

TEST_F(OwnFiles, ListeningTouchesNothingButItsSocket) {
  put(file("nodes.sock~"));
  const auto files = [this] { return std::distance(fs::directory_iterator(file("")), {}); };
  const auto before = files();
  {
    const FileDescriptor listener = listen_at(file("nodes.sock"));
    const SocketFile socket(file("nodes.sock"));
    EXPECT_EQ(files(), before + 1);
  }
  EXPECT_EQ(files(), before);
  EXPECT_EQ(clients::contents(file("nodes.sock~")), "precious");
}

TEST_F(OwnFiles, WhatTookTheSocketsPlaceStays) {
  {
    const FileDescriptor listener = listen_at(file("nodes.sock"));
    const SocketFile socket(file("nodes.sock"));
    fs::remove(file("nodes.sock"));
    put(file("nodes.sock"));
  }
  EXPECT_EQ(clients::contents(file("nodes.sock")), "precious");
}

TEST_F(OwnFiles, AFolderThatHoldsSomethingIsNotTakenOver) {
  fs::create_directory(file("home"));
  ::chmod(file("home").c_str(), 0700);
  put(file("home") / "letter");
  const clients::Outcome outcome =
      run({(clients::programs / "understudy").string(), "serve", "-n", "1", "--folder", file("home").string()});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, HasSubstr("it must be empty, yours"));
  EXPECT_EQ(clients::contents(file("home") / "letter"), "precious");
  fs::remove(file("home") / "letter");
  ::chmod(file("home").c_str(), 0755);
  EXPECT_THROW(RunFolder(file("home")), std::runtime_error);
  ::chmod(file("home").c_str(), 0700);
  { const RunFolder folder(file("home")); }
  EXPECT_FALSE(fs::exists(file("home")));
}

}  // namespace
}  // namespace attacks
