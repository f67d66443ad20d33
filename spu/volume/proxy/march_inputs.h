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

/// What a march was measured under. While `fixed` stays, and a look at a few rays says so, it holds: the camera
/// is among the inputs that vary.
struct MarchInputs {
  std::vector<float> fixed;
  /// Of `fixed`, names and contents of tables that samples address: measured anew.
  std::vector<std::size_t> tables;
  /// Of `fixed`, uniforms that move samples, and decide about no fragment or colour.
  std::vector<std::size_t> steps;
  /// First what the fragment stage has itself, and then what other_inputs.h adds.
  std::vector<float> varying;
  std::size_t of_fragment_stage = 0;  ///< so many numbers of `varying`
  bool unreadable = false;  ///< something that it depends on cannot be told: it may be another every time
  /// Where each vector, matrix or number of `varying` begins, and what tells its name from others.
  std::vector<std::size_t> varying_begins;
  std::vector<std::size_t> varying_names;
  /// Likewise: whether vertices hand it on, one number in all of the draw.
  std::vector<bool> varying_may_be_step;
  /// Likewise: whether it decides, by a branch, what samples look like or whether they are left out.
  std::vector<bool> varying_chooses;
  /// Depth textures and their contents, instead of which probes show the far plane: opaque geometry's may be
  /// copied in every frame.
  std::vector<float> depths;

  /// What is appended to `varying` from now on is one vector of that name.
  void begin_vector(std::string_view name, bool chooses, bool may_be_step = false);
};

/// `says` has a finding about ray casters; `space` is where samples lie.
MarchInputs march_inputs(const MarchContext& measured, const CoordinateSpace& space, const ShareGroup& group,
                         const ProgramFindings& says);

/// What a uniform holds that the program still has.
void append_value(const MarchContext& measured, const StageUniform& uniform, std::vector<float>& values);

/// Whether the uniform decides, by a branch, what colours are.
bool chooses_colours(const ProgramFindings& says, const std::string& uniform);

/// What decides, with the place in the window, which fragments the program discards. Never equal to another
/// where that cannot be told.
std::vector<float> discard_inputs(const MarchContext& measured, const ShareGroup& group,
                                  const MarchInputs& inputs, const ProgramFindings& says);

/// Whether the fragment stage has the same in all that it has itself.
bool same_in_fragment_stage(const MarchInputs& before, const MarchInputs& now);

/// How what other_inputs.h adds has changed, so far as rays may show it.
enum class BesideChange : std::uint8_t {
  none,
  with_camera,  ///< a number that may be a step
  alone,        ///< something that does not move with the camera
};

/// `follows` tells, number by number, what moves with the camera.
BesideChange change_beside_fragment_stage(const MarchInputs& before, const MarchInputs& now,
                                          const std::vector<bool>& follows);

/// Whether nothing of `fixed` differs but the tables.
bool only_tables_differ(const MarchInputs& before, const MarchInputs& now);

/// Whether a uniform differs that moves samples.
bool steps_differ(const MarchInputs& before, const MarchInputs& now);

/// Where nothing of `fixed` differs but what the step of rays and the tables depend on: the factors by which
/// the step may have grown, 1 where it has not. Empty: something else differs.
std::vector<double> step_factors(const MarchInputs& before, const MarchInputs& now);

}  // namespace understudy::spu
