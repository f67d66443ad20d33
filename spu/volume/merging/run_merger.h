// SPDX-License-Identifier: Apache-2.0
// Runs through the bricks of one volume wait for each other, and are shown as one: one request for a volume
// assembled from all textures takes their place. Wherever that fails, they are shown one by one.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "spu/volume/known_volumes/known_volumes.h"
#include "spu/volume/merging/merged_volumes.h"
#include "spu/volume/observation/run.h"
#include "spu/volume/presentation/presentation.h"
#include "spu/volume/request/request_composer.h"
#include "spu/volume/slices/slice_stage.h"
#include "spu/volume/upload/uploader.h"
#include "spu/volume/verification/verifier.h"

namespace understudy::spu {

/// The stages that its runs go through.
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

/// A run that has been understood, and is not shown yet. Its calls are gone.
struct HeldRun {
  std::unique_ptr<Run> run;
  RecognisedRun seen;
  ImageRequest image;
  KnownVolume* volume;

  const Pipeline& pipeline() const { return run->pipeline(); }
};

class RunMerger {
 public:
  /// `nothing_held` is called when what waited is about to be shown.
  RunMerger(const MergingStages& stages, KnownVolumes& volumes, MergedVolumes& merged,
            std::function<void()> nothing_held)
      : stages_(stages), volumes_(volumes), merged_(merged), nothing_held_(std::move(nothing_held)) {}

  bool empty() const { return held_.empty(); }

  /// Whether the run waits for the others of its volume; then `run` is taken, and `seen` with it. Takes the
  /// session's lock. Throws as the stages do.
  bool holds(std::unique_ptr<Run>& run, RecognisedRun& seen, KnownVolume& volume);

  /// Runs that wait are gone with their context.
  void forget_held();
  /// Runs that wait are shown now, whether or not all are there.
  void settle();

 private:
  /// That `pipeline` draws a brick of, and that its run may wait for; null: there is none.
  MergedVolume* volume_of(const Pipeline& pipeline, const RecognisedRun& seen, const KnownVolume& volume) const;
  /// Neither another texture than was known, nor more of it, nor values that no table was probed for.
  bool still_known(const Pipeline& pipeline, const RecognisedRun& seen, const TextureDescription& texture,
                   const MergedVolume& merged) const;
  /// Null where colours are none that bricks have in common.
  std::optional<ImageRequest> request_of(const Pipeline& pipeline, const RecognisedRun& seen,
                                         KnownVolume& volume, const MergedVolume& merged);
  bool goes_with_held(const MergedVolume& merged, const Pipeline& pipeline,
                      const volume::RenderRequest& request) const;
  void draw_natively(const Run& run, volume::RenderRequest request);
  bool shows_as_one(MergedVolume& merged, std::vector<HeldRun>& held);
  volume::FrameCounts show_whole(MergedVolume& merged, const std::vector<HeldRun>& held, ImageRequest& image,
                                 compositor::RenderService& service);
  /// One run that waited, by whatever service there is.
  void show_alone(HeldRun& run);
  volume::FrameCounts show_by_session(HeldRun& run);
  volume::FrameCounts show_by_itself(HeldRun& run);
  volume::FrameCounts show(HeldRun& run, compositor::RenderService& service);
  /// Needs the session's lock.
  void forget_single_bricks(const MergedVolume& merged);

  MergingStages stages_;
  KnownVolumes& volumes_;
  MergedVolumes& merged_;
  std::function<void()> nothing_held_;
  std::vector<HeldRun> held_;
  MergedVolume* held_volume_ = nullptr;   ///< of which the held runs are bricks
  std::unique_ptr<NativeDrawing> drawn_;  ///< what they draw themselves, in frames that are verified
};

}  // namespace understudy::spu
