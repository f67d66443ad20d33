// SPDX-License-Identifier: Apache-2.0
// Takes the application's program apart: its vertex stage alone, to capture its output, and its fragment stage
// with a vertex stage of ours, to probe it with chosen samples.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "dispatch/table.h"
#include "spu/volume/pipeline/block_members.h"

namespace understudy::spu {

struct GlContext;
struct ProgramRecord;

/// A varying that the fragment stage reads.
struct StageInput {
  std::string
      name;  ///< in the fragment stage; of built-in ones, as a vertex shader writes it: "gl_TexCoord[0]"
  GLenum type = GL_FLOAT_VEC4;
  int components = 4;
  bool integer = false;
  int location = -1;                  ///< chosen by the driver when the fragment stage is linked alone
  std::string interpolation{};        ///< "flat", "noperspective"; empty: smooth
  std::string block{};                ///< interface block that it is a member of; empty: none
  std::ptrdiff_t place_in_block = 0;  ///< members are declared in this order
  std::string output{};  ///< of the vertex stage that it reads; the name differs if both match by location
  bool written = true;   ///< false: the vertex stage at most declares it, and no colour can depend on it
};

/// A uniform by name; array elements are listed individually.
struct StageUniform {
  std::string name;
  GLenum type = GL_FLOAT;
};

/// A varying that the fragment stage reads, of a type that cannot be probed: a matrix or an array.
struct UnprobedInput {
  std::string name;            ///< without an array index
  std::size_t components = 1;  ///< of one element
  std::size_t elements = 1;
  bool array = false;
  std::string output{};  ///< as in StageInput
  bool written = true;   ///< as in StageInput
  bool captured = true;  ///< false: it is written, but its values are unknown

  std::size_t floats() const { return written && captured ? components * elements : 0; }
  std::string element(std::size_t index) const {
    return array ? name + "[" + std::to_string(index) + "]" : name;
  }
};

/// Returns the number of scalars in a value of this type; 1 for unknown types.
std::size_t components_of_type(GLenum type);

/// One scalar of an input of the fragment stage.
struct InputComponent {
  std::string input;  ///< with the index, of an array
  int component = 0;
};

/// A uniform of the vertex stage alone, outside of blocks and not built in.
struct VertexUniform {
  StageUniform uniform;
  /// Inputs reached by those of its scalars that do not reach the position: a change of the others is visible
  /// in the position of the volume's box. All inputs if the source could not be analysed.
  std::vector<InputComponent> reaches;
};

/// A member of a uniform block of either stage.
struct ProgramBlockMember {
  BlockMember member;
  std::vector<InputComponent> reaches;  ///< as in VertexUniform
};

/// Programs built from the sources of one link of the application's program. Their names belong to its context.
struct ProgramStages {
  std::vector<StageInput> inputs;       ///< of the fragment stage, as far as they can be captured
  std::vector<UnprobedInput> unprobed;  ///< further inputs; captured after the others
  std::vector<StageUniform> uniforms;   ///< of the fragment stage: the camera's matrices are not among them
  std::vector<VertexUniform> vertex_uniforms;     ///< those that reach any input
  std::vector<ProgramBlockMember> block_members;  ///< if the vertex stage can be captured
  bool uniform_blocks = false;                    ///< the fragment stage reads uniform buffers
  std::string written_by_vertices;  ///< a buffer, image or counter that the vertex stage may write
                                    ///< to; empty: none
  GLuint observer = 0;  ///< vertex stage; captures gl_Position, then every input that is written, then those
                        ///< of `unprobed`, interleaved as floats; 0: none
  std::string trouble;  ///< why the fragment stage cannot be probed with chosen samples; empty: it can
};

/// One scalar of a uniform, or of the hash of a uniform block's contents.
struct UniformValue {
  std::string_view name;  ///< of StageUniform; empty for a block
  int component = 0;      ///< -1: of the variable as a whole
  double value = 0;       ///< exact: integers may have 32 bits
  bool chooses = false;   ///< an integer or a boolean, which usually controls branches

  /// Returns the value rounded to float, and what rounding left out.
  std::array<float, 2> floats() const;
};

/// Returns whether a fragment shader refers to the input by `name`: gl_Color is what the vertex stage writes to
/// gl_FrontColor. A program in assembly language says fragment.color.primary.
bool is_named(const StageInput& input, const std::string& name);

/// Takes the program `application` apart; `record` has its sources.
ProgramStages take_apart(const GlContext& context, const ProgramRecord& record, GLuint application);

/// Links the application's fragment stage (or fixed-function fragments if `record` is null) with a vertex stage
/// that covers the viewport with one triangle. The input named `coordinate` (gl_TexCoord[0] for fixed function)
/// runs over [0,1]^2 with third component 1/2; the k-th other input has the value understudy_value[k] + x
/// understudy_across[k] + y understudy_up[k] at (x, y) of the same square (integers: only the first term).
/// Returns 0 and sets `trouble` if linking fails.
GLuint probe_program(const GlContext& context, const ProgramRecord* record,
                     const std::vector<StageInput>& inputs, const std::string& coordinate,
                     std::string& trouble);

/// Why a run is not substituted if the uniform `name` is not copied.
std::string not_copied(const std::string& name);

/// Gives every uniform of `to` the value, and every uniform block the binding, that it has in `from`, by name.
/// Returns the name of a uniform of a type that is not copied; empty: all were.
std::string copy_uniforms(const GlContext& context, GLuint from, GLuint to);

/// Appends the current value of one uniform of `program`: of integers and doubles, with what rounding
/// to float leaves out.
void append_uniform(const GlContext& context, GLuint program, const StageUniform& uniform,
                    std::vector<float>& values);

/// Returns the current values of the fragment stage's uniforms and uniform blocks in `application`.
std::vector<UniformValue> fragment_uniform_values(const GlContext& context, GLuint application,
                                                  const ProgramStages& stages);

}  // namespace understudy::spu
