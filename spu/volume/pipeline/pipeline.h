// SPDX-License-Identifier: Apache-2.0
// Recognises draws that may be a volume by the state that surrounds them, which is read from the driver before
// the draw.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <variant>

#include "spu/volume/pipeline/blending.h"
#include "spu/volume/pipeline/program_samplers.h"
#include "spu/volume/pipeline/target.h"
#include "spu/volume/refusal/refusal.h"

namespace understudy::spu {

class ShareGroup;

struct GlContext;

/// A texture unit that the pipeline samples.
struct SampledTexture {
  GLenum target = 0;
  int unit = 0;
  GLuint texture = 0;
  GLint sampler_location = -1;  ///< in the application's program; -1 for fixed function
  bool operator==(const SampledTexture&) const = default;
};

/// The pipeline of a run of slices.
struct Pipeline {
  GLuint program = 0;          ///< 0: fixed function
  std::string assembly;        ///< text of the ARB assembly program of the fragments; then `program` is 0
  bool vertex_shader = false;  ///< false: fixed-function vertices, captured by feedback
  SampledTexture volume;
  bool stack = false;                  ///< `volume` may be the first of a stack of 2-D textures
  std::vector<SampledTexture> others;  ///< look-up tables of the program
  bool fog = false;                    ///< fixed function fades fragments by their distance from the eye plane
  Blending blending;
  Target target;
  bool depth_test = false;
  bool depth_or_equal = false;
  bool depth_write = false;
};

/// The draw is not related to volumes: it is passed on without a report.
struct NotAVolume {};
/// The draw samples a volume in a way that is not supported; the refusal is reported.
struct LeftAlone {
  GLuint texture = 0;
  Refusal refusal;
};

using PipelineFinding = std::variant<NotAVolume, LeftAlone, Pipeline>;

/// Reads the current state. Must be called outside of glBegin/glEnd. With `stacks`, a draw with a 2-D texture
/// may be a slice, too.
PipelineFinding read_pipeline(const GlContext& context, const ShareGroup& group, ProgramSamplers& samplers,
                              bool stacks);

}  // namespace understudy::spu
