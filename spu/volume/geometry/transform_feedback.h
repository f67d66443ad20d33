// SPDX-License-Identifier: Apache-2.0
// Transform feedback: a run is drawn without rasterisation, and OpenGL writes down what a program's vertex
// stage makes of its vertices.
#pragma once

#include <array>
#include <vector>

#include "spu/volume/context/context.h"
#include "spu/volume/observation/run.h"

namespace understudy::spu {

/// In scope, `program` is the current one and nothing is rasterised; afterwards both are as before.
class TransformFeedback {
 public:
  TransformFeedback(const GlContext& context, GLuint program);
  ~TransformFeedback();
  TransformFeedback(const TransformFeedback&) = delete;
  TransformFeedback& operator=(const TransformFeedback&) = delete;

  /// The triangles of `run`, three vertices each, `stride` captured floats a vertex. Empty where nothing was
  /// drawn, or more than 64 MiB. All draws of the run must be of polygons.
  std::vector<float> triangles(const Run& run, std::size_t stride);

 private:
  void replace_binding();
  void restore_binding();
  /// Triangles that the run generates, and those that fitted into a buffer of `bytes`.
  std::array<GLuint, 2> draw(const Run& run, GLsizeiptr bytes);
  /// `triangles`, which the run draws, into a buffer of their size. No query is asked: its answer would wait
  /// for all that the driver has not yet drawn.
  std::vector<float> counted_triangles(const Run& run, std::size_t triangles, std::size_t stride);
  std::vector<float> read_back(std::size_t triangles, std::size_t stride) const;

  const GlContext& context_;
  const DispatchTable& gl_;
  const bool has_objects_;  ///< transform feedback objects, of OpenGL 4.0
  GLint program_ = 0;
  GLint generic_ = 0;
  GLint application_object_ = 0;
  GLuint object_ = 0;
  // Where there are no objects:
  GLint indexed_ = 0;
  GLint64 start_ = 0;
  GLint64 size_ = 0;
  GLboolean discard_ = GL_FALSE;
  GLuint buffer_ = 0;
  std::array<GLuint, 2> queries_{};
};

}  // namespace understudy::spu
