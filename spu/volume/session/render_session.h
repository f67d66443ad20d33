// SPDX-License-Identifier: Apache-2.0
// The process's only connection to the render service: created when the first volume is recognised, shared by
// all contexts, and created again after a node group was lost.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "spu/options.h"
#include "spu/volume/session/live_settings.h"
#include "spu/volume/timing/frame_ledger.h"
#include "spu/volume/views/shown_windows.h"
#include "volume/volume_id.h"

namespace understudy::compositor {
class RenderService;
class ServiceLost;
}  // namespace understudy::compositor

namespace understudy::spu {

class FrameLatency;

class RenderSession {
 public:
  explicit RenderSession(Options options);
  ~RenderSession();

  const Options& options() const { return options_; }

  bool disabled_optimizations(Optimization optimization) const {
    return options_.disabled_optimizations[std::size_t(optimization)];
  }

  /// What is wanted from the end of the frame on; for any thread.
  WantedSettings& wanted_settings() { return wanted_settings_; }
  /// What is in effect. Requires the lock.
  const LiveSettings& settings() const { return settings_; }
  /// Called at the end of a frame: what is wanted takes effect, in all contexts. Takes the lock; null if
  /// another thread holds it, whose image may take long.
  std::optional<LiveSettings> take_wanted_settings();

  FrameLedger& ledger() { return ledger_; }

  /// Must be held while the service, or what it has returned, is used.
  std::unique_lock<std::mutex> lock() { return std::unique_lock(mutex_); }

  /// Returns the service; connects if there is none. Throws compositor::ServiceLost, immediately if it is too
  /// early to try again. Requires the lock.
  compositor::RenderService& service();

  /// Increases whenever a new service begins, which has no volumes yet.
  std::uint64_t generation() const { return generation_; }

  /// Returns `service` as the one that may answer with late images (`--frame-latency`); null if it may not:
  /// without nodes, or if it is not the session's. Requires the lock.
  FrameLatency* frame_latency(const compositor::RenderService& service) const;
  /// The windows that may show late images. Requires no lock.
  ShownWindows& windows() { return windows_; }

  /// Called when the service failed: explains it once; the next call of service() connects anew. Requires the
  /// lock.
  void lost(const compositor::ServiceLost& loss);

  /// Lets the service discard the volume; a service that is lost has done so anyway. Requires the lock.
  void forget(volume::VolumeId id);

  /// Called when the program ends, and what the ray caster depends on is destroyed: from now on there is no
  /// service. May be called from a signal handler that calls exit(), whatever the thread is doing.
  void end() { ended_ = true; }

  volume::VolumeId new_volume_id() { return ++last_volume_; }

  /// Number of the next scene that this process exports, from 1. May be called without the lock.
  int new_scene_number() { return ++last_scene_; }

 private:
  /// Whether whoever started the nodes reports what happens to them; then nothing is printed here.
  bool launcher_tells() const;
  std::unique_ptr<compositor::RenderService> connect();
  void heard_of_image(std::string_view why_cast);

  const Options options_;
  WantedSettings wanted_settings_;
  LiveSettings settings_;
  FrameLedger ledger_;
  std::mutex mutex_;
  std::string address_;  ///< of the nodes; empty: embedded
  std::unique_ptr<compositor::RenderService> service_;
  FrameLatency* frame_latency_ = nullptr;  ///< the service, if images may be late
  ShownWindows windows_;
  std::uint64_t generation_ = 0;
  volume::VolumeId last_volume_ = 0;
  std::atomic<int> last_scene_ = 0;
  bool connected_once_ = false;
  std::atomic<bool> ended_ = false;
  std::chrono::steady_clock::time_point not_before_{};
  std::string why_lost_;  ///< in few words, for frames until `not_before_`
};

}  // namespace understudy::spu
