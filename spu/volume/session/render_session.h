// SPDX-License-Identifier: Apache-2.0
// The process's one way to the render service: made when the first volume is recognised, shared by all
// contexts, and made again after a node group was lost.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

#include "spu/options.h"
#include "spu/volume/timing/frame_ledger.h"
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

  FrameLedger& ledger() { return ledger_; }

  /// Whoever talks to the service holds this for as long as it looks at what the service returned.
  std::unique_lock<std::mutex> lock() { return std::unique_lock(mutex_); }

  /// The service; connects when there is none. Throws compositor::ServiceLost, at once while it is too early to
  /// try again. Needs the lock.
  compositor::RenderService& service();

  /// Grows whenever a new service begins, which knows no volumes yet.
  std::uint64_t generation() const { return generation_; }

  /// Told at frame ends: whether this thread's window is one that can be asked to draw itself again. Only then
  /// images may be behind.
  void window_can_be_asked(bool can) { window_can_be_asked_ = can; }
  bool window_can_be_asked() const { return window_can_be_asked_; }
  /// Whether the next images may be those of the frame before (`--frame-latency`); without nodes they never
  /// are. Needs the lock.
  void allow_behind(bool allowed);
  /// The latest image is to be shown: counted where it is behind. Needs the lock.
  void note_shown();
  /// Whether one has been shown that was behind since this was last asked.
  bool take_behind() { return behind_shown_.exchange(false); }

  /// The service failed: explained once, and the next call of service() connects anew. Needs the lock.
  void lost(const compositor::ServiceLost& loss);

  /// The service need not keep the volume any longer; a service that is lost has forgotten it anyway. Needs the
  /// lock.
  void forget(volume::VolumeId id);

  /// The program is ending, and what the ray caster stands on is taken apart: from now on there is no service.
  /// May be called from a signal handler that calls exit(), whatever the thread is in the midst of.
  void end() { ended_ = true; }

  volume::VolumeId new_volume_id() { return ++last_volume_; }

 private:
  /// Whoever started the nodes says itself what became of them; then nothing is said here.
  bool launcher_tells() const;
  std::unique_ptr<compositor::RenderService> connect();
  void heard_of_image(std::string_view why_cast);

  const Options options_;
  FrameLedger ledger_;
  std::mutex mutex_;
  std::string address_;  ///< of the nodes; empty: embedded
  std::unique_ptr<compositor::RenderService> service_;
  FrameLatency* pipeline_ = nullptr;  ///< the service, where images may be behind
  std::atomic<bool> window_can_be_asked_ = false;
  std::atomic<bool> behind_shown_ = false;
  std::uint64_t generation_ = 0;
  volume::VolumeId last_volume_ = 0;
  bool connected_once_ = false;
  std::atomic<bool> ended_ = false;
  std::chrono::steady_clock::time_point not_before_{};
  std::string why_lost_;  ///< in few words, for frames until then
};

}  // namespace understudy::spu
