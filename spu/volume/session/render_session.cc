// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/session/render_session.h"

#include <fmt/format.h>

#include <cstdio>
#include <stdexcept>
#include <utility>

#include "compositor/logging/log.h"
#include "compositor/service.h"
#include "spu/report/counters.h"
#include "spu/volume/session/frame_latency.h"
#include "spu/volume/session/last_image.h"
#include "spu/volume/session/own_nodes.h"

namespace understudy::spu {
namespace {

using namespace std::chrono_literals;

/// The first connection waits for mpirun to start its ranks; later ones must not delay the viewer's frames.
constexpr int first_patience_ms = 30000;
constexpr int later_patience_ms = 20;
/// Between two attempts the application draws.
constexpr auto retry_after = 200ms;

}  // namespace

RenderSession::RenderSession(Options options)
    : options_(std::move(options)),
      wanted_settings_(LiveSettings(options_)),
      settings_(options_),
      address_(options_.connect) {}

RenderSession::~RenderSession() = default;

std::optional<LiveSettings> RenderSession::take_wanted_settings() {
  const std::unique_lock held(mutex_, std::try_to_lock);
  if (!held.owns_lock()) return std::nullopt;
  settings_ = wanted_settings_.get();
  return settings_;
}

compositor::RenderService& RenderSession::service() {
  if (ended_) throw std::runtime_error("the program is ending");
  if (service_) return *service_;
  if (std::chrono::steady_clock::now() < not_before_) {
    throw compositor::ServiceLost("waiting for a new group of render nodes", why_lost_);
  }
  try {
    service_ = with_last_image(connect(), !disabled_optimizations(Optimization::unchanged_images),
                               [this](std::string_view why) { heard_of_image(why); });
    // A ray caster in this process would take the viewer's own time.
    if (options_.frame_latency > 0 && service_->nodes() > 0) {
      auto late = std::make_unique<FrameLatency>(std::move(service_));
      frame_latency_ = late.get();
      service_ = std::move(late);
    }
  } catch (const compositor::ServiceLost& unreachable) {
    if (!connected_once_ && !launcher_tells()) {
      logging::log(logging::Level::warn, "{}; the viewer draws by itself", unreachable.what());
    }
    why_lost_ = unreachable.reason();
    not_before_ = std::chrono::steady_clock::now() + retry_after;
    connected_once_ = true;  // nodes that did not answer within 30 s are not waited for again
    throw;
  }
  connected_once_ = true;
  ++generation_;
  return *service_;
}

void RenderSession::heard_of_image(std::string_view why_cast) {
  const bool cast = !why_cast.empty();
  ledger_.note([&](FrameRecord& frame) {
    Amount& images = frame.amount(Optimization::unchanged_images);
    ++(cast ? images.done : images.left_out);
  });
  if (cast) count_done(Optimization::unchanged_images, why_cast);
}

FrameLatency* RenderSession::frame_latency(const compositor::RenderService& service) const {
  return &service == frame_latency_ ? frame_latency_ : nullptr;
}

std::unique_ptr<compositor::RenderService> RenderSession::connect() {
  if (options_.nodes > 0 && address_.empty() && !connected_once_) address_ = start_own_nodes(options_.nodes);
  if (address_.empty()) return compositor::embedded_service();
  return compositor::remote_render_service(address_, connected_once_ ? later_patience_ms : first_patience_ms);
}

bool RenderSession::launcher_tells() const {
  return options_.nodes > 0 && (!options_.run_dir.empty() || options_.connect.empty());
}

void RenderSession::forget(volume::VolumeId id) {
  if (!service_) return;
  try {
    service_->forget_volume(id);
  } catch (const compositor::ServiceLost& gone) {
    lost(gone);
  }
}

void RenderSession::lost(const compositor::ServiceLost& loss) {
  // Every frame without a service gets here, and must not postpone the next attempt.
  if (!service_) return;
  if (!launcher_tells()) {
    logging::log(logging::Level::warn, "{}; the viewer draws by itself until the nodes are back", loss.what());
  }
  frame_latency_ = nullptr;
  service_.reset();
  why_lost_ = loss.reason();
  not_before_ = std::chrono::steady_clock::now() + retry_after;
}

}  // namespace understudy::spu
