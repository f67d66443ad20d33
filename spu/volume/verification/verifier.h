// SPDX-License-Identifier: Apache-2.0
// The stage that compares an image with what the application itself would draw, before it is shown: whole, or
// in sentinels (schedule.h decides when, tile_comparison.h by which bound).
#pragma once

#include <cstdint>
#include <optional>

#include "spu/report/counters.h"
#include "spu/volume/refusal/refusal.h"
#include "spu/volume/session/render_session.h"
#include "spu/volume/timing/frame_account.h"
#include "spu/volume/verification/sentinels.h"
#include "spu/volume/verification/tile_comparison.h"
#include "spu/volume/verification/verified_volume.h"

namespace understudy::spu {

/// The comparison of an image, or of the first of its tiles that was wrong.
struct Comparison {
  ImageDifference difference;
  double bound = 1;                 ///< for the severity of the worst tile
  bool right = false;               ///< within the bound
  std::optional<double> native_ms;  ///< of a whole image: time of the application's own drawing; 0: unknown
};

/// Returns the refusal for a failed comparison.
Refusal refusal_of(const Comparison& comparison);

/// The image that is compared, and the run that it replaces.
struct ImageToVerify {
  const Run& run;
  const volume::RenderRequest& request;
  volume::Rect window;  ///< into which the application draws: its viewport and scissor
  bool eye_inside = false;
  std::uint64_t frames = 0;  ///< of the volume, before this one
};

class Verifier {
 public:
  Verifier(const GlContext& context, RenderSession& session, FrameAccount& account)
      : context_(context), session_(session), account_(account) {}

  /// Whether the volume's next image is compared whole.
  bool whole_due(const VerifiedVolume& volume, bool eye_inside, std::uint64_t frames) const;

  /// Compares `image` with what the application draws. Null if nothing was compared, or if sentinels were
  /// right. Throws Refusal if the eye is inside and the steps are not known precisely enough.
  std::optional<Comparison> verify(const ImageToVerify& what, const volume::ImageView& image,
                                   VerifiedVolume& volume, VolumeCounters& counters);

  /// Returns whether another image of the same request is right where the last comparison failed: it is
  /// compared with what the application drew then.
  bool would_have_been_right(const Pipeline& pipeline, const volume::ImageView& image) const;

  /// Returns the verdict on a whole image, and counts it.
  Comparison judge(const ImageDifference& difference, double bound, double native_ms, VolumeCounters& counters);
  /// The same for a sentinel; null if it was right.
  std::optional<Comparison> judge_sentinel(const ImageDifference& difference, VolumeCounters& counters);

 private:
  std::optional<Comparison> compare_whole(const ImageToVerify& what, const volume::ImageView& image,
                                          VerifiedVolume& volume, VolumeCounters& counters);
  std::optional<Comparison> compare_sentinels(const ImageToVerify& what, const volume::ImageView& image,
                                              VerifiedVolume& volume, VolumeCounters& counters);
  void count(const ImageDifference& difference, VolumeCounters& counters);

  const GlContext& context_;
  RenderSession& session_;
  FrameAccount& account_;
  /// Of a failed comparison: what the application drew, and the bound.
  struct Lost {
    NativeImage native;
    double bound = 1;
  };
  Lost lost_to_;
  Sentinels sentinels_;
};

}  // namespace understudy::spu
