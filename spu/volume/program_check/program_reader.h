// SPDX-License-Identifier: Apache-2.0
// The application's programs, each read once per link: taken apart for measuring, and their sources analysed
// for what colours can depend on.
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

/// Owns programs of the context in which it was created, which are deleted with the context.
class ProgramReader {
 public:
  ProgramReader(const GlContext& context, ShareGroup& group, ProgramSamplers& samplers)
      : context_(context), group_(group), samplers_(samplers) {}

  /// Returns the stages of `program`, whose record is `record`.
  const ProgramStages& stages(GLuint program, const ProgramRecord& record);
  /// Returns the stages of a program that is known to the share group.
  const ProgramStages& stages(GLuint program);

  /// Returns what the source of the pipeline's program implies for `subject` while uniforms have these values.
  /// Throws Refusal if it cannot be analysed.
  const ProgramFindings& findings(const Pipeline& pipeline, std::span<const UniformValue> values,
                                  Subject subject);

  /// Returns what the text of the pipeline's assembly program implies for slices. Throws Refusal if it cannot
  /// be analysed.
  const ProgramFindings& findings_of_assembly(const Pipeline& pipeline);

  /// Forgets the programs, which are gone with their context.
  void forget() { stages_.clear(); }

 private:
  /// With the link that it belongs to.
  template <class Known>
  using ByProgram = std::map<GLuint, std::pair<std::uint64_t, Known>>;

  const GlContext& context_;
  ShareGroup& group_;
  ProgramSamplers& samplers_;
  ByProgram<ProgramStages> stages_;
  ByProgram<ProgramText> texts_;
  AssemblyText assembly_;
};

}  // namespace understudy::spu
