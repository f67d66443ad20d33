// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/geometry/transform_feedback.h"

#include "spu/volume/observation/client_arrays.h"

namespace understudy::spu {
namespace {

constexpr GLsizeiptr usual_capture = GLsizeiptr(1) << 20;  // bytes
constexpr GLsizeiptr largest_capture = GLsizeiptr(1) << 26;

/// Captures what is drawn in its scope, however the scope is left.
class Capturing {
 public:
  explicit Capturing(const DispatchTable& gl) : gl_(gl) { gl_.BeginTransformFeedback(GL_TRIANGLES); }
  ~Capturing() { gl_.EndTransformFeedback(); }
  Capturing(const Capturing&) = delete;
  Capturing& operator=(const Capturing&) = delete;

 private:
  const DispatchTable& gl_;
};

/// Counts triangles in its scope with `queries`: those generated, and those captured.
class Counting {
 public:
  Counting(const DispatchTable& gl, const std::array<GLuint, 2>& queries) : gl_(gl) {
    gl_.BeginQuery(GL_PRIMITIVES_GENERATED, queries[0]);
    gl_.BeginQuery(GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN, queries[1]);
  }
  ~Counting() {
    gl_.EndQuery(GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN);
    gl_.EndQuery(GL_PRIMITIVES_GENERATED);
  }
  Counting(const Counting&) = delete;
  Counting& operator=(const Counting&) = delete;

 private:
  const DispatchTable& gl_;
};

}  // namespace

TransformFeedback::TransformFeedback(const GlContext& context, GLuint program)
    : context_(context), gl_(*context.gl), has_objects_(context.version >= 400) {
  gl_.GetIntegerv(GL_CURRENT_PROGRAM, &program_);
  gl_.GetIntegerv(GL_TRANSFORM_FEEDBACK_BUFFER_BINDING, &generic_);
  replace_binding();
  discard_ = gl_.IsEnabled(GL_RASTERIZER_DISCARD);
  gl_.GenBuffers(1, &buffer_);
  gl_.GenQueries(2, queries_.data());
  gl_.UseProgram(program);
  gl_.Enable(GL_RASTERIZER_DISCARD);
}

TransformFeedback::~TransformFeedback() {
  if (!discard_) gl_.Disable(GL_RASTERIZER_DISCARD);
  gl_.UseProgram(GLuint(program_));
  restore_binding();
  gl_.BindBuffer(GL_TRANSFORM_FEEDBACK_BUFFER, GLuint(generic_));
  gl_.DeleteBuffers(1, &buffer_);
  gl_.DeleteQueries(2, queries_.data());
}

void TransformFeedback::replace_binding() {
  if (has_objects_) {
    // The application's own object keeps the number of vertices that glDrawTransformFeedback draws.
    gl_.GetIntegerv(GL_TRANSFORM_FEEDBACK_BINDING, &application_object_);
    gl_.GenTransformFeedbacks(1, &object_);
    gl_.BindTransformFeedback(GL_TRANSFORM_FEEDBACK, object_);
    return;
  }
  gl_.GetIntegeri_v(GL_TRANSFORM_FEEDBACK_BUFFER_BINDING, 0, &indexed_);
  gl_.GetInteger64i_v(GL_TRANSFORM_FEEDBACK_BUFFER_START, 0, &start_);
  gl_.GetInteger64i_v(GL_TRANSFORM_FEEDBACK_BUFFER_SIZE, 0, &size_);
}

void TransformFeedback::restore_binding() {
  if (has_objects_) {
    gl_.BindTransformFeedback(GL_TRANSFORM_FEEDBACK, GLuint(application_object_));
    gl_.DeleteTransformFeedbacks(1, &object_);
  } else if (size_ > 0) {
    gl_.BindBufferRange(GL_TRANSFORM_FEEDBACK_BUFFER, 0, GLuint(indexed_), GLintptr(start_), GLsizeiptr(size_));
  } else {
    gl_.BindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, GLuint(indexed_));
  }
}

std::array<GLuint, 2> TransformFeedback::draw(const Run& run, GLsizeiptr bytes) {
  gl_.BindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, buffer_);
  gl_.BufferData(GL_TRANSFORM_FEEDBACK_BUFFER, bytes, nullptr, GL_STREAM_READ);
  {
    const Counting counting(gl_, queries_);
    const Capturing capturing(gl_);
    run.replay(gl_);
  }
  std::array<GLuint, 2> counts{};
  gl_.GetQueryObjectuiv(queries_[0], GL_QUERY_RESULT, &counts[0]);
  gl_.GetQueryObjectuiv(queries_[1], GL_QUERY_RESULT, &counts[1]);
  return counts;
}

std::vector<float> TransformFeedback::read_back(std::size_t triangles, std::size_t stride) const {
  std::vector<float> data(triangles * 3 * stride);
  gl_.GetBufferSubData(GL_TRANSFORM_FEEDBACK_BUFFER, 0, GLsizeiptr(data.size() * sizeof(float)), data.data());
  return data;
}

std::vector<float> TransformFeedback::counted_triangles(const Run& run, std::size_t triangles,
                                                        std::size_t stride) {
  // If the driver refuses a draw, zeros remain: triangles without area.
  const std::vector<float> zeros(triangles * 3 * stride);
  gl_.BindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, buffer_);
  gl_.BufferData(GL_TRANSFORM_FEEDBACK_BUFFER, GLsizeiptr(zeros.size() * sizeof(float)), zeros.data(),
                 GL_STREAM_READ);
  {
    const Capturing capturing(gl_);
    run.replay(gl_);
  }
  return read_back(triangles, stride);
}

std::vector<float> TransformFeedback::triangles(const Run& run, std::size_t stride) {
  const auto bytes_of = [stride](std::size_t triangles) {
    return GLsizeiptr(triangles * 3 * stride * sizeof(float));
  };
  const auto known = run.triangles();
  if (known && *known > 0 && bytes_of(*known) <= usual_capture && !restarts_primitives(context_))
    return counted_triangles(run, *known, stride);
  std::array<GLuint, 2> triangles = draw(run, usual_capture);
  if (triangles[1] < triangles[0]) {
    if (bytes_of(triangles[0]) > largest_capture) return {};
    triangles = draw(run, bytes_of(triangles[0]));
  }
  if (triangles[1] == 0 || triangles[1] < triangles[0]) return {};
  return read_back(triangles[1], stride);
}

}  // namespace understudy::spu
