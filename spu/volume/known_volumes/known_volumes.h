// SPDX-License-Identifier: Apache-2.0
// The volumes of one context, by the texture that they are known by.
#pragma once

#include <map>
#include <memory>
#include <optional>

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

  /// The volume of `texture`, which is a new one where none was known. References stay valid until it is
  /// forgotten.
  KnownVolume& of(GLuint texture);
  /// Null where none is known.
  KnownVolume* find(GLuint texture);
  bool empty() const { return volumes_.empty(); }

  /// Why the application draws the volume with `program` before anything is known of the draw; null: there is
  /// no reason.
  std::optional<Refusal> standing_refusal(GLuint texture, GLuint program);
  /// The application draws the volume of `texture`: counted, and said on stderr where the reason is a new one
  /// and `say` is set.
  void refuse(GLuint texture, const Refusal& refusal, FrameAccount& account, bool say = true);

  /// The same for slices that are drawn one by one, and still are one run: once a frame.
  void refuse_in_this_frame(GLuint texture, const Refusal& refusal, FrameAccount& account);

  /// Volumes whose textures are gone, or all of them; the service forgets them, too. Takes the session's lock.
  void forget_deleted();
  void forget_all();

 private:
  void forget(const KnownVolume& volume);

  ShareGroup& group_;
  std::shared_ptr<RenderSession> session_;
  std::map<GLuint, KnownVolume> volumes_;
};

/// The run was substituted.
void count_substituted(KnownVolume& volume, const volume::FrameCounts& counts, FrameAccount& account);

/// An attempt to substitute a run took this time: the speed guard is told.
void count_speed(KnownVolume& volume, bool shown, const FrameShares& spent, const Options& options);

/// What follows of a comparison in `frame`. Where it was lost the application draws, and the volume is measured
/// anew: throws the refusal.
void take_comparison(const std::optional<Comparison>& comparison, KnownVolume& volume, std::uint64_t frame);

}  // namespace understudy::spu
