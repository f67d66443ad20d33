// SPDX-License-Identifier: Apache-2.0
// The application's programs as the volume unit knows them, each read once a link: taken apart for measuring,
// and its text for what the colours can depend on.
#pragma once

#include <map>
#include <span>
#include <utility>

#include "spu/volume/pipeline/program_stages.h"
#include "spu/volume/program_check/program_check.h"

namespace understudy::spu {

class ShareGroup;

struct GlContext;
struct ProgramRecord;

/// Holds programs of the context it was made in, which go with that.
class ProgramReader {
 public:
  ProgramReader(const GlContext& context, ShareGroup& group, ProgramSamplers& samplers)
      : context_(context), group_(group), samplers_(samplers) {}

  /// The stages of `program`, whose record is `record`.
  const ProgramStages& stages(GLuint program, const ProgramRecord& record);
  /// The stages of a program that is known to the share group.
  const ProgramStages& stages(GLuint program);

  /// What the text of the pipeline's program says about its `subject` while uniforms have these values. Throws
  /// Refusal where it is not understood.
  const ProgramFindings& findings(const Pipeline& pipeline, std::span<const UniformValue> values,
                                  Subject subject);

  /// The programs are gone with their context.
  void forget() { stages_.clear(); }

 private:
  /// With the link that it stems from.
  template <class Known>
  using ByProgram = std::map<GLuint, std::pair<std::uint64_t, Known>>;

  const GlContext& context_;
  ShareGroup& group_;
  ProgramSamplers& samplers_;
  ByProgram<ProgramStages> stages_;
  ByProgram<ProgramText> texts_;
};

}  // namespace understudy::spu
