// SPDX-License-Identifier: Apache-2.0
// What a run was recognised as: its geometry, and the inputs of its fragments. All later stages receive it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "spu/volume/geometry/capture.h"
#include "spu/volume/geometry/slice_segment.h"
#include "spu/volume/geometry/slices.h"

namespace understudy::spu {

/// Inputs of the fragment stage besides the sample.
struct FragmentInputs {
  std::shared_ptr<const ProgramRecord> record;  ///< null: fixed-function fragments
  GLuint application = 0;                       ///< the application's program, for its uniforms
  std::vector<StageInput> inputs;
  std::string coordinate;
  InputValues first;  ///< values of all inputs at one vertex, in the order of `inputs`
  InputValues last;   ///< at another vertex: a colour that differs between them depends on more than the sample
  InputRange range;   ///< of all inputs over the run
  std::vector<std::size_t> segment_ends;  ///< inputs that may address the volume a second time
};

/// Slices, or the box of a ray caster.
struct RecognisedRun {
  bool ray_caster = false;  ///< one draw of a box whose fragment shader marches: see `capture` and `fragment`
  FragmentInputs fragment;
  std::optional<Capture> capture;  ///< if a vertex shader was captured; the polygons of slices are in
                                   ///< `polygons`

  // For slices only:
  ObservedPolygons polygons;
  std::vector<float> fog_numbers;  ///< scalars of fixed-function fog, vertex by vertex
  std::vector<GLuint> stack;       ///< the textures of a stack, from the volume's low end to its high end
  std::optional<CameraFit> fit;
  std::vector<volume::HalfSpace> clip_planes;  ///< of the application, in texture space
  SliceSet slices;
  std::vector<ObservedSegment> slice_segments;  ///< candidates for the second coordinates of segments

  std::uint64_t texture_version = 0;  ///< of the volume's texture; of a stack, of all its textures
};

/// Returns the order in which slices must be drawn for their blending to equal the nodes' operator.
SliceOrder order_of(const Pipeline& pipeline);

}  // namespace understudy::spu
