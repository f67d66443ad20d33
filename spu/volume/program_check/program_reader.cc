// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/program_check/program_reader.h"

#include "spu/track/program_sources.h"
#include "spu/track/share_group.h"
#include "spu/volume/context/context.h"

namespace understudy::spu {

const ProgramStages& ProgramReader::stages(GLuint program, const ProgramRecord& record) {
  auto& [link, stages] = stages_[program];
  if (link != record.link) {
    if (stages.observer != 0) context_.gl->DeleteProgram(stages.observer);
    stages = take_apart(context_, record, program);
    link = record.link;
  }
  return stages;
}

const ProgramStages& ProgramReader::stages(GLuint program) {
  return stages(program, *group_.programs().program(program));
}

const ProgramFindings& ProgramReader::findings(const Pipeline& pipeline, std::span<const UniformValue> values,
                                               Subject subject) {
  const GLuint program = pipeline.program;
  const auto record = group_.programs().program(program);
  auto& [link, text] = texts_[program];
  if (link != record->link) {
    text = {};
    link = record->link;
  }
  const DispatchTable& gl = *context_.gl;
  const SamplerRoles roles = sampler_roles(context_, pipeline, samplers_.of(gl, program, record->link));
  const ProgramFindings* const found =
      text.findings(record->fragment_sources, context_.extensions, roles, values, subject);
  if (found == nullptr) throw Refusal{text.trouble()};
  return *found;
}

const ProgramFindings& ProgramReader::findings_of_assembly(const Pipeline& pipeline) {
  const ProgramFindings* const found = assembly_.findings(context_, pipeline);
  if (found == nullptr) throw Refusal{assembly_.trouble()};
  return *found;
}

}  // namespace understudy::spu
