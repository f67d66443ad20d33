// SPDX-License-Identifier: Apache-2.0
// Transform feedback: draws a run without rasterisation, and captures the output of a program's vertex stage.
#pragma once

#include <array>
#include <vector>

#include "spu/volume/context/context.h"
#include "spu/volume/observation/run.h"

namespace understudy::spu {

/// In its scope, `program` is current and nothing is rasterised; the destructor restores both.
class TransformFeedback {
 public:
  TransformFeedback(const GlContext& context, GLuint program);
  ~TransformFeedback();
  TransformFeedback(const TransformFeedback&) = delete;
  TransformFeedback& operator=(const TransformFeedback&) = delete;

  /// Returns the triangles of `run`, three vertices each, with `stride` captured floats per vertex. Empty if
  /// nothing was drawn, or more than 64 MiB. All draws of the run must be of polygons.
  std::vector<float> triangles(const Run& run, std::size_t stride);

 private:
  void replace_binding();
  void restore_binding();
  /// Returns the number of triangles that the run generates, and of those that fitted into a buffer of `bytes`.
  std::array<GLuint, 2> draw(const Run& run, GLsizeiptr bytes);
  /// Captures `triangles`, the number that the run draws, into a buffer of their size. Uses no query: its
  /// result would wait for all pending work of the driver.
  std::vector<float> counted_triangles(const Run& run, std::size_t triangles, std::size_t stride);
  std::vector<float> read_back(std::size_t triangles, std::size_t stride) const;

  const GlContext& context_;
  const DispatchTable& gl_;
  const bool has_objects_;  ///< transform feedback objects, from OpenGL 4.0 on
  GLint program_ = 0;
  GLint generic_ = 0;
  GLint application_object_ = 0;
  GLuint object_ = 0;
  // Without transform feedback objects:
  GLint indexed_ = 0;
  GLint64 start_ = 0;
  GLint64 size_ = 0;
  GLboolean discard_ = GL_FALSE;
  GLuint buffer_ = 0;
  std::array<GLuint, 2> queries_{};
};

}  // namespace understudy::spu
