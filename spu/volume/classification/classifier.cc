// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/classification/classifier.h"

#include <cmath>
#include <span>

#include "spu/report/counters.h"
#include "spu/report/optimization.h"
#include "spu/track/share_group.h"
#include "spu/volume/classification/texel_inputs.h"
#include "spu/volume/context/context.h"
#include "spu/volume/pipeline/block_members.h"
#include "spu/volume/session/render_session.h"
#include "spu/volume/texture/texture_parameter.h"
#include "spu/volume/texture/value_range.h"
#include "spu/volume/timing/frame_account.h"

namespace understudy::spu {
namespace {

/// Appends everything that fixed-function fragments depend on, as values to compare.
void append_fixed_function_state(const DispatchTable& gl, std::vector<float>& key) {
  constexpr std::array<GLenum, 17> names = {
      GL_TEXTURE_ENV_MODE, GL_COMBINE_RGB,  GL_COMBINE_ALPHA,  GL_SRC0_RGB,       GL_SRC1_RGB,
      GL_SRC2_RGB,         GL_SRC0_ALPHA,   GL_SRC1_ALPHA,     GL_SRC2_ALPHA,     GL_OPERAND0_RGB,
      GL_OPERAND1_RGB,     GL_OPERAND2_RGB, GL_OPERAND0_ALPHA, GL_OPERAND1_ALPHA, GL_OPERAND2_ALPHA,
      GL_RGB_SCALE,        GL_ALPHA_SCALE};
  GLint active = 0;
  gl.GetIntegerv(GL_ACTIVE_TEXTURE, &active);
  gl.ActiveTexture(GL_TEXTURE0);
  for (const GLenum name : names) {
    GLfloat value = 0;
    gl.GetTexEnvfv(GL_TEXTURE_ENV, name, &value);
    key.push_back(value);
  }
  std::array<GLfloat, 4> colour{};
  gl.GetTexEnvfv(GL_TEXTURE_ENV, GL_TEXTURE_ENV_COLOR, colour.data());
  key.insert(key.end(), colour.begin(), colour.end());
  gl.ActiveTexture(GLenum(active));
}

void append_fog_state(const DispatchTable& gl, std::vector<float>& key) {
  std::array<GLfloat, 4> colour{};
  gl.GetFloatv(GL_FOG_COLOR, colour.data());
  key.insert(key.end(), colour.begin(), colour.end());
  for (const GLenum name : {GL_FOG_MODE, GL_FOG_DENSITY, GL_FOG_START, GL_FOG_END}) {
    GLfloat value = 0;
    gl.GetFloatv(name, &value);
    key.push_back(value);
  }
}

/// Returns fog over the run: its scalar, observed at every vertex, as an affine map of the position. The map is
/// fitted like a camera with one coordinate.
volume::Fog placed_fog(const Pipeline& pipeline, const RecognisedRun& run, const MeasuredFog& measured) {
  std::vector<ObservedVertex> vertices = run.polygons.vertices;
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    const float number =
        pipeline.fog ? run.fog_numbers[v] : run.capture->value(v, measured.input, measured.component);
    vertices[v].clip = {number, 0, 0, 0};
  }
  const auto fit = fit_camera(vertices);
  if (!fit || fit->residual > max_fit_residual) throw Refusal{"fog is not an affine map of the position"};
  const double scale = 1.0 / (double(measured.high) - measured.low);
  volume::Fog fog;
  for (std::size_t k = 0; k < 3; ++k) fog.normal[k] = fit->texture_to_clip[k] * scale;
  fog.offset = (fit->texture_to_clip[3] - measured.low) * scale;
  fog.entries = measured.entries;
  return fog;
}

}  // namespace

/// All that colours depend on: `values` decide whether colours must be probed, `inputs` whether an image must
/// be compared.
struct Classifier::Key {
  std::vector<float> values;
  VerificationSchedule::Inputs inputs;

  /// Appends all `values` from index `first` on to `inputs`.
  void take_inputs_from(std::size_t first,
                        VerificationSchedule::Effect effect = VerificationSchedule::Effect::measured) {
    for (std::size_t i = first; i < values.size(); ++i) inputs.push_back({values[i], effect});
  }

  void append_uniforms(std::span<const UniformValue> uniforms) {
    for (const UniformValue& uniform : uniforms) {
      const auto [rounded, remainder] = uniform.floats();
      values.insert(values.end(), {rounded, remainder});
    }
  }
};

void Classifier::append_program(const Pipeline& pipeline, const RecognisedRun& run, Key& key) {
  const ProgramStages& parts = programs_.stages(pipeline.program, *run.fragment.record);
  const std::size_t link = key.values.size();
  append_exactly(run.fragment.record->link, key.values);
  key.take_inputs_from(link, VerificationSchedule::Effect::unknown);
  const auto values = fragment_uniform_values(context_, pipeline.program, parts);
  key.append_uniforms(values);
  const ProgramFindings& says = programs_.findings(pipeline, values, Subject::slices);
  if (auto refusal = refusal_of_slices(says, run.fragment, !run.slice_segments.empty()))
    throw Refusal{std::move(*refusal)};
  for (const auto& input : uniform_inputs(says, values)) key.inputs.push_back(input);
}

