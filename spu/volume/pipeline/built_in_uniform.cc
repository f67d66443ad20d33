// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/pipeline/built_in_uniform.h"

#include <algorithm>
#include <array>
#include <limits>
#include <span>

#include "spu/volume/pipeline/block_members.h"

namespace understudy::spu {
namespace {

constexpr int lights = 8;  // the number that OpenGL guarantees

/// Reads state as numbers, one after the other.
class StateNumbers {
 public:
  explicit StateNumbers(const DispatchTable& gl) : gl_(gl) {}

  void add(GLenum name) {
    take(4, [&](GLfloat* to) { gl_.GetFloatv(name, to); });
  }
  void add_matrices() {
    for (const GLenum name : {GL_MODELVIEW_MATRIX, GL_PROJECTION_MATRIX})
      take(16, [&](GLfloat* to) { gl_.GetFloatv(name, to); });
  }
  void add_material(GLenum face) {
    for (const GLenum name : {GL_AMBIENT, GL_DIFFUSE, GL_SPECULAR, GL_EMISSION, GL_SHININESS})
      take(4, [&](GLfloat* to) { gl_.GetMaterialfv(face, name, to); });
  }
  void add_lights() {
    for (int light = 0; light < lights; ++light) {
      for (const GLenum name :
           {GL_AMBIENT, GL_DIFFUSE, GL_SPECULAR, GL_POSITION, GL_SPOT_DIRECTION, GL_SPOT_EXPONENT,
            GL_SPOT_CUTOFF, GL_CONSTANT_ATTENUATION, GL_LINEAR_ATTENUATION, GL_QUADRATIC_ATTENUATION})
        take(4, [&](GLfloat* to) { gl_.GetLightfv(GLenum(GL_LIGHT0 + light), name, to); });
    }
    add(GL_LIGHT_MODEL_AMBIENT);
  }
  void add_fog() {
    for (const GLenum name : {GL_FOG_COLOR, GL_FOG_DENSITY, GL_FOG_START, GL_FOG_END}) add(name);
  }
  void add_points() {
    for (const GLenum name : {GL_POINT_SIZE, GL_POINT_SIZE_MIN, GL_POINT_SIZE_MAX, GL_POINT_FADE_THRESHOLD_SIZE,
                              GL_POINT_DISTANCE_ATTENUATION})
      add(name);
  }
  void add_clip_planes() {
    GLint planes = 0;
    gl_.GetIntegerv(GL_MAX_CLIP_PLANES, &planes);
    for (int i = 0; i < planes; ++i) {
      std::array<GLdouble, 4> plane{};
      gl_.GetClipPlane(GLenum(GL_CLIP_PLANE0 + i), plane.data());
      for (const double number : plane) numbers_.push_back(float(number));
    }
  }
  /// Environment colours, matrices and generated coordinates of the fixed-function texture units.
  void add_texture_units() {
    GLint units = 0;
    GLint active = 0;
    gl_.GetIntegerv(GL_MAX_TEXTURE_COORDS, &units);
    gl_.GetIntegerv(GL_ACTIVE_TEXTURE, &active);
    for (int unit = 0; unit < units; ++unit) {
      gl_.ActiveTexture(GLenum(GL_TEXTURE0 + unit));
      take(4, [&](GLfloat* to) { gl_.GetTexEnvfv(GL_TEXTURE_ENV, GL_TEXTURE_ENV_COLOR, to); });
      take(16, [&](GLfloat* to) { gl_.GetFloatv(GL_TEXTURE_MATRIX, to); });
      for (const GLenum axis : {GL_S, GL_T, GL_R, GL_Q}) {
        for (const GLenum plane : {GL_EYE_PLANE, GL_OBJECT_PLANE})
          take(4, [&](GLfloat* to) { gl_.GetTexGenfv(axis, plane, to); });
      }
    }
    gl_.ActiveTexture(GLenum(active));
  }

  std::vector<double> digest() const {
    std::vector<float> digest;
    append_digest(std::as_bytes(std::span(numbers_)), digest);
    return {digest.begin(), digest.end()};
  }

 private:
  template <class Get>
  void take(std::size_t count, const Get& get) {
    std::array<GLfloat, 16> value{};
    get(value.data());
    numbers_.insert(numbers_.end(), value.begin(), value.begin() + std::ptrdiff_t(count));
  }

  const DispatchTable& gl_;
  std::vector<float> numbers_;
};

}  // namespace

std::vector<double> built_in_uniform(const DispatchTable& gl, std::string_view name) {
  const auto is_any_of = [&](auto... beginnings) { return (name.starts_with(beginnings) || ...); };
  StateNumbers state(gl);
  if (is_any_of("gl_ModelView", "gl_Projection", "gl_Normal")) {
    state.add_matrices();
  } else if (is_any_of("gl_FrontMaterial", "gl_BackMaterial", "gl_FrontLight", "gl_BackLight", "gl_LightSource",
                       "gl_LightModel")) {
    state.add_material(GL_FRONT);
    state.add_material(GL_BACK);
    state.add_lights();
  } else if (is_any_of("gl_Fog")) {
    state.add_fog();
  } else if (is_any_of("gl_TextureEnvColor", "gl_TextureMatrix", "gl_EyePlane", "gl_ObjectPlane")) {
    state.add_texture_units();
  } else if (is_any_of("gl_ClipPlane")) {
    state.add_clip_planes();
  } else if (is_any_of("gl_DepthRange")) {
    state.add(GL_DEPTH_RANGE);
  } else if (is_any_of("gl_Point")) {
    state.add_points();
  } else {
    return {std::numeric_limits<double>::quiet_NaN()};
  }
  return state.digest();
}

}  // namespace understudy::spu
