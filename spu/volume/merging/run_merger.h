// SPDX-License-Identifier: Apache-2.0
// Runs that draw bricks of one volume wait for each other, and are shown as one: they are replaced by one
// request for a volume assembled from all textures. If that fails, they are shown one by one.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "spu/volume/known_volumes/known_volumes.h"
#include "spu/volume/merging/brick_comparison.h"
#include "spu/volume/merging/merged_volumes.h"
#include "spu/volume/observation/run.h"
#include "spu/volume/presentation/presentation.h"
#include "spu/volume/request/request_composer.h"
#include "spu/volume/slices/slice_stage.h"
#include "spu/volume/upload/uploader.h"
#include "spu/volume/verification/verifier.h"

namespace understudy::spu {

/// The stages that merged runs pass through.
struct MergingStages {
  const GlContext& context;
  ShareGroup& group;
  RenderSession& session;
  Uploader& uploader;
  SliceStage& slices;
  RequestComposer& composer;
  Verifier& verifier;
  Presentation& presentation;
  FrameAccount& account;
};

/// A run that was recognised, and is not shown yet. Its calls cannot be replayed: the state around them has
/// changed.
struct HeldRun {
  std::unique_ptr<Run> run;
  RecognisedRun seen;
  ImageRequest image;
  KnownVolume* volume;

  const Pipeline& pipeline() const { return run->pipeline(); }
};

class RunMerger {
 public:
  /// `nothing_held` is called when waiting runs are about to be shown.
  RunMerger(const MergingStages& stages, KnownVolumes& volumes, MergedVolumes& merged,
            std::function<void()> nothing_held)
      : stages_(stages),
        volumes_(volumes),
        merged_(merged),
        nothing_held_(std::move(nothing_held)),
        comparison_(stages.context, stages.session, stages.verifier, stages.account) {}

  bool empty() const { return held_.empty(); }

  /// Returns whether the run waits for the other runs of its volume; if so, `run` and `seen` are moved from.
  /// Takes the session's lock. Throws as the stages do.
  bool holds(std::unique_ptr<Run>& run, RecognisedRun& seen, KnownVolume& volume);

  /// Discards the waiting runs, whose context is gone.
  void forget_held();
  /// Shows the waiting runs now, whether or not all bricks are there.
  void settle();
  /// Adds what it took to recognise a run that waits to the time of the volume's image.
  void count_held(const FrameShares& spent);

 private:
  /// Returns the volume that `pipeline` draws a brick of, if its run may wait; otherwise null.
  MergedVolume* volume_of(const Pipeline& pipeline, const RecognisedRun& seen, const KnownVolume& volume) const;
  /// Returns whether the run reads the texture that was merged, no more of it, and only values that were
  /// probed.
  bool still_known(const Pipeline& pipeline, const RecognisedRun& seen, const TextureDescription& texture,
                   const MergedVolume& merged) const;
  /// Null if the colours cannot be common to all bricks.
  std::optional<ImageRequest> request_of(const Pipeline& pipeline, const RecognisedRun& seen,
                                         KnownVolume& volume, const MergedVolume& merged);
  /// What the image of the whole depends on, given the request for its first brick.
  VerificationSchedule::Inputs inputs_of(const MergedVolume& merged, const ImageRequest& image) const;
  bool goes_with_held(const MergedVolume& merged, const Pipeline& pipeline,
                      const volume::RenderRequest& request) const;
  /// Takes the session's lock.
  bool speed_is_guarded() const;
  /// Shows all of `held` as one image, or each by itself. Returns how long the application would have taken for
  /// them; null if that is not known.
  std::optional<double> show_held(MergedVolume& merged, std::vector<HeldRun>& held);
  bool shows_as_one(MergedVolume& merged, std::vector<HeldRun>& held);
  /// The bricks' next own images are measured anew and compared before they are shown.
  static void distrust(const std::vector<HeldRun>& held);
  /// The application's own drawing was shown instead of the common image of `held`, which was wrong.
  void leave(const std::vector<HeldRun>& held, const Refusal& refusal);
  /// Empty if the image was wrong, and what the application draws was shown instead.
  std::optional<volume::FrameCounts> show_whole(MergedVolume& merged, const std::vector<HeldRun>& held,
                                                ImageRequest& image, compositor::RenderService& service);
  /// Shows one run that waited, with the session's service or, if that fails, one of its own.
  void show_alone(HeldRun& run);
  volume::FrameCounts show_by_session(HeldRun& run);
  volume::FrameCounts show_by_itself(HeldRun& run);
  volume::FrameCounts show(HeldRun& run, compositor::RenderService& service);
  /// Requires the session's lock.
  void forget_single_bricks(const MergedVolume& merged);

  MergingStages stages_;
  KnownVolumes& volumes_;
  MergedVolumes& merged_;
  std::function<void()> nothing_held_;
  BrickComparison comparison_;  ///< of the held runs
  std::vector<HeldRun> held_;
  MergedVolume* held_volume_ = nullptr;  ///< volume of which the held runs are bricks
  FrameShares spent_{};                  ///< on the held runs, in milliseconds
};

}  // namespace understudy::spu
