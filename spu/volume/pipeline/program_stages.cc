// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/pipeline/program_stages.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <functional>
#include <limits>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "spu/track/program_sources.h"
#include "spu/volume/context/context.h"
#include "spu/volume/pipeline/active_uniform.h"
#include "spu/volume/pipeline/block_members.h"
#include "spu/volume/pipeline/built_in_uniform.h"
#include "spu/volume/program/analysis.h"
#include "spu/volume/program/element_names.h"

namespace understudy::spu {
namespace {

struct UniformShape {
  int components = 0;
  enum class Kind { real, integer, natural, precise, matrix, precise_matrix } kind = Kind::real;
};

struct TypedShape {
  GLenum type;
  UniformShape shape;
};
using Kind = UniformShape::Kind;
constexpr auto uniform_shapes = std::to_array<TypedShape>({
    {GL_FLOAT, {1, Kind::real}},
    {GL_FLOAT_VEC2, {2, Kind::real}},
    {GL_FLOAT_VEC3, {3, Kind::real}},
    {GL_FLOAT_VEC4, {4, Kind::real}},
    {GL_FLOAT_MAT2, {4, Kind::matrix}},
    {GL_FLOAT_MAT2x3, {6, Kind::matrix}},
    {GL_FLOAT_MAT3x2, {6, Kind::matrix}},
    {GL_FLOAT_MAT2x4, {8, Kind::matrix}},
    {GL_FLOAT_MAT4x2, {8, Kind::matrix}},
    {GL_FLOAT_MAT3, {9, Kind::matrix}},
    {GL_FLOAT_MAT3x4, {12, Kind::matrix}},
    {GL_FLOAT_MAT4x3, {12, Kind::matrix}},
    {GL_FLOAT_MAT4, {16, Kind::matrix}},
    {GL_UNSIGNED_INT, {1, Kind::natural}},
    {GL_UNSIGNED_INT_VEC2, {2, Kind::natural}},
    {GL_UNSIGNED_INT_VEC3, {3, Kind::natural}},
    {GL_UNSIGNED_INT_VEC4, {4, Kind::natural}},
    {GL_INT_VEC2, {2, Kind::integer}},
    {GL_BOOL_VEC2, {2, Kind::integer}},
    {GL_INT_VEC3, {3, Kind::integer}},
    {GL_BOOL_VEC3, {3, Kind::integer}},
    {GL_INT_VEC4, {4, Kind::integer}},
    {GL_BOOL_VEC4, {4, Kind::integer}},
    {GL_INT, {1, Kind::integer}},
    {GL_BOOL, {1, Kind::integer}},
    {GL_DOUBLE, {1, Kind::precise}},
    {GL_DOUBLE_VEC2, {2, Kind::precise}},
    {GL_DOUBLE_VEC3, {3, Kind::precise}},
    {GL_DOUBLE_VEC4, {4, Kind::precise}},
    {GL_DOUBLE_MAT2, {4, Kind::precise_matrix}},
    {GL_DOUBLE_MAT2x3, {6, Kind::precise_matrix}},
    {GL_DOUBLE_MAT3x2, {6, Kind::precise_matrix}},
    {GL_DOUBLE_MAT2x4, {8, Kind::precise_matrix}},
    {GL_DOUBLE_MAT4x2, {8, Kind::precise_matrix}},
    {GL_DOUBLE_MAT3, {9, Kind::precise_matrix}},
    {GL_DOUBLE_MAT3x4, {12, Kind::precise_matrix}},
    {GL_DOUBLE_MAT4x3, {12, Kind::precise_matrix}},
    {GL_DOUBLE_MAT4, {16, Kind::precise_matrix}},
});

constexpr auto sampler_types = std::to_array<GLenum>({
    GL_SAMPLER_1D,
    GL_SAMPLER_2D,
    GL_SAMPLER_3D,
    GL_SAMPLER_CUBE,
    GL_SAMPLER_1D_SHADOW,
    GL_SAMPLER_2D_SHADOW,
    GL_SAMPLER_2D_RECT,
    GL_SAMPLER_2D_RECT_SHADOW,
    GL_SAMPLER_1D_ARRAY,
    GL_SAMPLER_2D_ARRAY,
    GL_SAMPLER_BUFFER,
    GL_SAMPLER_1D_ARRAY_SHADOW,
    GL_SAMPLER_2D_ARRAY_SHADOW,
    GL_SAMPLER_CUBE_SHADOW,
    GL_SAMPLER_CUBE_MAP_ARRAY,
    GL_SAMPLER_CUBE_MAP_ARRAY_SHADOW,
    GL_SAMPLER_2D_MULTISAMPLE,
    GL_SAMPLER_2D_MULTISAMPLE_ARRAY,
    GL_INT_SAMPLER_1D,
    GL_INT_SAMPLER_2D,
    GL_INT_SAMPLER_3D,
    GL_INT_SAMPLER_CUBE,
    GL_INT_SAMPLER_2D_RECT,
    GL_INT_SAMPLER_1D_ARRAY,
    GL_INT_SAMPLER_2D_ARRAY,
    GL_INT_SAMPLER_BUFFER,
    GL_INT_SAMPLER_CUBE_MAP_ARRAY,
    GL_INT_SAMPLER_2D_MULTISAMPLE,
    GL_INT_SAMPLER_2D_MULTISAMPLE_ARRAY,
    GL_UNSIGNED_INT_SAMPLER_1D,
    GL_UNSIGNED_INT_SAMPLER_2D,
    GL_UNSIGNED_INT_SAMPLER_3D,
    GL_UNSIGNED_INT_SAMPLER_CUBE,
    GL_UNSIGNED_INT_SAMPLER_2D_RECT,
    GL_UNSIGNED_INT_SAMPLER_1D_ARRAY,
    GL_UNSIGNED_INT_SAMPLER_2D_ARRAY,
    GL_UNSIGNED_INT_SAMPLER_BUFFER,
    GL_UNSIGNED_INT_SAMPLER_CUBE_MAP_ARRAY,
    GL_UNSIGNED_INT_SAMPLER_2D_MULTISAMPLE,
    GL_UNSIGNED_INT_SAMPLER_2D_MULTISAMPLE_ARRAY,
});

bool is_sampler(GLenum type) {
  return std::ranges::find(sampler_types, type) != sampler_types.end();
}

/// How a uniform type is read; `components` is 0 for types that are not known.
UniformShape shape_of(GLenum type) {
  if (is_sampler(type)) return {1, Kind::integer};
  const auto found = std::ranges::find(uniform_shapes, type, &TypedShape::type);
  return found == uniform_shapes.end() ? UniformShape{} : found->shape;
}

template <class Visit>
void for_each_uniform(const DispatchTable& gl, GLuint program, Visit visit) {
  GLint count = 0;
  gl.GetProgramiv(program, GL_ACTIVE_UNIFORMS, &count);
  for (GLint i = 0; i < count; ++i) {
    auto [text, type, size] = active_uniform(gl, program, GLuint(i));
    // Arrays are listed by their first element.
    const bool array = text.ends_with("[0]");
    if (array) text.resize(text.size() - 3);
    for (GLint element = 0; element < size; ++element) {
      visit(array ? text + "[" + std::to_string(element) + "]" : text, type);
    }
  }
}

using MatrixSetter = decltype(DispatchTable::UniformMatrix2fv) DispatchTable::*;

/// Returns null for types that are no matrices of floats.
MatrixSetter matrix_setter(GLenum type) {
  using T = DispatchTable;
  static constexpr auto setters = std::to_array<std::pair<GLenum, MatrixSetter>>({
      {GL_FLOAT_MAT2, &T::UniformMatrix2fv},
      {GL_FLOAT_MAT2x3, &T::UniformMatrix2x3fv},
      {GL_FLOAT_MAT2x4, &T::UniformMatrix2x4fv},
      {GL_FLOAT_MAT3, &T::UniformMatrix3fv},
      {GL_FLOAT_MAT3x2, &T::UniformMatrix3x2fv},
      {GL_FLOAT_MAT3x4, &T::UniformMatrix3x4fv},
      {GL_FLOAT_MAT4, &T::UniformMatrix4fv},
      {GL_FLOAT_MAT4x2, &T::UniformMatrix4x2fv},
      {GL_FLOAT_MAT4x3, &T::UniformMatrix4x3fv},
  });
  const auto found = std::ranges::find(setters, type, &std::pair<GLenum, MatrixSetter>::first);
  return found == setters.end() ? nullptr : found->second;
}

/// Copies the uniform of `to`, which is in use. Returns false for types that are not copied.
bool copy_uniform(const DispatchTable& gl, GLuint from, GLint source, GLint target, GLenum type) {
  using T = DispatchTable;
  const UniformShape shape = shape_of(type);
  if (shape.components == 0) return false;
  const auto copy = [&]<class Number>(Number, auto get, const auto& setters) {
    std::array<Number, 4> value{};
    (gl.*get)(from, source, value.data());
    (gl.*setters[std::size_t(shape.components - 1)])(target, 1, value.data());
    return true;
  };
  switch (shape.kind) {
    case Kind::real:
      return copy(GLfloat(), &T::GetUniformfv,
                  std::array{&T::Uniform1fv, &T::Uniform2fv, &T::Uniform3fv, &T::Uniform4fv});
    case Kind::integer:
      return copy(GLint(), &T::GetUniformiv,
                  std::array{&T::Uniform1iv, &T::Uniform2iv, &T::Uniform3iv, &T::Uniform4iv});
    case Kind::natural:
      return copy(GLuint(), &T::GetUniformuiv,
                  std::array{&T::Uniform1uiv, &T::Uniform2uiv, &T::Uniform3uiv, &T::Uniform4uiv});
    case Kind::precise:
      return copy(GLdouble(), &T::GetUniformdv,
                  std::array{&T::Uniform1dv, &T::Uniform2dv, &T::Uniform3dv, &T::Uniform4dv});
    case Kind::matrix: {
      std::array<GLfloat, 16> value{};
      gl.GetUniformfv(from, source, value.data());
      (gl.*matrix_setter(type))(target, 1, GL_FALSE, value.data());
      return true;
    }
    case Kind::precise_matrix:
      break;
  }
  return false;
}

GLuint compile(const DispatchTable& gl, GLenum stage, const std::vector<std::string>& sources, GLuint program) {
  for (const std::string& source : sources) {
    const GLuint shader = gl.CreateShader(stage);
    const char* text = source.c_str();
    gl.ShaderSource(shader, 1, &text, nullptr);
    gl.CompileShader(shader);
    gl.AttachShader(program, shader);
    gl.DeleteShader(shader);  // lives as long as it is attached
  }
  return program;
}

bool linked(const DispatchTable& gl, GLuint program) {
  gl.LinkProgram(program);
  GLint status = 0;
  gl.GetProgramiv(program, GL_LINK_STATUS, &status);
  return status != 0;
}

std::string link_log(const DispatchTable& gl, GLuint program) {
  std::array<char, 200> log{};
  gl.GetProgramInfoLog(program, GLsizei(log.size()), nullptr, log.data());
  return log.data();
}

/// Returns the name by which a vertex shader writes what the fragment stage reads. Mesa lists gl_TexCoord[0],
/// once lowered, as gl_in_TexCoord0.
std::string written_name(const std::string& read) {
  for (const std::string_view prefix : {"gl_in_TexCoord", "gl_TexCoord"}) {
    if (!read.starts_with(prefix)) continue;
    const std::size_t digit = read.find_first_of("0123456789", prefix.size());
    if (digit == std::string::npos) return read;
    const std::size_t end = read.find_first_not_of("0123456789", digit);
    return "gl_TexCoord[" + read.substr(digit, end == std::string::npos ? end : end - digit) + "]";
  }
  if (read == "gl_Color") return "gl_FrontColor";
  if (read == "gl_SecondaryColor") return "gl_FrontSecondaryColor";
  if (read == "gl_FogFragCoord") return read;
  return read;
}

/// Queries which inputs the fragment stage, linked alone, reads.
void describe_fragment_stage(const GlContext& context, const ProgramRecord& record, ProgramStages& stages) {
  const DispatchTable& gl = *context.gl;
  const GLuint program = compile(gl, GL_FRAGMENT_SHADER, record.fragment_sources, gl.CreateProgram());
  gl.ProgramParameteri(program, GL_PROGRAM_SEPARABLE, GL_TRUE);
  if (!linked(gl, program)) {
    stages.trouble = "the fragment shader does not link alone";
  } else {
    GLint count = 0;
    gl.GetProgramInterfaceiv(program, GL_PROGRAM_INPUT, GL_ACTIVE_RESOURCES, &count);
    for (GLint i = 0; i < count; ++i) {
      std::array<char, 256> name{};
      gl.GetProgramResourceName(program, GL_PROGRAM_INPUT, GLuint(i), GLsizei(name.size()), nullptr,
                                name.data());
      const std::array<GLenum, 3> asked{GL_TYPE, GL_ARRAY_SIZE, GL_LOCATION};
      std::array<GLint, 3> answer{};
      gl.GetProgramResourceiv(program, GL_PROGRAM_INPUT, GLuint(i), 3, asked.data(), 3, nullptr, answer.data());
      StageInput input;
      input.name = written_name(name.data());
      input.type = GLenum(answer[0]);
      input.location = answer[2];
      const UniformShape shape = shape_of(input.type);
      if (input.name == "gl_FragCoord" || input.name == "gl_FrontFacing" || input.name == "gl_PointCoord") {
        if (stages.trouble.empty()) stages.trouble = "the fragment shader reads " + input.name;
        continue;
      }
      const bool probed =
          shape.kind == Kind::real || shape.kind == Kind::integer || shape.kind == Kind::natural;
      if (shape.components == 0 || !probed || answer[1] > 1) {
        if (stages.trouble.empty())
          stages.trouble = "the fragment shader reads " + input.name + ", of a type that is not probed";
        stages.unprobed.push_back({.name = std::string(program::variable_of(input.name)),
                                   .components = components_of_type(input.type),
                                   .elements = std::size_t(std::max(answer[1], 1)),
                                   .array = answer[1] > 1 || input.name.ends_with("[0]")});
        continue;
      }
      input.components = shape.components;
      input.integer = shape.kind != UniformShape::Kind::real;
      stages.inputs.push_back(input);
    }
  }
  for_each_uniform(gl, program, [&](const std::string& name, GLenum type) {
    stages.uniforms.push_back({name, type});
  });
  GLint blocks = 0;
  if (context.version >= 310) gl.GetProgramiv(program, GL_ACTIVE_UNIFORM_BLOCKS, &blocks);
  stages.uniform_blocks = blocks > 0;
  gl.DeleteProgram(program);
}

const char* glsl_type(const StageInput& input) {
  switch (input.type) {
    case GL_FLOAT:
      return "float";
    case GL_FLOAT_VEC2:
      return "vec2";
    case GL_FLOAT_VEC3:
      return "vec3";
    case GL_FLOAT_VEC4:
      return "vec4";
    case GL_INT:
      return "int";
    case GL_UNSIGNED_INT:
      return "uint";
    case GL_INT_VEC2:
      return "ivec2";
    case GL_INT_VEC3:
      return "ivec3";
    case GL_INT_VEC4:
      return "ivec4";
    default:
      return "vec4";
  }
}

/// Links the application's vertex stage to capture gl_Position and the outputs `names`; returns 0 and the
/// driver's log in `trouble` if that fails.
GLuint link_observer(const GlContext& context, const ProgramRecord& record, GLuint application,
                     const std::vector<const char*>& names, std::string& trouble) {
  const DispatchTable& gl = *context.gl;
  const GLuint program = compile(gl, GL_VERTEX_SHADER, record.vertex_sources, gl.CreateProgram());
  GLint attributes = 0;
  gl.GetProgramiv(application, GL_ACTIVE_ATTRIBUTES, &attributes);
  for (GLint i = 0; i < attributes; ++i) {
    std::array<char, 256> name{};
    GLint size = 0;
    GLenum type = 0;
    gl.GetActiveAttrib(application, GLuint(i), GLsizei(name.size()), nullptr, &size, &type, name.data());
    const GLint location = gl.GetAttribLocation(application, name.data());
    if (location >= 0) gl.BindAttribLocation(program, GLuint(location), name.data());
  }
  std::vector<const char*> captured{"gl_Position"};
  captured.insert(captured.end(), names.begin(), names.end());
  gl.TransformFeedbackVaryings(program, GLsizei(captured.size()), captured.data(), GL_INTERLEAVED_ATTRIBS);
  if (linked(gl, program)) return program;
  trouble = link_log(gl, program);
  gl.DeleteProgram(program);
  return 0;
}

/// Returns the facts about the sources of one stage; null if they cannot be analysed.
std::optional<program::StageFacts> facts_of(const GlContext& context, program::Stage stage,
                                            const std::vector<std::string>& sources) {
  program::StageFinding finding = program::analyse(stage, sources, {}, context.extensions);
  auto* facts = std::get_if<program::StageFacts>(&finding);
  return facts == nullptr ? std::nullopt : std::optional(std::move(*facts));
}

const char* qualifier_of(program::Interpolation interpolation) {
  switch (interpolation) {
    case program::Interpolation::flat:
      return "flat";
    case program::Interpolation::no_perspective:
      return "noperspective";
    case program::Interpolation::smooth:
      break;
  }
  return "";
}

/// Returns the name of a member of an interface block within the block.
std::string_view name_in_block(const auto& member) {
  const std::string_view name = member.name;
  const std::string prefix = member.block + ".";
  return name.starts_with(prefix) ? name.substr(prefix.size()) : name;
}

/// Returns the vertex stage's output that the fragment stage reads as `read`. Stages match members of blocks by
/// the names of block and member (the block may have an instance name in one of the stages only), variables
/// with a location by location, and others by name.
const program::Output* output_read(const program::StageFacts& vertex, const program::Input& read) {
  const auto written = std::ranges::find_if(vertex.outputs, [&](const program::Output& output) {
    if (!read.block.empty()) return output.block == read.block && name_in_block(output) == name_in_block(read);
    if (read.location >= 0) return output.location == read.location && output.packed_at == read.packed_at;
    return program::variable_of(output.name) == program::variable_of(read.name);
  });
  return written == vertex.outputs.end() ? nullptr : &*written;
}

/// Gets from the sources what queries do not report: how inputs are interpolated, and which outputs of the
/// vertex stage they read. If a source cannot be analysed, inputs remain smooth and are matched by name: its
/// volume is refused. Returns false if what is captured of the vertex stage would not be what the fragment
/// stage reads.
bool read_texts(const GlContext& context, const ProgramRecord& record,
                const std::optional<program::StageFacts>& vertex, ProgramStages& stages) {
  for (StageInput& input : stages.inputs) input.output = input.name;
  for (UnprobedInput& input : stages.unprobed) input.output = input.name;
  const auto fragment = facts_of(context, program::Stage::fragment, record.fragment_sources);
  if (!fragment) return true;
  for (StageInput& input : stages.inputs) {
    const auto read = std::ranges::find(fragment->inputs, input.name, &program::Input::name);
    if (read == fragment->inputs.end()) continue;
    input.interpolation = qualifier_of(read->interpolation);
    input.block = read->block;
    input.place_in_block = read - fragment->inputs.begin();
    if ((read->location < 0 && read->block.empty()) || !record.vertex_shader) continue;
    if (!vertex) {
      stages.trouble = "the vertex shader is not understood, and " + input.name + " is read by its location";
      return false;
    }
    const program::Output* const written = output_read(*vertex, *read);
    if (written == nullptr) continue;
    input.output = written->name;
    if (written->components == input.components) continue;
    stages.trouble = fmt::format("the vertex shader writes {} components of {}, the fragment shader reads {}",
                                 written->components, input.name, input.components);
    return false;
  }
  for (UnprobedInput& input : stages.unprobed) {
    const auto read = std::ranges::find_if(fragment->inputs, [&](const program::Input& declared) {
      return program::variable_of(declared.name) == input.name;
    });
    if (read == fragment->inputs.end() || !vertex) continue;
    if (const program::Output* const written = output_read(*vertex, *read))
      input.output = std::string(program::variable_of(written->name));
  }
  return true;
}

/// Returns whether the output depends on one of `sources`.
bool depends_on(const program::Output& output, const std::set<std::uint32_t>& sources) {
  return std::ranges::any_of(output.on,
                             [&](const program::Dependence& on) { return sources.contains(on.source); });
}

/// Returns the sources, scalars of a uniform, that do not reach the position.
std::set<std::uint32_t> sources_beside_position(const program::StageFacts& vertex, const std::string& uniform) {
  std::set<std::uint32_t> sources;
  for (std::uint32_t i = 0; i < vertex.sources.size(); ++i) {
    const program::Source& source = vertex.sources[i];
    const bool is_uniform =
        source.kind == program::SourceKind::uniform || source.kind == program::SourceKind::uniform_block;
    if (is_uniform && program::may_be_same_element(source.name, uniform)) sources.insert(i);
  }
  for (const program::Output& output : vertex.outputs) {
    if (output.name != "gl_Position") continue;
    for (const program::Dependence& on : output.on) sources.erase(on.source);
  }
  return sources;
}

/// Returns what the uniform reaches, as in VertexUniform.
std::vector<InputComponent> components_reached(const std::optional<program::StageFacts>& vertex,
                                               const std::string& uniform, const ProgramStages& stages) {
  std::vector<InputComponent> reached;
  const auto sources = vertex ? sources_beside_position(*vertex, uniform) : std::set<std::uint32_t>();
  for (const StageInput& input : stages.inputs) {
    if (!vertex) {
      for (int c = 0; c < input.components; ++c) reached.push_back({input.name, c});
      continue;
    }
    for (const program::Output& output : vertex->outputs) {
      if (output.name == input.output && depends_on(output, sources))
        reached.push_back({input.name, output.component});
    }
  }
  for (const UnprobedInput& input : stages.unprobed) {
    if (!vertex) reached.push_back({input.name, 0});
    for (std::size_t i = 0; vertex && i < vertex->outputs.size(); ++i) {
      const program::Output& output = vertex->outputs[i];
      const std::size_t variable = program::variable_of(output.name).size();
      if (output.name.substr(0, variable) == input.output && depends_on(output, sources))
        reached.push_back({input.name + output.name.substr(variable), output.component});
    }
  }
  return reached;
}

bool is_image(GLenum type) {
  return type >= GL_IMAGE_1D && type <= GL_UNSIGNED_INT_IMAGE_2D_MULTISAMPLE_ARRAY;
}

/// Returns the name of a shader storage block of the program; empty: it has none.
std::string storage_block_of(const GlContext& context, GLuint program) {
  constexpr int first_version_with_storage = 430;
  if (context.version < first_version_with_storage) return {};
  const DispatchTable& gl = *context.gl;
  GLint blocks = 0;
  gl.GetProgramInterfaceiv(program, GL_SHADER_STORAGE_BLOCK, GL_ACTIVE_RESOURCES, &blocks);
  if (blocks == 0) return {};
  std::array<char, 256> name{};
  gl.GetProgramResourceName(program, GL_SHADER_STORAGE_BLOCK, 0, GLsizei(name.size()), nullptr, name.data());
  return name.data();
}

/// Returns what the vertex stage may write to besides its outputs: of a source that cannot be analysed,
/// whatever OpenGL lists for `alone`, a program of this stage. Empty: nothing.
std::string written_by(const GlContext& context, const std::optional<program::StageFacts>& vertex,
                       GLuint alone) {
  if (vertex) return vertex->side_effects.empty() ? std::string() : vertex->side_effects.front().name;
  if (alone == 0) return {};
  std::string written = storage_block_of(context, alone);
  for_each_uniform(*context.gl, alone, [&](const std::string& name, GLenum type) {
    if (is_image(type) || type == GL_UNSIGNED_INT_ATOMIC_COUNTER) written = name;
  });
  return written;
}

/// Finds the uniforms that reach inputs. All uniforms of the observer reach the position or an input.
void find_behind_inputs(const GlContext& context, const std::optional<program::StageFacts>& vertex,
                        GLuint application, ProgramStages& stages) {
  std::vector<BlockMember> members = block_members(context, application);
  for_each_uniform(*context.gl, stages.observer, [&](const std::string& name, GLenum type) {
    const bool in_block = std::ranges::any_of(
        members, [&](const BlockMember& member) { return program::may_be_same_element(member.name, name); });
    const bool in_fragments =
        std::ranges::find(stages.uniforms, name, &StageUniform::name) != stages.uniforms.end();
    if (name.starts_with("gl_") || in_block || in_fragments) return;
    VertexUniform uniform{{name, type}, components_reached(vertex, name, stages)};
    if (!uniform.reaches.empty()) stages.vertex_uniforms.push_back(std::move(uniform));
  });
  for (BlockMember& member : members) {
    std::vector<InputComponent> reached = components_reached(vertex, member.name, stages);
    stages.block_members.push_back({std::move(member), std::move(reached)});
  }
}

}  // namespace

std::size_t components_of_type(GLenum type) {
  return std::size_t(std::max(shape_of(type).components, 1));
}

bool is_named(const StageInput& input, const std::string& name) {
  return program::may_be_same_element(input.name, name) ||
         (name == "gl_Color" && input.name == "gl_FrontColor") ||
         (name == "gl_SecondaryColor" && input.name == "gl_FrontSecondaryColor") ||
         (name == "fragment.color.primary" && input.name == "gl_FrontColor") ||
         (name == "fragment.texcoord[0]" && input.name == "gl_TexCoord[0]");
}

ProgramStages take_apart(const GlContext& context, const ProgramRecord& record, GLuint application) {
  ProgramStages stages;
  describe_fragment_stage(context, record, stages);
  const auto vertex = record.vertex_shader ? facts_of(context, program::Stage::vertex, record.vertex_sources)
                                           : std::optional<program::StageFacts>();
  if (!read_texts(context, record, vertex, stages) || !record.vertex_shader) return stages;

  std::string trouble;
  std::vector<const char*> names;
  for (const StageInput& input : stages.inputs) names.push_back(input.output.c_str());
  for (const UnprobedInput& input : stages.unprobed) names.push_back(input.output.c_str());
  stages.observer = link_observer(context, record, application, names, trouble);
  if (stages.observer == 0) {
    // A fragment stage linked alone keeps all inputs that it declares; the vertex stage may write only some of
    // them.
    names.clear();
    const auto is_written = [&](const std::string& output) {
      const GLuint alone = link_observer(context, record, application, {output.c_str()}, trouble);
      context.gl->DeleteProgram(alone);
      if (alone != 0) names.push_back(output.c_str());
      return alone != 0;
    };
    for (StageInput& input : stages.inputs) input.written = is_written(input.output);
    const std::vector<const char*> probed = names;
    for (UnprobedInput& input : stages.unprobed) input.written = is_written(input.output);
    stages.observer = link_observer(context, record, application, names, trouble);
    // Together they may exceed the limits of transform feedback.
    if (stages.observer == 0 && names.size() > probed.size()) {
      for (UnprobedInput& input : stages.unprobed) input.captured = false;
      stages.observer = link_observer(context, record, application, probed, trouble);
    }
  }
  stages.written_by_vertices = written_by(context, vertex, stages.observer);
  if (stages.observer != 0)
    find_behind_inputs(context, vertex, application, stages);
  else if (stages.trouble.empty())
    stages.trouble = "the vertex shader does not link for capture: " + trouble;
  return stages;
}

namespace {

/// How the probe's outputs are declared: drivers require the qualifiers that the fragment stage has at its
/// inputs.
struct OutputDeclaration {
  const char* smooth;  ///< for outputs that are interpolated smoothly
  bool locations;
};

constexpr std::array<OutputDeclaration, 4> output_declarations{
    {{"", false}, {"smooth", false}, {"", true}, {"smooth", true}}};

/// Returns the name by which the probe's vertex stage writes an input. Blocks have an instance name there,
/// because stages match them by the block's own name.
std::string written_as(const StageInput& input) {
  if (input.block.empty()) return input.name;
  return fmt::format("understudy_{}.{}", input.block, name_in_block(input));
}

std::string declaration_of(const StageInput& input, const OutputDeclaration& declaration) {
  const std::string location = declaration.locations && input.location >= 0 && input.block.empty()
                                   ? fmt::format("layout(location = {}) ", input.location)
                                   : std::string();
  const char* const interpolation = input.integer                  ? "flat"
                                    : !input.interpolation.empty() ? input.interpolation.c_str()
                                                                   : declaration.smooth;
  return fmt::format("{}{} {}{} {};\n", location, interpolation, input.block.empty() ? "out " : "",
                     glsl_type(input), input.block.empty() ? input.name : name_in_block(input));
}

/// Stages match blocks by the names, types and order of all members.
std::string declarations_of(const std::vector<StageInput>& inputs, const OutputDeclaration& declaration) {
  std::string declarations;
  std::map<std::string, std::map<std::ptrdiff_t, std::string>> members_of_block;
  for (const StageInput& input : inputs) {
    if (input.name.starts_with("gl_")) continue;
    if (input.block.empty())
      declarations += declaration_of(input, declaration);
    else
      members_of_block[input.block][input.place_in_block] = declaration_of(input, declaration);
  }
  for (const auto& [block, members] : members_of_block) {
    declarations += fmt::format("out {} {{\n", block);
    for (const auto& [place, member] : members) declarations += member;
    declarations += fmt::format("}} understudy_{};\n", block);
  }
  return declarations;
}

/// The vertex stage of a probe.
std::string probe_source(const GlContext& context, const std::vector<StageInput>& inputs,
                         const std::string& coordinate, const OutputDeclaration& declaration) {
  const bool blocks = std::ranges::any_of(inputs, [](const StageInput& input) { return !input.block.empty(); });
  std::string declarations = context.core || blocks ? "#version 150\n" : "#version 130\n";
  if (declaration.locations) declarations += "#extension GL_ARB_separate_shader_objects : enable\n";
  declarations += declarations_of(inputs, declaration);
  std::string body;
  int others = 0;
  for (const StageInput& input : inputs) {
    const std::string name = written_as(input);
    if (input.name == coordinate) {
      body += "  " + name +
              (input.components == 2   ? " = unit;\n"
               : input.components == 3 ? " = vec3(unit, 0.5);\n"
                                       : " = vec4(unit, 0.5, 1.0);\n");
    } else {
      static constexpr std::array<const char*, 5> swizzle = {"", ".x", ".xy", ".xyz", ".xyzw"};
      const std::string slope =
          input.integer
              ? ""
              : fmt::format(" + unit.x * understudy_across[{0}] + unit.y * understudy_up[{0}]", others);
      body += fmt::format("  {} = {}((understudy_value[{}]{}){});\n", name, glsl_type(input), others, slope,
                          swizzle[std::size_t(input.components)]);
      ++others;
    }
  }
  if (others > 0) {
    for (const char* name : {"value", "across", "up"})
      declarations += fmt::format("uniform vec4 understudy_{}[{}];\n", name, others);
  }
  return declarations +
         "void main() {\n"
         "  vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);\n"
         "  vec2 unit = 0.5 * corner + 0.5;\n"
         "  gl_Position = vec4(corner, 0.0, 1.0);\n" +
         body + "}\n";
}

}  // namespace

GLuint probe_program(const GlContext& context, const ProgramRecord* record,
                     const std::vector<StageInput>& inputs, const std::string& coordinate,
                     std::string& trouble) {
  const DispatchTable& gl = *context.gl;
  for (const OutputDeclaration& declaration : output_declarations) {
    const std::string source = probe_source(context, inputs, coordinate, declaration);
    const GLuint program = gl.CreateProgram();
    compile(gl, GL_VERTEX_SHADER, {source}, program);
    if (record != nullptr) compile(gl, GL_FRAGMENT_SHADER, record->fragment_sources, program);
    if (linked(gl, program)) return program;
    if (trouble.empty()) trouble = "the fragment shader does not link with a probe: " + link_log(gl, program);
    gl.DeleteProgram(program);
  }
  return 0;
}

std::string not_copied(const std::string& name) {
  return fmt::format("the uniform '{}' is of a type that is not copied", name);
}

std::string copy_uniforms(const GlContext& context, GLuint from, GLuint to) {
  const DispatchTable& gl = *context.gl;
  std::string missing;
  gl.UseProgram(to);
  for_each_uniform(gl, to, [&](const std::string& name, GLenum type) {
    if (name.starts_with("gl_")) return;  // fixed-function state, the same for both
    const GLint source = gl.GetUniformLocation(from, name.c_str());
    const GLint target = gl.GetUniformLocation(to, name.c_str());
    if (source < 0 || target < 0) return;  // in a block, or not in use
    if (!copy_uniform(gl, from, source, target, type) && missing.empty()) missing = name;
  });
  GLint blocks = 0;
  if (context.version >= 310) gl.GetProgramiv(to, GL_ACTIVE_UNIFORM_BLOCKS, &blocks);
  for (GLint block = 0; block < blocks; ++block) {
    std::array<char, 256> name{};
    gl.GetActiveUniformBlockName(to, GLuint(block), GLsizei(name.size()), nullptr, name.data());
    const GLuint source = gl.GetUniformBlockIndex(from, name.data());
    GLint binding = 0;
    if (source == GL_INVALID_INDEX) continue;
    gl.GetActiveUniformBlockiv(from, source, GL_UNIFORM_BLOCK_BINDING, &binding);
    gl.UniformBlockBinding(to, GLuint(block), GLuint(binding));
  }
  return missing;
}

namespace {

/// Appends values that differ if the blocks' contents do; a NaN, which equals nothing, if they cannot be read.
void append_block_contents(const DispatchTable& gl, GLuint program, std::vector<UniformValue>& values) {
  GLint blocks = 0;
  gl.GetProgramiv(program, GL_ACTIVE_UNIFORM_BLOCKS, &blocks);
  for (GLuint block = 0; block < GLuint(blocks); ++block) {
    GLint by_fragments = 0;
    gl.GetActiveUniformBlockiv(program, block, GL_UNIFORM_BLOCK_REFERENCED_BY_FRAGMENT_SHADER, &by_fragments);
    if (by_fragments == GL_FALSE) continue;
    const auto contents = block_contents(gl, program, block);
    if (!contents) {
      values.push_back({{}, 0, std::numeric_limits<float>::quiet_NaN()});
      continue;
    }
    std::vector<float> digest;
    append_digest(*contents, digest);
    for (const float number : digest) values.push_back({{}, 0, number});
  }
}

bool is_whole(Kind kind) {
  return kind == Kind::integer || kind == Kind::natural;
}

/// Returns the values of the uniform in the program, exactly; of a built-in one, which has no location, those
/// of the state of the context. Empty if it is not in use.
std::vector<double> uniform_components(const GlContext& context, GLuint program, const StageUniform& uniform) {
  const DispatchTable& gl = *context.gl;
  if (uniform.name.starts_with("gl_")) return built_in_uniform(gl, uniform.name);
  const GLint location = gl.GetUniformLocation(program, uniform.name.c_str());
  if (location < 0) return {};
  const auto components = std::ptrdiff_t(components_of_type(uniform.type));
  const auto read = [&]<class T>(T, const auto& get) {
    std::array<T, 32> value{};  // a double takes the place of two floats in some drivers
    get(value.data());
    return std::vector<double>(value.begin(), value.begin() + components);
  };
  switch (shape_of(uniform.type).kind) {
    case Kind::integer:
      return read(GLint(), [&](GLint* value) { gl.GetUniformiv(program, location, value); });
    case Kind::natural:
      return read(GLuint(), [&](GLuint* value) { gl.GetUniformuiv(program, location, value); });
    case Kind::precise:
    case Kind::precise_matrix:
      return read(GLdouble(), [&](GLdouble* value) { gl.GetUniformdv(program, location, value); });
    default:
      return read(GLfloat(), [&](GLfloat* value) { gl.GetUniformfv(program, location, value); });
  }
}

}  // namespace

std::array<float, 2> UniformValue::floats() const {
  const auto rounded = float(value);
  return {rounded, std::isfinite(rounded) ? float(value - double(rounded)) : 0.0F};
}

void append_uniform(const GlContext& context, GLuint program, const StageUniform& uniform,
                    std::vector<float>& values) {
  const Kind kind = shape_of(uniform.type).kind;
  const bool exact = is_whole(kind) || kind == Kind::precise || kind == Kind::precise_matrix;
  for (const double value : uniform_components(context, program, uniform)) {
    const auto [rounded, remainder] = UniformValue{{}, 0, value}.floats();
    values.push_back(rounded);
    if (exact) values.push_back(remainder);
  }
}

std::vector<UniformValue> fragment_uniform_values(const GlContext& context, GLuint application,
                                                  const ProgramStages& stages) {
  std::vector<UniformValue> values;
  for (const StageUniform& uniform : stages.uniforms) {
    const bool chooses = !is_sampler(uniform.type) && is_whole(shape_of(uniform.type).kind);
    const bool built_in = uniform.name.starts_with("gl_");
    int component = 0;
    for (const double value : uniform_components(context, application, uniform))
      values.push_back({uniform.name, built_in ? -1 : component++, value, chooses});
  }
  if (stages.uniform_blocks) append_block_contents(*context.gl, application, values);
  return values;
}

}  // namespace understudy::spu
