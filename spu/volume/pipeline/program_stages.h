// SPDX-License-Identifier: Apache-2.0
// The application's program, taken apart: its vertex stage alone, to capture what it computes, and its fragment
// stage under a vertex stage of ours, to show it chosen samples.
#pragma once

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
  int location = -1;                  ///< as the driver has placed it, where the fragment stage stands alone
  std::string interpolation{};        ///< "flat", "noperspective"; empty: smooth
  std::string block{};                ///< the interface block whose member it is; empty: of none
  std::ptrdiff_t place_in_block = 0;  ///< members are declared in this order
  std::string output{};  ///< of the vertex stage that it reads: another name where both stand at one location
  bool written = true;   ///< false: the vertex stage declares it at most, and no colour can depend on it
};

/// A uniform by name; array elements stand alone.
struct StageUniform {
  std::string name;
  GLenum type = GL_FLOAT;
};

/// A varying that the fragment stage reads, of a type that is not probed: a matrix or an array.
struct UnprobedInput {
  std::string name;            ///< without an element
  std::size_t components = 1;  ///< of one element
  std::size_t elements = 1;
  bool array = false;
  std::string output{};  ///< as of StageInput
  bool written = true;   ///< likewise
  bool captured = true;  ///< false: of what is written, nothing is known

  std::size_t floats() const { return written && captured ? components * elements : 0; }
  std::string element(std::size_t index) const {
    return array ? name + "[" + std::to_string(index) + "]" : name;
  }
};

/// How many numbers a value of this type is; 1 for types that are not known.
std::size_t components_of_type(GLenum type);

/// One number of an input of the fragment stage.
struct InputComponent {
  std::string input;  ///< with the element, of an array
  int component = 0;
};

/// A uniform that the vertex stage alone has, outside of blocks and not built in.
struct VertexUniform {
  StageUniform uniform;
  /// By numbers of it that do not reach the position: those that do are seen where the volume's box is. All
  /// inputs where the text is not understood.
  std::vector<InputComponent> reaches;
};

/// A member of a uniform block of either stage.
struct ProgramBlockMember {
  BlockMember member;
  std::vector<InputComponent> reaches;  ///< as of VertexUniform
};

/// Programs built from the sources of one link of the application's program. The names live in its context.
struct ProgramStages {
  std::vector<StageInput> inputs;       ///< of the fragment stage, as far as they can be captured
  std::vector<UnprobedInput> unprobed;  ///< further inputs; captured behind the others
  std::vector<StageUniform> uniforms;   ///< of the fragment stage: the camera's matrices are not among them
  std::vector<VertexUniform> vertex_uniforms;     ///< those that reach any of `inputs` so
  std::vector<ProgramBlockMember> block_members;  ///< where the vertex stage can be captured
  bool uniform_blocks = false;                    ///< the fragment stage reads uniform buffers
  GLuint observer = 0;  ///< vertex stage; captures gl_Position, then every input that is written, then those
                        ///< of `unprobed`, interleaved as floats; 0: none
  std::string trouble;  ///< why the fragment stage cannot be shown chosen samples; empty: it can
};

/// One number of a uniform, or of what tells the contents of a uniform block.
struct UniformValue {
  std::string_view name;  ///< of StageUniform; empty: of a block
  int component = 0;
  float value = 0;
  bool chooses = false;  ///< an integer or a truth value: what branches are usually decided by
};

/// Whether a fragment shader means the input by that name: gl_Color is what the vertex stage has written to
/// gl_FrontColor.
bool is_named(const StageInput& input, const std::string& name);

/// Needs the program's record; `application` is the program itself, for attribute locations.
ProgramStages take_apart(const GlContext& context, const ProgramRecord& record, GLuint application);

/// The application's fragment stage (or fixed-function fragments when `record` is null) under a vertex stage
/// that covers the viewport with one triangle. The input named `coordinate` (gl_TexCoord[0] for fixed function)
/// runs over [0,1]^2 with third component 1/2; the k-th other input has the value understudy_value[k] +
/// x understudy_across[k] + y understudy_up[k] at (x, y) of the same square (integers: the first alone).
/// Returns 0 and sets `trouble` when it does not link.
GLuint probe_program(const GlContext& context, const ProgramRecord* record,
                     const std::vector<StageInput>& inputs, const std::string& coordinate,
                     std::string& trouble);

/// Gives every uniform and uniform block of `to` the value it has in `from`, by name.
void copy_uniforms(const GlContext& context, GLuint from, GLuint to);

/// What the fragment stage's uniforms and uniform blocks hold in `application` now.
std::vector<UniformValue> fragment_uniform_values(const GlContext& context, GLuint application,
                                                  const ProgramStages& stages);

}  // namespace understudy::spu
