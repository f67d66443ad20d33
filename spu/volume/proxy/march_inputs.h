// SPDX-License-Identifier: Apache-2.0
// What the measurement of a ray caster depends on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "spu/volume/program_check/program_check.h"
#include "spu/volume/proxy/coordinate_space.h"

namespace understudy::spu {

class ShareGroup;

/// What a march was measured under. It holds while `fixed` is unchanged and a check of a few rays confirms it:
/// the camera is among the inputs that vary.
struct MarchInputs {
  std::vector<float> fixed;
  /// Indices into `fixed`: names and contents of tables that samples address. If these change, they are
  /// measured anew.
  std::vector<std::size_t> tables;
  /// Indices into `fixed`: uniforms that move samples, and decide about no fragment or colour.
  std::vector<std::size_t> steps;
  /// First the fragment stage's own inputs, and then those that other_inputs.h adds.
  std::vector<float> varying;
  std::size_t of_fragment_stage = 0;  ///< size of the first part of `varying`
  bool unreadable = false;  ///< something that the march depends on cannot be read, and may change at any time
  /// Where each vector, matrix or scalar of `varying` begins, and a hash of its name.
  std::vector<std::size_t> varying_begins;
  std::vector<std::size_t> varying_names;
  /// Likewise: whether it is one scalar, passed to the fragment stage and constant over the draw.
  std::vector<bool> varying_may_be_step;
  /// Likewise: whether it decides, by a branch, how samples look or whether they are skipped.
  std::vector<bool> varying_chooses;
  /// Depth textures and their contents, which probes replace by the far plane: opaque geometry's may be copied
  /// in every frame.
  std::vector<float> depths;
  /// The planes that cut the volume (cuts.h). The march is measured without them, so it holds if they change.
  std::vector<float> cuts;

  /// Begins a vector of that name, to which everything belongs that is appended to `varying` from now on.
  void begin_vector(std::string_view name, bool chooses, bool may_be_step = false);
};

/// Collects the inputs. `says` must have a finding about ray casters; `space` is the space of the samples.
MarchInputs march_inputs(const MarchContext& measured, const CoordinateSpace& space, const ShareGroup& group,
                         const ProgramFindings& says);

/// Appends the value of a uniform, if the program still has it.
void append_value(const MarchContext& measured, const StageUniform& uniform, std::vector<float>& values);

/// Whether the uniform decides about colours, by a branch.
bool chooses_colours(const ProgramFindings& says, const std::string& uniform);

/// Returns the values that decide, together with the position in the window, which fragments the program
/// discards. Holds a NaN, and so never equals another result, if that cannot be determined.
std::vector<float> discard_inputs(const MarchContext& measured, const ShareGroup& group,
                                  const MarchInputs& inputs, const ProgramFindings& says);

/// Whether the fragment stage's own inputs are the same.
bool same_in_fragment_stage(const MarchInputs& before, const MarchInputs& now);

/// How the inputs that other_inputs.h adds have changed, as far as rays may show it.
enum class BesideChange : std::uint8_t {
  none,
  with_camera,  ///< a scalar that moves with the camera and may be a step
  alone,        ///< something that does not move with the camera
};

/// `follows` states, number by number of `varying`, what moves with the camera.
BesideChange change_beside_fragment_stage(const MarchInputs& before, const MarchInputs& now,
                                          const std::vector<bool>& follows);

/// Whether `fixed` differs in nothing but the tables.
bool only_tables_differ(const MarchInputs& before, const MarchInputs& now);

/// Whether a uniform that moves samples differs.
bool steps_differ(const MarchInputs& before, const MarchInputs& now);

/// If `fixed` differs only in uniforms that move samples, by factors below 64, and in tables: returns the
/// factors by which the step may have grown, 1 if it has not. Otherwise empty.
std::vector<double> step_factors(const MarchInputs& before, const MarchInputs& now);

}  // namespace understudy::spu
