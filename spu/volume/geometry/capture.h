// SPDX-License-Identifier: Apache-2.0
// Observing vertex shaders: the run is drawn once with the application's vertex stage alone and rasterisation
// off, and transform feedback writes down the clip position and everything that the fragment stage would read.
#pragma once

#include "spu/volume/geometry/fit.h"
#include "spu/volume/geometry/polygon.h"
#include "spu/volume/observation/run.h"
#include "spu/volume/pipeline/program_stages.h"

namespace understudy::spu {

struct GlContext;

/// Values of one vertex, in the order of ProgramStages::inputs, four floats an input.
using InputValues = std::vector<std::array<float, 4>>;

/// Bounds of every input over all vertices of a run, component by component.
struct InputRange {
  InputValues low;
  InputValues high;

  /// Whether `inner` lies within.
  bool covers(const InputRange& inner) const;
};

struct Capture {
  ObservedPolygons polygons;  ///< triangles; `texture` holds the input named by `coordinate`
  std::string coordinate;  ///< the input that addresses the volume: the one whose fit to the positions closes
  std::optional<CameraFit> fit;
  InputValues first;  ///< all inputs at the first vertex
  InputValues last;   ///< and at the last
  InputRange range;
  std::vector<float> data;  ///< vertex by vertex, `stride` floats each
  std::size_t stride = 0;
  std::vector<std::size_t> offsets;  ///< of each input in a vertex; those that are not written have none
  std::vector<std::size_t> unprobed_offsets;  ///< likewise of ProgramStages::unprobed

  /// Of input `input`, no integer, at vertex `v`.
  float value(std::size_t v, std::size_t input, std::size_t component) const {
    return data[v * stride + offsets[input] + component];
  }
};

/// Draws `run` with `stages.observer`; uniforms are copied from the run's program. An empty capture when
/// nothing was drawn or the primitives would exceed 64 MiB. With a `coordinate` no other input is tried. The
/// third coordinate of a stack's slices is their number.
Capture capture_vertices(const GlContext& context, const Run& run, const ProgramStages& stages,
                         const std::string& coordinate = {});

}  // namespace understudy::spu
