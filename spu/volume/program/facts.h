// SPDX-License-Identifier: Apache-2.0
// What a shader's source implies for its values: which sources can reach which outputs, discards and texture
// fetches.
//
// Facts are safe, not sharp: a source that is not listed cannot reach the value; a source that is listed may.
// The result of a fetch is a source of its own; the fetch lists what its coordinate depends on.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace understudy::spu::program {

enum class Stage : std::uint8_t { vertex, geometry, fragment };

enum class SourceKind : std::uint8_t {
  texel,                ///< result of fetch `number`
  varying,              ///< input of the geometry or fragment stage, including built-in ones of old versions
  attribute,            ///< input of the vertex stage
  uniform,              ///< including fixed-function state: gl_ModelViewMatrix, gl_Fog.density
  uniform_block,        ///< member of a uniform buffer
  storage_buffer,       ///< member of a shader storage buffer
  image,                ///< texel read by imageLoad
  texture_size,         ///< result of textureSize, textureQueryLevels and the like for a sampler
  fragment_coordinate,  ///< gl_FragCoord
  front_facing,
  point_coordinate,
  sample,        ///< gl_SampleID, gl_SamplePosition, gl_SampleMaskIn
  primitive,     ///< gl_PrimitiveID
  layer,         ///< gl_Layer, gl_ViewportIndex
  vertex_index,  ///< gl_VertexID, gl_InstanceID
  iteration,     ///< number of the current iteration of loop `number`
  derivative,    ///< values of neighbouring pixels: dFdx and the like, interpolateAt*
  noise,
  atomic_counter,
  undefined,  ///< a variable that was never written
  unknown,    ///< what the analysis does not follow; described by `name`
};

/// One scalar that a shader stage can read.
struct Source {
  SourceKind kind = SourceKind::unknown;
  std::string name;  ///< as OpenGL queries spell it: "light[1].colour", "gl_TexCoord[0]"; of texels the sampler
  int component = 0;       ///< of matrices, column by column
  int components = 1;      ///< of the variable; of a matrix, all
  int rows = 1;            ///< of a matrix; of a vector, `components`
  std::size_t number = 0;  ///< of the fetch or of the loop
};

/// Describes a source: "varying texcoord.z", "uniform time", "texel of 'volume'", "gl_FragCoord.x".
std::string text(const Source& source);

/// How a source reaches a value: the highest of these along the path.
enum class Flow : std::uint8_t {
  data,    ///< by arithmetic, or as an index
  branch,  ///< selects one of several values
  loop,    ///< decides when a loop ends, and thus how often something is done
};

/// A source (its index in StageFacts::sources) and how it reaches a value. A source may have several
/// dependences.
struct Dependence {
  std::uint32_t source = 0;
  Flow flow = Flow::data;
  auto operator<=>(const Dependence&) const = default;  // NOLINT(modernize-use-nullptr): there is no pointer
};

/// In ascending order.
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

/// Returns the name of the type in GLSL, such as "usampler2DArray".
std::string text(const SamplerType& type);

enum class FetchFunction : std::uint8_t {
  filtered,  ///< texture and the like
  exact,     ///< texelFetch
  gathered,  ///< textureGather
};

/// A texture function at one point of the source, reached by one chain of calls.
struct Fetch {
  std::string sampler;  ///< "volume", "textures[2]"; "textures[*]" if an index decides; empty: unknown
  SamplerType type;
  FetchFunction function = FetchFunction::filtered;
  bool projected = false;
  bool offset = false;    ///< by a number of texels
  bool level = false;     ///< the level of detail is given
  bool gradient = false;  ///< the derivatives are given
  bool bias = false;
  std::vector<Dependences> coordinate;  ///< by component, after projection; the layer of an array is last
  std::vector<std::optional<std::uint32_t>> exact;  ///< the source that a component equals, if any
  Dependences modifiers;  ///< of level, bias, gradients, offsets, reference value, and choice of the sampler
  Dependences execution;  ///< of whether, and how often, it is executed; discards do not count
  std::optional<std::size_t> loop;  ///< the innermost loop around it
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
  int location = -1;  ///< in the source; -1: none
  int packed_at = 0;  ///< its first component at that location: layout(component = ...)
  Interpolation interpolation = Interpolation::smooth;
  bool centroid = false;
  bool sample = false;
  /// The interface block that it is a member of; empty if none, or if the block has locations or is an array. A
  /// member of a block with an instance name is called "Block.member", otherwise "member".
  std::string block{};
};

/// One component of a shader stage's output.
struct Output {
  std::string name;  ///< "gl_FragColor", "gl_FragData[1]", "colour", "gl_FragDepth", "gl_Position"
  int component = 0;
  int components = 1;
  int location = -1;     ///< in the source; -1: none
  int packed_at = 0;     ///< as in Input
  int index = 0;         ///< 1: second colour of dual-source blending
  bool written = false;  ///< false: it is never written
  Dependences on;
  std::optional<std::uint32_t> exact;  ///< the source that it equals, if any
  Interpolation interpolation = Interpolation::smooth;
  std::string block{};  ///< as in Input
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
      not_followed;  ///< functions of unknown meaning: results depend on all arguments and an unknown source
};

/// The reason why there are no facts.
struct Failure {
  enum class Kind : std::uint8_t {
    parse,        ///< the front end rejects the source; drivers may accept it
    unsupported,  ///< a feature that is not analysed
    too_large,
  } kind = Kind::parse;
  std::string what;  ///< printed in the report
};

}  // namespace understudy::spu::program
