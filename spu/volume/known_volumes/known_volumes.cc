// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/known_volumes/known_volumes.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <utility>

#include "compositor/logging/log.h"
#include "spu/track/share_group.h"

namespace understudy::spu {
namespace {

/// Frames until a volume is tried again, by the number of failed comparisons in a row.
constexpr std::array<std::uint64_t, 4> pauses = {1, 1, 4, 16};

void count_left(KnownVolume& volume, std::string_view reason, FrameAccount& account) {
  account.note([](FrameRecord& frame) { ++frame.left; });
  volume.counters->draws_left.fetch_add(1, std::memory_order_relaxed);
  count_reason(*volume.counters, reason);
}

}  // namespace

KnownVolumes::KnownVolumes(ShareGroup& group, std::shared_ptr<RenderSession> session)
    : group_(group), session_(std::move(session)) {}

KnownVolumes::~KnownVolumes() {
  for (auto& [texture, volume] : volumes_)
    if (volume.counters != nullptr) leave_behind(*volume.counters);
}

KnownVolume& KnownVolumes::of(GLuint texture) {
  KnownVolume& volume = volumes_[texture];
  if (volume.identity == 0) volume.identity = group_.identity(texture);
  if (volume.counters == nullptr) volume.counters = &count_volume(texture);
  return volume;
}

KnownVolume* KnownVolumes::find(GLuint texture) {
  const auto found = volumes_.find(texture);
  return found == volumes_.end() ? nullptr : &found->second;
}

void KnownVolumes::forget_redefined(GLuint texture) {
  const auto found = volumes_.find(texture);
  if (found == volumes_.end() || group_.is(texture, found->second.identity)) return;
  forget(found->second);
  volumes_.erase(found);
}

std::uint64_t state_of(std::span<const GLuint> textures, GLuint program, const ShareGroup& group) {
  constexpr std::uint64_t prime = 0x100000001b3;
  std::uint64_t state = 0;
  for (const GLuint texture : textures) state = (state ^ group.texture_version(texture)) * prime;
  return state ^ program;
}

std::optional<Refusal> speed_refusal(KnownVolume& volume, std::uint64_t state) {
  const auto now = SpeedGuard::Clock::now();
  volume.speed.about_to_draw(state, now);
  if (!volume.speed.pauses(now)) return std::nullopt;
  if (volume.speed.slower().empty()) return Refusal{volume.refusals.last_reason};
  return Refusal{"the viewer's own drawing is faster", volume.speed.slower(),
                 "--speed-guard off substitutes it all the same"};
}

std::optional<Refusal> KnownVolumes::speed_refusal(GLuint texture, GLuint program) {
  KnownVolume& volume = of(texture);
  volume.speed.share_among(volumes_.size());
  return spu::speed_refusal(volume, state_of(std::span(&texture, 1), program, group_));
}

std::optional<Refusal> KnownVolumes::standing_refusal(GLuint texture) {
  forget_redefined(texture);
  KnownVolume& volume = of(texture);
  const RefusalHistory& history = volume.refusals;
  if (!history.handed_back.empty()) return Refusal{history.handed_back};
  if (history.pauses(session_->ledger().frames()) && !history.last_reason.empty())
    return Refusal{history.last_reason};
  return std::nullopt;
}

void KnownVolumes::refuse(GLuint texture, const Refusal& refusal, FrameAccount& account, bool say) {
  KnownVolume& volume = of(texture);
  count_left(volume, refusal.reason, account);
  const bool new_reason = std::exchange(volume.refusals.last_reason, refusal.reason) != refusal.reason;
  if (!new_reason || !say) return;
  logging::log(logging::Level::info, "volume {} not substituted: {}", texture, refusal.reason);
  if (!session_->options().explain) return;
  if (!refusal.evidence.empty()) logging::log(logging::Level::info, "  seen: {}", refusal.evidence);
  if (!refusal.advice.empty()) logging::log(logging::Level::info, "  what helps: {}", refusal.advice);
}

void KnownVolumes::refuse_in_this_frame(GLuint texture, const Refusal& refusal, FrameAccount& account,
                                        bool say) {
  const std::uint64_t frame = session_->ledger().frames();
  if (of(texture).refusals.left_in_frame != frame) refuse(texture, refusal, account, say);
  of(texture).refusals.left_in_frame = frame;
}

void KnownVolumes::leave_in_this_frame(GLuint texture, std::string_view reason, FrameAccount& account) {
  forget_redefined(texture);
  KnownVolume& volume = of(texture);
  const std::uint64_t frame = session_->ledger().frames();
  if (std::exchange(volume.refusals.left_in_frame, frame) != frame) count_left(volume, reason, account);
}

void KnownVolumes::forget(const KnownVolume& volume) {
  if (volume.counters != nullptr) leave_behind(*volume.counters);
  if (volume.sent.generation == 0) return;
  const auto lock = session_->lock();
  if (volume.sent.generation == session_->generation()) session_->forget(volume.sent.description.id);
}

void KnownVolumes::forget_deleted() {
  std::erase_if(volumes_, [&](auto& entry) {
    if (group_.is(entry.first, entry.second.identity)) return false;
    forget(entry.second);
    return true;
  });
}

void KnownVolumes::forget_all() {
  for (auto& [texture, volume] : volumes_) forget(volume);
  volumes_.clear();
}

void count_substituted(KnownVolume& volume, const volume::FrameCounts& counts, FrameAccount& account) {
  volume.refusals.in_a_row = 0;
  volume.counters->draws_substituted.fetch_add(1, std::memory_order_relaxed);
  account.note([&](FrameRecord& frame) {
    ++frame.substituted;
    frame.counts += counts;
  });
}

void count_speed(KnownVolume& volume, bool shown, const FrameShares& spent, std::optional<double> native_ms) {
  // Waiting for earlier drawing is not part of the cost of the volume.
  const double ours_ms =
      spent.recognition + spent.upload + spent.render + spent.verification + spent.presentation + spent.budget;
  const auto now = SpeedGuard::Clock::now();
  if (!shown) {
    volume.speed.refused(ours_ms, now);
    if (std::exchange(volume.refusals.explained_otherwise, false)) volume.speed.allow_another();
  } else if (native_ms) {
    volume.speed.shown(ours_ms, *native_ms, now);
  }
}

void take_comparison(const std::optional<Comparison>& comparison, KnownVolume& volume, std::uint64_t frame) {
  if (!comparison) return;
  VerificationSchedule& schedule = volume.verified.schedule;
  if (comparison->right) {
    const bool anything_visible = comparison->difference.anything_visible;
    if (anything_visible) volume.colours.rounding.won();
    schedule.whole_was_right(anything_visible, comparison->native_ms.value_or(0));
    return;
  }
  Refusal refusal = refusal_of(*comparison);
  if (volume.colours.rounding.try_after_loss(volume.sent.texture)) {
    volume.refusals.pause(frame, 1);
    volume.refusals.explained_otherwise = true;
    schedule.ask_for_whole();
    refusal.reason += "; tried again with samples rounded to 8 bits";
    throw Refusal{std::move(refusal)};
  }
  using Loss = VerificationSchedule::Loss;
  const bool strictness = comparison->bound < 1 && comparison->difference.worst.within_bound();
  schedule.lost(strictness ? Loss::strictness : Loss::beyond_bound);
  volume.counters->verify_lost.fetch_add(1, std::memory_order_relaxed);
  volume.colours.probed.reset();
  volume.march.march.reset();
  volume.march.measured.clear();
  volume.march.followers.was_wrong();
  volume.march.kept.clear();
  const auto in_a_row = std::min(std::size_t(schedule.lost_in_a_row()), pauses.size());
  volume.refusals.pause(frame, pauses[in_a_row - 1]);
  if (schedule.gives_up()) volume.refusals.handed_back = refusal.reason;
  throw Refusal{std::move(refusal)};
}

}  // namespace understudy::spu
