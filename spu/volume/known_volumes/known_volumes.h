// SPDX-License-Identifier: Apache-2.0
// The volumes of one context, identified by their textures.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include "spu/volume/known_volumes/known_volume.h"
#include "spu/volume/verification/verifier.h"

namespace understudy::spu {

class FrameAccount;

class RenderSession;

class ShareGroup;

class KnownVolumes {
 public:
  KnownVolumes(ShareGroup& group, std::shared_ptr<RenderSession> session);
  ~KnownVolumes();
  KnownVolumes(const KnownVolumes&) = delete;
  KnownVolumes& operator=(const KnownVolumes&) = delete;

  /// Returns the volume of `texture`, a new one if none was known. References stay valid until the volume is
  /// forgotten.
  KnownVolume& of(GLuint texture);
  /// Null if it is not known.
  KnownVolume* find(GLuint texture);
  bool empty() const { return volumes_.empty(); }

  /// Returns why the application itself draws the volume, as far as known before the draw is examined; null if
  /// there is no reason. Takes the session's lock.
  std::optional<Refusal> standing_refusal(GLuint texture);
  /// The same for the sake of speed, for a volume that is drawn with `program`.
  std::optional<Refusal> speed_refusal(GLuint texture, GLuint program);
  /// Counts that the application draws the volume of `texture`, and prints the reason on stderr if it is new
  /// and `say` is set.
  void refuse(GLuint texture, const Refusal& refusal, FrameAccount& account, bool say = true);

  /// The same for slices that are drawn one by one and still form one run: once per frame.
  void refuse_in_this_frame(GLuint texture, const Refusal& refusal, FrameAccount& account, bool say = true);
  /// Counts, once per frame, that the application draws the volume because it was told to (`understudy ctl`).
  /// Prints nothing, and does not become the reason of later frames.
  void leave_in_this_frame(GLuint texture, std::string_view reason, FrameAccount& account);

  /// Forget volumes whose textures were deleted, or all; the service forgets them, too. Take the session's
  /// lock.
  void forget_deleted();
  void forget_all();

 private:
  void forget(const KnownVolume& volume);
  /// Forgets the volume of another texture that had this name. Takes the session's lock.
  void forget_redefined(GLuint texture);

  ShareGroup& group_;
  std::shared_ptr<RenderSession> session_;
  std::map<GLuint, KnownVolume> volumes_;
};

/// Counts a substituted run.
void count_substituted(KnownVolume& volume, const volume::FrameCounts& counts, FrameAccount& account);

/// Identifies the program and the contents of a volume's textures: what a speed guard's verdict depends on.
std::uint64_t state_of(std::span<const GLuint> textures, GLuint program, const ShareGroup& group);

/// Returns why the application itself draws `volume` for the sake of speed; null if there is no reason.
std::optional<Refusal> speed_refusal(KnownVolume& volume, std::uint64_t state);

/// Reports the time of an attempt to substitute a volume to its speed guard. `native_ms`: what the
/// application's own drawing would have taken; null: unknown.
void count_speed(KnownVolume& volume, bool shown, const FrameShares& spent, std::optional<double> native_ms);

/// Evaluates a comparison in `frame`. If it failed, the volume is measured anew, and the refusal is thrown that
/// makes the application draw it.
void take_comparison(const std::optional<Comparison>& comparison, KnownVolume& volume, std::uint64_t frame);

}  // namespace understudy::spu
