// From the application's pipeline to the request's colours: probed where they are not known.
#include <cmath>
#include <string_view>

#include "spu/track/track.h"
#include "spu/volume/substitution.h"
#include "volume/fog.h"

namespace understudy::spu {
namespace {

/// Everything that fixed-function fragments depend on, as numbers to compare.
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

void append_alpha_test(const DispatchTable& gl, std::vector<float>& key) {
  GLfloat value = 0;
  key.push_back(gl.IsEnabled(GL_ALPHA_TEST) ? 1.0F : 0.0F);
  gl.GetFloatv(GL_ALPHA_TEST_FUNC, &value);
  key.push_back(value);
  gl.GetFloatv(GL_ALPHA_TEST_REF, &value);
  key.push_back(value);
}

}  // namespace

std::string_view VolumeUnit::why_probed(const KnownVolume& known, const std::vector<float>& key,
                                        const InputRange& range) const {
  if (!known.probed) return "the first of the volume";
  if (key != known.probed_under) return "tables, uniforms or state that colours depend on changed";
  if (!known.probed->range.covers(range)) return "fog goes further than it was known";
  return session_->disabled_optimizations(Optimization::known_colours) ? "asked to" : "";
}

void VolumeUnit::count_probe(std::string_view why) {
  note([&](FrameRecord& frame) {
    Amount& probes = frame.amount(Optimization::known_colours);
    ++(why.empty() ? probes.left_out : probes.done);
  });
  if (!why.empty()) count_done(Optimization::known_colours, why);
}

const ProgramFindings& VolumeUnit::findings(const Substitution& s, std::span<const UniformValue> values) {
  const GLuint program = s.pipeline.program;
  const auto record = chain_.group().programs().program(program);
  auto& [link, text] = texts_[program];
  if (link != record->link) {
    text = {};
    link = record->link;
  }
  const DispatchTable& gl = *context().gl;
  const SamplerRoles roles = sampler_roles(gl, s.pipeline, samplers_.of(gl, program, record->link));
  const ProgramFindings* const found =
      text.findings(record->fragment_sources, context().extensions, roles, values);
  if (found == nullptr) throw Refusal{text.trouble()};
  return *found;
}

void VolumeUnit::classify(Substitution& s) {
  const DispatchTable& gl = *context().gl;
  KnownVolume& known = s.volume;
  std::vector<float> key{known.range[0],
                         known.range[1],
                         s.pipeline.blending.premultiplied ? 1.0F : 0.0F,
                         float(known.texture.base),
                         known.texture.opaque ? 1.0F : 0.0F,
                         float(known.texture.type),
                         float(s.pipeline.blending.op),
                         s.pipeline.target.floating ? 1.0F : 0.0F};
  for (const GLint swizzle : known.texture.swizzle) key.push_back(float(swizzle));
  if (!context().core) append_alpha_test(gl, key);
  for (const float value : key) s.inputs.push_back({value});
  if (s.fragment.record != nullptr) {
    const ProgramStages& parts = stages(s.pipeline.program, *s.fragment.record);
    key.push_back(float(s.fragment.record->link));
    s.inputs.push_back({key.back(), VerificationSchedule::Effect::unknown});
    const auto values = fragment_uniform_values(context(), s.pipeline.program, parts);
    for (const UniformValue& value : values) key.push_back(value.value);
    const ProgramFindings& says = findings(s, values);
    if (std::string reason = refusal_of_slices(parts, says, s.fragment, !s.slice_segments.empty());
        !reason.empty())
      throw Refusal{std::move(reason)};
    for (const auto& input : uniform_inputs(says, values)) s.inputs.push_back(input);
  } else if (s.pipeline.assembly) {
    key.push_back(std::nanf(""));  // its parameters may be any state of the context: probed every time
  } else {
    append_fixed_function_state(gl, key);
    if (s.pipeline.fog) append_fog_state(gl, key);
  }
  if (s.fragment.record == nullptr) {
    for (std::size_t i = s.inputs.size(); i < key.size(); ++i) s.inputs.push_back({key[i]});
  }
  const std::size_t without_tables = key.size();
  for (const SampledTexture& table : s.pipeline.others) {
    key.push_back(float(table.texture));
    key.push_back(float(chain_.group().texture_version(table.texture)));
    if (chain_.group().is_rendered_to(table.texture))
      key.push_back(std::nanf(""));  // never equal: probed every time
  }
  for (std::size_t i = without_tables; i < key.size(); ++i) s.inputs.push_back({key[i]});
  const std::string_view why = why_probed(known, key, s.fragment.range);
  count_probe(why);
  if (!why.empty()) {
    ProbeFinding finding = probe_classification(context(), s.pipeline, known.texture, s.fragment, known.range);
    if (const auto* reason = std::get_if<std::string>(&finding)) throw Refusal{*reason};
    known.probed = std::get<Probed>(std::move(finding));
    known.probed_under = std::move(key);
    known.counters->probes.fetch_add(1, std::memory_order_relaxed);
  }
  s.request.classification = known.probed->classification;
  if (known.probed->fog) place_fog(s, *known.probed->fog);
  for (const ObservedSegment& observed : s.slice_segments) {
    if (observed.input == known.probed->segment_end) s.request.slice_segment = observed.slice_segment;
  }
  if (known.probed->segment_end && !s.request.slice_segment)
    throw Refusal{"the second coordinate of segments is neither a fixed way off nor on the ray"};
}

void VolumeUnit::place_fog(Substitution& s, const MeasuredFog& measured) {
  // The number, observed at every vertex, as a map of the position: a camera that sees one coordinate.
  std::vector<ObservedVertex> vertices = s.polygons.vertices;
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    const float number =
        s.pipeline.fog ? s.fog_numbers[v] : s.capture->value(v, measured.input, measured.component);
    vertices[v].clip = {number, 0, 0, 0};
  }
  const auto fit = fit_camera(vertices);
  if (!fit || fit->residual > max_fit_residual) throw Refusal{"fog is not an affine map of the position"};
  const double scale = 1.0 / (double(measured.high) - measured.low);
  volume::Fog& fog = s.request.fog.emplace();
  for (std::size_t k = 0; k < 3; ++k) fog.normal[k] = fit->texture_to_clip[k] * scale;
  fog.offset = (fit->texture_to_clip[3] - measured.low) * scale;
  fog.entries = measured.entries;
}

}  // namespace understudy::spu
