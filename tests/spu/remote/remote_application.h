// SPDX-License-Identifier: Apache-2.0
// An application with one window, whose calls are executed by a GL server in a separate process.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "apps/understudy/gl_server/gl_server.h"
#include "spu/registry/assemble.h"
#include "spu/remote/remote.h"
#include "spu/track/share_group.h"
#include "spu/volume/session/render_session.h"
#include "tests/apps/viewer/temporary_folder.h"

namespace understudy::spu::staged {

/// A window system with one window.
class OneWindow final : public FrontEnd {
 public:
  RecordedContext context() override {
    return {.version = version,
            .profile = core ? 1U : 2U,
            .depth = depth,
            .stencil = depth == 0 ? 0 : 8,
            .samples = samples,
            .double_buffered = true};
  }
  FrontDrawable drawable() override { return {7, extent}; }
  /// Called on the server connection's thread; read it after a glFinish.
  void show(const FrontDrawable&, Extent2D shown_extent, std::span<const std::uint8_t> pixels) override {
    ++shown;
    image.assign(pixels.begin(), pixels.end());
    image_extent = shown_extent;
  }

  /// Blue, green and red of a pixel, counted from the upper left.
  std::array<int, 3> at(int x, int y) const {
    const std::size_t first = (std::size_t(y) * std::size_t(image_extent.width) + std::size_t(x)) * 4;
    return {image[first], image[first + 1], image[first + 2]};
  }

  int version = 0;
  bool core = false;
  int depth = 24;
  int samples = 0;
  Extent2D extent{64, 48};
  int shown = 0;
  Extent2D image_extent;
  std::vector<std::uint8_t> image;
};

class RemoteApplication {
 public:
  /// Starts a GL server with this chain; it writes counters to `counters_folder` if that is not empty.
  explicit RemoteApplication(const std::string& chain, const std::filesystem::path& counters_folder = {}) {
    const std::filesystem::path socket = folder_.file("gl_server.sock");
    launcher::Environment environment = launcher::current_environment();
    environment["UNDERSTUDY_CHAIN"] = chain;
    if (!counters_folder.empty()) environment["UNDERSTUDY_RUN_DIR"] = counters_folder;
    server = launcher::start_gl_server({PROGRAMS, LIBRARIES}, socket, environment);
    link = std::make_unique<ServerConnection>(socket.string(), window);
    window.version = link->versions().compatibility;
  }
  ~RemoteApplication() {
    Chain::release_current();
    chains_.clear();
    link.reset();
    server->end(5000);
  }
  RemoteApplication(const RemoteApplication&) = delete;
  RemoteApplication& operator=(const RemoteApplication&) = delete;

  /// Makes another context and makes it current.
  Chain& make_context(bool core = false, std::uint64_t shares_with = 0) {
    window.core = core;
    if (core) window.version = link->versions().core;
    chains_.push_back(std::make_unique<Chain>(remote_driver(), std::make_shared<ShareGroup>(), &install,
                                              Surroundings{chains_.size() + 1, shares_with, link.get()}));
    const auto session = std::make_shared<RenderSession>(Options{.speed_guard = false});
    EXPECT_EQ(assemble(*chains_.back(), "pack remote", session), std::nullopt);
    chains_.back()->make_current();
    return *chains_.back();
  }

  static void swap() {
    Chain::current()->settle();
    Chain::current()->frame_ended(FrameEnd::swap);
  }

  /// The table of the current context; null before there is one.
  static const DispatchTable* installed() { return table_; }

  OneWindow window;
  std::unique_ptr<launcher::ChildProcess> server;
  std::unique_ptr<ServerConnection> link;

 private:
  static void install(const DispatchTable* table) { table_ = table; }

  static inline thread_local const DispatchTable* table_ = nullptr;
  viewer_test::TemporaryFolder folder_;
  std::vector<std::unique_ptr<Chain>> chains_;
};

}  // namespace understudy::spu::staged
