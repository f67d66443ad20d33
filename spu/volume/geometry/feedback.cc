// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/geometry/feedback.h"

#include <cmath>

#include "spu/volume/context/context.h"

namespace understudy::spu {
namespace {

constexpr std::size_t first_buffer = std::size_t(1) << 18;  // floats: about 1,500 slices
constexpr std::size_t largest_buffer = std::size_t(1) << 26;
constexpr std::size_t floats_per_vertex = 12;  // GL_4D_COLOR_TEXTURE: x y z w, r g b a, s t r q

struct Window {
  std::array<GLint, 4> viewport{};
  std::array<GLdouble, 2> depth_range{};
};

/// Restores the application's feedback buffer in its destructor.
class FeedbackState {
 public:
  explicit FeedbackState(const DispatchTable& gl) : gl_(gl) {
    gl_.GetIntegerv(GL_FEEDBACK_BUFFER_SIZE, &size_);
    gl_.GetIntegerv(GL_FEEDBACK_BUFFER_TYPE, &type_);
    gl_.GetPointerv(GL_FEEDBACK_BUFFER_POINTER, &buffer_);
  }
  ~FeedbackState() { gl_.FeedbackBuffer(size_, GLenum(type_), static_cast<GLfloat*>(buffer_)); }
  FeedbackState(const FeedbackState&) = delete;
  FeedbackState& operator=(const FeedbackState&) = delete;

 private:
  const DispatchTable& gl_;
  GLint size_ = 0;
  GLint type_ = 0;
  void* buffer_ = nullptr;
};

/// In its scope, OpenGL writes what is drawn into `buffer` instead of the framebuffer. Shading is always
/// smooth, so that every vertex has its own colour: in a clipped polygon with flat shading, Mesa leaves the
/// colours of new vertices unset.
class FeedbackMode {
 public:
  FeedbackMode(const DispatchTable& gl, std::vector<float>& buffer) : gl_(gl), application_(gl) {
    gl_.GetIntegerv(GL_SHADE_MODEL, &shade_model_);
    gl_.ShadeModel(GL_SMOOTH);
    gl_.FeedbackBuffer(GLsizei(buffer.size()), GL_4D_COLOR_TEXTURE, buffer.data());
    gl_.RenderMode(GL_FEEDBACK);
  }
  ~FeedbackMode() {
    if (!ended_) gl_.RenderMode(GL_RENDER);
    gl_.ShadeModel(GLenum(shade_model_));
  }
  FeedbackMode(const FeedbackMode&) = delete;
  FeedbackMode& operator=(const FeedbackMode&) = delete;

  /// Ends feedback. Returns the number of values written; negative if the buffer is too small.
  GLint end() {
    ended_ = true;
    return gl_.RenderMode(GL_RENDER);
  }

 private:
  const DispatchTable& gl_;
  const FeedbackState application_;
  GLint shade_model_ = GL_SMOOTH;
  bool ended_ = false;
};

ObservedVertex vertex_from(const float* f, const Window& window) {
  ObservedVertex v;
  const double w = f[3];
  const double x = 2.0 * (f[0] - window.viewport[0]) / window.viewport[2] - 1.0;
  const double y = 2.0 * (f[1] - window.viewport[1]) / window.viewport[3] - 1.0;
  const double near = window.depth_range[0];
  const double far = window.depth_range[1];
  const double z = (2.0 * f[2] - near - far) / (far - near);
  v.clip = {x * w, y * w, z * w, w};
  const double q = f[11];
  v.texture = {f[8] / q, f[9] / q, f[10] / q};
  return v;
}

ObservedPolygons parse(std::span<const float> feedback, const Window& window, bool stack) {
  ObservedPolygons polygons;
  polygons.clipped = true;
  std::optional<std::array<float, 4>> first_colour;
  std::size_t i = 0;
  double slice = 0;
  while (i + 1 < feedback.size()) {
    if (stack && feedback[i] == float(GL_PASS_THROUGH_TOKEN)) {
      slice = feedback[i + 1];
      i += 2;
      continue;
    }
    if (feedback[i] != float(GL_POLYGON_TOKEN)) break;
    const auto count = std::size_t(feedback[i + 1]);
    i += 2;
    if (feedback.size() - i < count * floats_per_vertex) break;
    for (std::size_t k = 0; k < count; ++k, i += floats_per_vertex) {
      const float* f = &feedback[i];
      polygons.vertices.push_back(vertex_from(f, window));
      if (stack) polygons.vertices.back().texture[2] = slice;
      const std::array<float, 4> colour{f[4], f[5], f[6], f[7]};
      if (!first_colour) polygons.constant_colour = first_colour = colour;
      for (int c = 0; c < 4; ++c) {
        if (std::abs(colour[c] - (*first_colour)[c]) > 1e-3F) polygons.constant_colour.reset();
      }
    }
    polygons.first.push_back(polygons.vertices.size());
  }
  // Points or lines among the slices are not supported: the result is empty.
  return i == feedback.size() ? polygons : ObservedPolygons{};
}

}  // namespace

ObservedPolygons observe_by_feedback(const GlContext& context, const Run& run, GivenVertices& given) {
  const DispatchTable& gl = *context.gl;
  Window window;
  gl.GetIntegerv(GL_VIEWPORT, window.viewport.data());
  gl.GetDoublev(GL_DEPTH_RANGE, window.depth_range.data());
  if (window.viewport[2] <= 0 || window.viewport[3] <= 0 || window.depth_range[0] == window.depth_range[1])
    return {};

  const std::vector<float> vertices = given.read(run);
  std::vector<float> buffer(first_buffer);
  GLint values = -1;
  while (true) {
    FeedbackMode feedback(gl, buffer);
    if (vertices.empty()) {
      run.replay(gl);
    } else {
      given.draw(run, vertices);
    }
    values = feedback.end();
    if (values >= 0 || buffer.size() >= largest_buffer) break;
    buffer.resize(buffer.size() * 4);
  }
  if (values < 0) return {};
  return parse(std::span(buffer).first(std::size_t(values)), window, run.pipeline().stack);
}

}  // namespace understudy::spu