void Classifier::append_assembly(const Pipeline& pipeline, const RecognisedRun& run, Key& key) {
  const std::size_t text = key.values.size();
  append_digest(std::as_bytes(std::span(pipeline.assembly)), key.values);
  key.take_inputs_from(text, VerificationSchedule::Effect::unknown);
  const ProgramFindings& says = programs_.findings_of_assembly(pipeline);
  if (auto refusal = refusal_of_assembly(pipeline, says, run.fragment)) throw Refusal{std::move(*refusal)};
  const auto values = assembly_values(*context_.gl, says);
  key.append_uniforms(values);
  for (const auto& input : uniform_inputs(says, values)) key.inputs.push_back(input);
}

void Classifier::append_tables(const Pipeline& pipeline, Key& key) const {
  for (const SampledTexture& table : pipeline.others) {
    append_exactly(table.texture, key.values);
    append_exactly(group_.texture_version(table.texture), key.values);
    append_lookup(context_, table.target, table.unit, key.values);
    if (group_.is_rendered_to(table.texture))
      key.values.push_back(std::nanf(""));  // never equal: probed every time
  }
}

Classifier::Key Classifier::key_of(const Pipeline& pipeline, const RecognisedRun& run,
                                   const TextureDescription& texture, const std::array<float, 2>& range) {
  const DispatchTable& gl = *context_.gl;
  Key key{{range[0], range[1], pipeline.blending.premultiplied ? 1.0F : 0.0F, float(texture.base),
           texture.opaque ? 1.0F : 0.0F, float(texture.type), float(pipeline.blending.op),
           pipeline.target.floating ? 1.0F : 0.0F},
          {}};
  for (const GLint swizzle : texture.swizzle) key.values.push_back(float(swizzle));
  if (!context_.core) append_fragment_operations(gl, key.values);
  key.take_inputs_from(0);
  const bool program = run.fragment.record != nullptr || !pipeline.assembly.empty();
  if (run.fragment.record != nullptr) {
    append_program(pipeline, run, key);
  } else if (program) {
    append_assembly(pipeline, run, key);
  } else {
    const std::size_t of_texture = key.values.size();
    append_fixed_function_state(gl, key.values);
    if (pipeline.fog) append_fog_state(gl, key.values);
    key.take_inputs_from(of_texture);
  }
  const std::size_t without_tables = key.values.size();
  append_tables(pipeline, key);
  // In a program that is not refused, only samples address the tables.
  using Effect = VerificationSchedule::Effect;
  const Effect of_samples = effect_on_samples(texture, range, table_entries(texture, range), Effect::predicted);
  key.take_inputs_from(without_tables, program ? of_samples : Effect::measured);
  return key;
}

std::string_view Classifier::why_probed(const KnownColours& known, const std::vector<float>& key,
                                        const InputRange& range) const {
  if (!known.probed) return "the first of the volume";
  if (key != known.probed_under) return "tables, uniforms or state that colours depend on changed";
  if (!known.probed->range.covers(range)) return "fog goes further than it was known";
  return session_.disabled_optimizations(Optimization::known_colours) ? "asked to" : "";
}

void Classifier::count_probe(std::string_view why) {
  account_.note([&](FrameRecord& frame) {
    Amount& probes = frame.amount(Optimization::known_colours);
    ++(why.empty() ? probes.left_out : probes.done);
  });
  if (!why.empty()) count_done(Optimization::known_colours, why);
}

SliceColours Classifier::classify(const Pipeline& pipeline, const RecognisedRun& run,
                                  const TextureDescription& texture, const std::array<float, 2>& range,
                                  KnownColours& known, VolumeCounters& counters) {
  Key key = key_of(pipeline, run, texture, range);
  const std::string_view why = why_probed(known, key.values, run.fragment.range);
  count_probe(why);
  if (!why.empty()) {
    ProbeFinding finding = probe_classification(context_, pipeline, texture, run.fragment, range);
    if (const auto* refusal = std::get_if<Refusal>(&finding)) throw *refusal;
    known.probed = std::get<Probed>(std::move(finding));
    known.probed_under = std::move(key.values);
    counters.probes.fetch_add(1, std::memory_order_relaxed);
  }
  SliceColours colours{known.probed->classification, {}, {}, std::move(key.inputs)};
  if (known.probed->fog) colours.fog = placed_fog(pipeline, run, *known.probed->fog);
  for (const ObservedSegment& observed : run.slice_segments) {
    if (observed.input == known.probed->segment_end) colours.slice_segment = observed.slice_segment;
  }
  if (known.probed->segment_end && !colours.slice_segment)
    throw Refusal{"the second coordinate of segments is neither a fixed way off nor on the ray"};
  return colours;
}

}  // namespace understudy::spu
