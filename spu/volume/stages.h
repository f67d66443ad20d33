// SPDX-License-Identifier: Apache-2.0
// Constructs the stages of the volume unit, and passes to each stage the stages that it uses.
#pragma once

#include <functional>
#include <utility>

#include "spu/volume/depth/depth_watch.h"
#include "spu/volume/known_volumes/known_volumes.h"
#include "spu/volume/merging/run_merger.h"
#include "spu/volume/presentation/presentation.h"
#include "spu/volume/proxy/ray_caster_stage.h"
#include "spu/volume/recognition/recogniser.h"
#include "spu/volume/scene_export/scene_export.h"
#include "spu/volume/slices/slice_stage.h"

namespace understudy::spu {

/// The stages of one context, which must be current whenever one of them is used.
struct Stages {
  /// `owner` identifies the context in the ledger; `nothing_held` is called when `merger` no longer holds runs.
  Stages(const GlContext& context, ShareGroup& group, RenderSession& session, KnownVolumes& volumes,
         ProgramSamplers& samplers, FrameLedger::Context owner, std::function<void()> nothing_held)
      : account(context, session.ledger(), owner),
        programs(context, group, samplers),
        recogniser(context, group, programs),
        uploader(context, group, session, account),
        classifier(context, group, session, programs, account),
        composer(context, session, account),
        slices(uploader, classifier, composer),
        ray_casters(context, group, session, programs, uploader, classifier, composer, account),
        source(context, session, views, ray_casters, account),
        presentation(context, session, source, account),
        verifier(context, session, account),
        depth(context, session, account),
        merged(group, session, volumes),
        scenes(context, group, session, volumes, account),
        merger({context, group, session, uploader, slices, composer, verifier, presentation, account}, volumes,
               merged, std::move(nothing_held)) {}
  Stages(const Stages&) = delete;
  Stages& operator=(const Stages&) = delete;

  FrameAccount account;
  DrawnViews views;
  ProgramReader programs;
  Recogniser recogniser;
  Uploader uploader;
  Classifier classifier;
  RequestComposer composer;
  SliceStage slices;
  RayCasterStage ray_casters;
  ImageSource source;
  Presentation presentation;
  Verifier verifier;
  DepthWatch depth;
  MergedVolumes merged;
  SceneExport scenes;
  RunMerger merger;
};

}  // namespace understudy::spu
