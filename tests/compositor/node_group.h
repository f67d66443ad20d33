// SPDX-License-Identifier: Apache-2.0
// A whole node group in one process, for tests: ranks are threads, sockets are real.
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "compositor/exchange/thread_communicator.h"
#include "compositor/node/node.h"
#include "compositor/service/remote_service.h"
#include "compositor/service/service_protocols.h"
#include "compositor/transport/connection.h"
#include "tests/compositor/group_scene.h"

namespace understudy::compositor::testing {

using std::chrono::milliseconds;

inline Deadline soon() {
  return Clock::now() + std::chrono::seconds(20);
}

/// So that what is sent does not depend on measured times.
constexpr ExchangeSettings drawn_first{.overlap = Overlap::off, .packed = false};

// Ranks on threads, which end when the launcher closes its connection.
class Group {
 public:
  using Wrap = std::function<void(Communicator&, const std::function<void(Communicator&)>&)>;

  Group(int ranks, const std::string& path, milliseconds stall_patience = limits::stall_patience,
        Wrap wrap = {}, ExchangeSettings exchange = drawn_first, SortSettings sort = {})
      : thread_([=, this] {
          try {
            run_ranks(ranks, [&](Communicator& communicator) {
              const auto run = [&](Communicator& l) {
                run_node(l, path, {.stall_patience = stall_patience, .exchange = exchange, .sort = sort});
              };
              wrap ? wrap(communicator, run) : run(communicator);
            });
          } catch (const std::exception& error) {
            std::printf("node group: %s\n", error.what());
          }
          ended_ = true;
        }) {}
  bool ended() const { return ended_; }

 private:
  std::atomic<bool> ended_ = false;
  std::jthread thread_;
};

class NodeGroupTest : public ::testing::Test {
 protected:
  void TearDown() override {
    // First: the launcher's groups then end, and are joined.
    launcher_.reset();
    groups_.clear();
  }

  Group& start(int ranks, milliseconds stall_patience = limits::stall_patience, const Group::Wrap& wrap = {},
               const ExchangeSettings& exchange = drawn_first, const SortSettings& sort = {}) {
    groups_.push_back(
        std::make_unique<Group>(ranks, socket_of_nodes(path_), stall_patience, wrap, exchange, sort));
    EXPECT_TRUE(launcher_->wait_for_group());
    return *groups_.back();
  }
  std::unique_ptr<RenderService> connect() { return remote_render_service(path_, 20'000); }
  // An application that speaks the protocol, but need not obey it.
  std::unique_ptr<Connection> raw_client() {
    auto result = std::make_unique<Connection>(connect_to(path_, soon()), service_protocols);
    result->send(LauncherMessage::hello_client, 1, Bytes{}, soon());
    EXPECT_EQ(result->receive(soon()).type, LauncherMessage::accepted);
    return result;
  }

  ScratchFolder folder_;
  std::string path_ = folder_ / "control";
  std::unique_ptr<Launcher> launcher_ = std::make_unique<Launcher>(path_);
  std::vector<std::unique_ptr<Group>> groups_;
};

}  // namespace understudy::compositor::testing
