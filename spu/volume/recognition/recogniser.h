// SPDX-License-Identifier: Apache-2.0
// The second stage: determines what a run of draws is. Its vertices are captured as the application's own
// pipeline places them; a camera is fitted to them, and the planes and segments of slices are found. Cabral,
// Cam, Foran 1994 draw such slices; Krüger and Westermann 2003 draw such a box.
#pragma once

#include <string>

#include "spu/track/share_group.h"
#include "spu/volume/context/context.h"
#include "spu/volume/geometry/given_vertices.h"
#include "spu/volume/geometry/recognised_run.h"
#include "spu/volume/observation/run.h"
#include "spu/volume/program_check/program_reader.h"

namespace understudy::spu {

class ShareGroup;

struct GlContext;

class Recogniser {
 public:
  Recogniser(const GlContext& context, ShareGroup& group, ProgramReader& programs)
      : context_(context), group_(group), programs_(programs), given_(context) {}

  /// Recognises `run`. `known_coordinate` is the input that addressed the volume of this ray caster before;
  /// empty: none is known. Throws Refusal if the run is not a volume that nodes can render, NothingVisible if
  /// it draws nothing.
  RecognisedRun recognise(const Run& run, const std::string& known_coordinate);
  /// The same from the geometry alone, without the texture's version.
  RecognisedRun find_geometry(const Run& run, const std::string& known_coordinate);

 private:
  RecognisedRun observe(const Run& run, const std::string& known_coordinate);
  void observe_shader(const Run& run, const ProgramStages& stages, const std::string& known_coordinate,
                      RecognisedRun& seen);
  void observe_fixed_function(const Run& run, RecognisedRun& seen);
  void find_slices_of(const Pipeline& pipeline, RecognisedRun& seen);
  std::uint64_t texture_version(const Pipeline& pipeline, const RecognisedRun& seen) const;

  const GlContext& context_;
  ShareGroup& group_;
  ProgramReader& programs_;
  GivenVertices given_;
};

}  // namespace understudy::spu
