// SPDX-License-Identifier: Apache-2.0
// The stage that determines which colours the application's pipeline gives to samples. It probes the pipeline
// if they are not known (classification: Levoy 1988; pre-integrated: Engel, Kraus, Ertl 2001).
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "spu/volume/classification/known_colours.h"
#include "spu/volume/geometry/recognised_run.h"
#include "spu/volume/program_check/program_reader.h"
#include "spu/volume/verification/schedule.h"
#include "volume/fog.h"

namespace understudy::spu {

class FrameAccount;

class RenderSession;

struct VolumeCounters;

class ShareGroup;

struct GlContext;

/// The colours of a run of slices.
struct SliceColours {
  volume::Classification classification;
  std::optional<volume::Fog> fog;
  std::optional<volume::SliceSegment> slice_segment;  ///< if the colours are those of segments
  VerificationSchedule::Inputs inputs;                ///< what the colours depend on
};

class Classifier {
 public:
  Classifier(const GlContext& context, ShareGroup& group, RenderSession& session, ProgramReader& programs,
             FrameAccount& account)
      : context_(context), group_(group), session_(session), programs_(programs), account_(account) {}

  /// Returns the colours of `run`, drawn by `pipeline` from `texture`, whose values lie in `range`. Probes them
  /// unless `known` is still valid, and stores the result there. Throws Refusal.
  SliceColours classify(const Pipeline& pipeline, const RecognisedRun& run, const TextureDescription& texture,
                        const std::array<float, 2>& range, KnownColours& known, VolumeCounters& counters);

  /// Counts colours or steps as measured anew, with the reason `why`, or, if that is empty, as known.
  void count_probe(std::string_view why);

 private:
  struct Key;
  Key key_of(const Pipeline& pipeline, const RecognisedRun& run, const TextureDescription& texture,
             const std::array<float, 2>& range);
  void append_program(const Pipeline& pipeline, const RecognisedRun& run, Key& key);
  void append_assembly(const Pipeline& pipeline, const RecognisedRun& run, Key& key);
  void append_tables(const Pipeline& pipeline, Key& key) const;
  std::string_view why_probed(const KnownColours& known, const std::vector<float>& key,
                              const InputRange& range) const;

  const GlContext& context_;
  ShareGroup& group_;
  RenderSession& session_;
  ProgramReader& programs_;
  FrameAccount& account_;
};

}  // namespace understudy::spu
