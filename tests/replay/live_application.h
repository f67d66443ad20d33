// SPDX-License-Identifier: Apache-2.0
// A small OpenGL program inside the test that is recorded while it draws; then its recording is played.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "apps/understudy/offscreen/egl_contexts.h"
#include "spu/chain.h"
#include "spu/window_system/window_system.h"

namespace understudy::replay_test {

/// 8-bit RGBA, bottom row first.
using Pixels = std::vector<std::uint8_t>;

constexpr spu::Extent2D extent{96, 80};  ///< of every drawable

/// Path of this test's own trace, which does not exist yet.
std::filesystem::path trace_of_this_test();

spu::RecordedContext compatibility_context(std::uint64_t number, std::uint64_t shares_with = 0);
spu::RecordedContext core_context(std::uint64_t number);

class LiveApplication {
 public:
  explicit LiveApplication(std::filesystem::path trace);
  ~LiveApplication();

  /// Makes the context and makes it current.
  void add(const spu::RecordedContext& context);
  void make_current(std::uint64_t context);
  /// The table that the application calls.
  const spu::DispatchTable& gl() const;
  /// Like a buffer swap: keeps the image that is shown.
  void show();
  /// Destroys all contexts and completes the trace.
  void end();

  const std::vector<Pixels>& shown() const { return shown_; }

 private:
  const std::filesystem::path trace_;
  launcher::EglContexts windows_;
  std::map<std::uint64_t, std::unique_ptr<spu::Chain>> chains_;
  std::vector<Pixels> shown_;
};

struct Played {
  std::vector<Pixels> frames;
  std::vector<Pixels> reads;
  std::vector<std::string> errors;
};

/// Plays the whole trace on new contexts.
Played play_back(const std::filesystem::path& trace, const std::string& chain = "driver");

}  // namespace understudy::replay_test
