// SPDX-License-Identifier: Apache-2.0
// What a shader's text says about its values: which sources can reach which outputs, discards and texture
// fetches.
//
// Facts are safe, not sharp: a source that is not listed cannot reach the value; one that is listed may. What a
// fetch returns is a source of its own; what its coordinate depends on is said by the fetch.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace understudy::spu::program {

enum class Stage : std::uint8_t { vertex, geometry, fragment };

enum class SourceKind : std::uint8_t {
  texel,                ///< what fetch `number` returned
  varying,              ///< input of the geometry or fragment stage, built-in ones of old versions included
  attribute,            ///< input of the vertex stage
  uniform,              ///< with fixed-function state: gl_ModelViewMatrix, gl_Fog.density
  uniform_block,        ///< member of a uniform buffer
  storage_buffer,       ///< member of a shader storage buffer
  image,                ///< texel read by imageLoad
  texture_size,         ///< what textureSize, textureQueryLevels and relatives tell of a sampler
  fragment_coordinate,  ///< gl_FragCoord
  front_facing,
  point_coordinate,
  sample,        ///< gl_SampleID, gl_SamplePosition, gl_SampleMaskIn
  primitive,     ///< gl_PrimitiveID
  layer,         ///< gl_Layer, gl_ViewportIndex
  vertex_index,  ///< gl_VertexID, gl_InstanceID
  iteration,     ///< how often loop `number` has been run through
  derivative,    ///< values of neighbouring pixels: dFdx and relatives, interpolateAt*
  noise,
  atomic_counter,
  undefined,  ///< a variable that nothing was written to
  unknown,    ///< what the analysis does not follow; `name` says what
};

/// One number that a shader stage can read.
struct Source {
  SourceKind kind = SourceKind::unknown;
  std::string name;  ///< as OpenGL queries spell it: "light[1].colour", "gl_TexCoord[0]"; of texels the sampler
  int component = 0;       ///< of matrices, column by column
  int components = 1;      ///< that the variable has; of a matrix, all
  int rows = 1;            ///< of a matrix's column; of a vector, `components`
  std::size_t number = 0;  ///< of the fetch or of the loop
};

/// "varying texcoord.z", "uniform time", "texel of 'volume'", "gl_FragCoord.x".
std::string text(const Source& source);

/// How a source reaches a value: by the highest of these that is on the way.
enum class Flow : std::uint8_t {
  data,    ///< by arithmetic, or as an index
  branch,  ///< decides which of several values it is
  loop,    ///< decides when a loop ends, and so how often something was done
};

/// A source (by its place in StageFacts::sources) and a way by which it reaches a value. There may be several.
struct Dependence {
  std::uint32_t source = 0;
  Flow flow = Flow::data;
  auto operator<=>(const Dependence&) const = default;  // NOLINT(modernize-use-nullptr): there is no pointer
};

/// In rising order.
using Dependences = std::vector<Dependence>;

enum class TextureShape : std::uint8_t { line, plane, space, cube, rectangle, buffer, other };
enum class TexelType : std::uint8_t { real, integer, natural };

struct SamplerType {
  TextureShape shape = TextureShape::other;
  TexelType texels = TexelType::real;
  bool array = false;
  bool shadow = false;
  bool multisample = false;
  bool operator==(const SamplerType&) const = default;
};

/// "usampler2DArray".
std::string text(const SamplerType& type);

enum class FetchFunction : std::uint8_t {
  filtered,  ///< texture and relatives
  exact,     ///< texelFetch
  gathered,  ///< textureGather
};

/// A texture function at one place of the text, reached by one chain of calls.
struct Fetch {
  std::string sampler;  ///< "volume", "textures[2]"; "textures[*]" where an index decides; empty: not known
  SamplerType type;
  FetchFunction function = FetchFunction::filtered;
  bool projected = false;
  bool offset = false;    ///< by a number of texels
  bool level = false;     ///< the level of detail is given
  bool gradient = false;  ///< the derivatives are given
  bool bias = false;
  std::vector<Dependences> coordinate;  ///< by component, that of an array's layer last, after the projection
  std::vector<std::optional<std::uint32_t>> exact;  ///< the source that a component equals
  Dependences modifiers;  ///< of level, bias, gradients, offsets, reference value, and which sampler it is
  Dependences execution;  ///< of whether, and how often, it is executed; discards do not count
  std::optional<std::size_t> loop;  ///< the innermost around it
  std::uint32_t place = 0;  ///< fetches with equal places, outside loops or in one iteration, return one texel
  int line = 0;
};

struct Loop {
  Dependences condition;             ///< of when it ends
  std::optional<std::size_t> outer;  ///< the loop around it, in this function or in those that call it
  int line = 0;
};

enum class Interpolation : std::uint8_t { smooth, flat, no_perspective };

/// A varying that the stage declares.
struct Input {
  std::string name;
  int components = 0;
  int elements = 1;  ///< of an array
  bool integer = false;
  int location = -1;  ///< in the text; -1: not there
  int packed_at = 0;  ///< its first component at that location: layout(component = ...)
  Interpolation interpolation = Interpolation::smooth;
  bool centroid = false;
  bool sample = false;
  /// The interface block whose member it is; empty: of none, or of one that has locations or is an array. A
  /// member of a block with an instance name is called "Block.member", of one without "member".
  std::string block{};
};

/// One component of a shader stage's output.
struct Output {
  std::string name;  ///< "gl_FragColor", "gl_FragData[1]", "colour", "gl_FragDepth", "gl_Position"
  int component = 0;
  int components = 1;
  int location = -1;     ///< in the text; -1: not there
  int packed_at = 0;     ///< as Input has it
  int index = 0;         ///< 1: second colour of dual-source blending
  bool written = false;  ///< false: nothing is ever written to it
  Dependences on;
  std::optional<std::uint32_t> exact;  ///< the source that it equals
  Interpolation interpolation = Interpolation::smooth;
  std::string block{};  ///< as Input has it
};

struct Discard {
  int line = 0;
  Dependences on;
};

enum class SideEffectKind : std::uint8_t {
  image_store,
  image_atomic,
  buffer_store,
  buffer_atomic,
  atomic_counter
};

struct SideEffect {
  SideEffectKind kind = SideEffectKind::image_store;
  std::string name;
  int line = 0;
};

struct StageFacts {
  int version = 110;
  std::vector<Source> sources;
  std::vector<Fetch> fetches;
  std::vector<Loop> loops;
  std::vector<Input> inputs;
  std::vector<Output> outputs;
  std::vector<Discard> discards;
  std::vector<SideEffect> side_effects;
  std::vector<std::string>
      not_followed;  ///< functions whose meaning is not known: what they return depends on all
};

/// Why there are no facts.
struct Failure {
  enum class Kind : std::uint8_t {
    parse,        ///< the front end does not take the text; drivers may
    unsupported,  ///< a feature that is not analysed
    too_large,
  } kind = Kind::parse;
  std::string what;  ///< ends up in the report
};

}  // namespace understudy::spu::program
