// SPDX-License-Identifier: Apache-2.0
// Nodes that read volumes themselves: ranks are threads, sockets and files are real.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "compositor/exchange/thread_communicator.h"
#include "compositor/node/node.h"
#include "compositor/service/loading_service.h"
#include "compositor/service/remote_service.h"
#include "tests/compositor/group_scene.h"
#include "tests/compositor/scratch_folder.h"

namespace understudy::compositor::testing {

class LoadingGroup : public ::testing::Test {
 protected:
  void TearDown() override {
    // First: the launcher's group then ends, and is joined.
    launcher_.reset();
    group_ = {};
  }

  /// Connects to a group of `ranks` ranks; 0: a service in this process.
  std::unique_ptr<LoadingService> service(int ranks, const SortSettings& sort = {}) {
    if (ranks == 0) return embedded_loading_service();
    group_ = std::jthread([this, ranks, sort] {
      run_ranks(ranks, [&](Communicator& communicator) {
        run_node(communicator, socket_of_nodes(path_), {.sort = sort});
      });
    });
    EXPECT_TRUE(launcher_->wait_for_group());
    return remote_loading_service(path_, {});
  }
  void dismiss() {
    launcher_->ask([](Broker& broker) { broker.dismiss_node_group(); });
    if (group_.joinable()) group_.join();
  }

  std::string write(const std::string& name, std::span<const std::byte> bytes) const {
    std::string path = folder_ / name.c_str();
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
    return path;
  }

  ScratchFolder folder_;
  std::string path_ = folder_ / "control";
  std::unique_ptr<Launcher> launcher_ = std::make_unique<Launcher>(path_);
  std::jthread group_;
};

inline const char* name_of(volume::TexelType type) {
  return type == volume::TexelType::u8 ? "u8" : type == volume::TexelType::u16 ? "u16" : "f32";
}

inline std::vector<RankLoad> load(LoadingService& service, const LoadRequest& request) {
  std::vector<RankLoad> ranks = service.begin_load(request);
  while (!std::ranges::all_of(ranks, &RankLoad::done)) {
    const std::vector<RankLoad> before = ranks;
    ranks = service.continue_load(request.volume.id);
    for (std::size_t i = 0; i < ranks.size(); ++i) {
      EXPECT_GE(ranks[i].texels_done, before[i].texels_done);
      EXPECT_TRUE(before[i].done() || ranks[i].texels_done > before[i].texels_done) << "every step gets on";
    }
  }
  return ranks;
}

}  // namespace understudy::compositor::testing
