// SPDX-License-Identifier: Apache-2.0
// Captures the output of vertex shaders: draws the run once with the application's vertex stage alone and
// rasterisation off; transform feedback records the clip position and everything that the fragment stage reads.
#pragma once

#include "spu/volume/geometry/fit.h"
#include "spu/volume/geometry/polygon.h"
#include "spu/volume/observation/run.h"
#include "spu/volume/pipeline/program_stages.h"

namespace understudy::spu {

struct GlContext;

/// Values of one vertex, in the order of ProgramStages::inputs, four floats per input.
using InputValues = std::vector<std::array<float, 4>>;

/// Bounds of every input over all vertices of a run, component by component.
struct InputRange {
  InputValues low;
  InputValues high;

  /// Returns whether `inner` lies within these bounds.
  bool covers(const InputRange& inner) const;
};

struct Capture {
  ObservedPolygons polygons;  ///< triangles; `texture` holds the input named by `coordinate`
  std::string coordinate;     ///< input that addresses the volume: the one that a camera fits
  std::optional<CameraFit> fit;
  InputValues first;  ///< all inputs at the first vertex
  InputValues last;   ///< all inputs at the last vertex
  InputRange range;
  std::vector<float> data;  ///< vertex by vertex, `stride` floats each
  std::size_t stride = 0;
  std::vector<std::size_t> offsets;  ///< of each input in a vertex; unused for inputs that are not written
  std::vector<std::size_t> unprobed_offsets;  ///< likewise for ProgramStages::unprobed

  /// Value of `input`, which is not an integer, at vertex `v`.
  float value(std::size_t v, std::size_t input, std::size_t component) const {
    return data[v * stride + offsets[input] + component];
  }
};

/// Draws `run` with `stages.observer`, with the uniforms of the run's program. Returns an empty capture if
/// nothing was drawn, or if the triangles would exceed 64 MiB. With a `coordinate` no other input is tried. The
/// third coordinate of a stack's slices is their index. Throws Refusal if points or lines are drawn.
Capture capture_vertices(const GlContext& context, const Run& run, const ProgramStages& stages,
                         const std::string& coordinate = {});

}  // namespace understudy::spu
