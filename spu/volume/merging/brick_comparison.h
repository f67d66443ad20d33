// SPDX-License-Identifier: Apache-2.0
// Compares the common image of runs that wait with what the application would have drawn of them. Each run is
// repeated off screen when it begins to wait, because its calls cannot be replayed later.
#pragma once

#include <optional>

#include "spu/volume/merging/merged_volume.h"
#include "spu/volume/observation/run.h"
#include "spu/volume/verification/sentinels.h"
#include "spu/volume/verification/verifier.h"

namespace understudy::spu {

class BrickComparison {
 public:
  BrickComparison(const GlContext& context, RenderSession& session, Verifier& verifier, FrameAccount& account)
      : context_(context), session_(session), verifier_(verifier), account_(account) {}

  /// Called before the first run of an image is added: decides how much of the image is compared. `request` is
  /// the first run's. Throws Refusal if the driver cannot draw into floats.
  void begin(const MergedVolume& merged, const Run& run, const volume::RenderRequest& request);
  void add(const Run& run);
  /// Nothing of the next image is compared until begin() is called.
  void end() {
    compared_.reset();
    shown_instead_.reset();
  }

  bool whole() const { return compared_ && compared_->whole; }
  /// Whether the image, or one sentinel of it, is compared.
  bool begun() const { return compared_.has_value(); }

  /// Compares `image`, which `pipeline` would show. Throws the Refusal of a failed comparison.
  void check(const Pipeline& pipeline, const volume::ImageView& image, KnownVolume& volume);
  /// What the application draws, if the whole image was compared and wrong; otherwise null.
  const std::optional<NativeImage>& shown_instead() const { return shown_instead_; }

 private:
  struct Compared {
    NativeDrawing* drawing;  ///< of sentinels_
    volume::Rect rect;
    bool whole;
    double ms = 0;  ///< of the application's own drawing so far
  };

  /// Takes the session's lock.
  bool has_budget() const;

  const GlContext& context_;
  RenderSession& session_;
  Verifier& verifier_;
  FrameAccount& account_;
  Sentinels sentinels_;
  std::optional<Compared> compared_;
  std::optional<NativeImage> shown_instead_;
};

}  // namespace understudy::spu
