// SPDX-License-Identifier: Apache-2.0
// Cameras and requests for tests.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/volume/fields.h"
#include "volume/matrix.h"
#include "volume/reference/slice_sum.h"
#include "volume/request.h"

namespace understudy::volume::testing {

inline Matrix4 perspective(double fov_degrees, double aspect, double near, double far) {
  const double f = 1 / std::tan(fov_degrees * std::numbers::pi / 360);
  return {f / aspect, 0, 0,  0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), 2 * far * near / (near - far),
          0,          0, -1, 0};
}

inline Matrix4 parallel(double half_width, double half_height, double near, double far) {
  return {1 / half_width,
          0,
          0,
          0,
          0,
          1 / half_height,
          0,
          0,
          0,
          0,
          2 / (near - far),
          (far + near) / (near - far),
          0,
          0,
          0,
          1};
}

inline Vec3 normalised(const Vec3& v) {
  return scale(v, 1 / length(v));
}

inline Matrix4 look_at(const Vec3& eye, const Vec3& centre, const Vec3& up) {
  const Vec3 forward = normalised(subtract(centre, eye)), side = normalised(cross(forward, up)),
             above = cross(side, forward);
  return {
      side[0],     side[1],     side[2],     -dot(side, eye),   above[0], above[1], above[2], -dot(above, eye),
      -forward[0], -forward[1], -forward[2], dot(forward, eye), 0,        0,        0,        1};
}

/// Places the volume as a unit cube around the origin of world space.
inline Matrix4 unit_cube() {
  return {1, 0, 0, -0.5, 0, 1, 0, -0.5, 0, 0, 1, -0.5, 0, 0, 0, 1};
}

/// `count` planes that face the viewer, front to back over the whole region; no plane touches a corner of the
/// region.
inline SlicePlanes facing_planes(const Matrix4& m, const Box& region, int count) {
  SlicePlanes planes;
  planes.normal = {m[12], m[13], m[14]};  // planes of constant distance from the eye
  if (length(planes.normal) < 1e-9) planes.normal = {m[8], m[9], m[10]};
  double low = 1e300, high = -1e300;
  for (int corner = 0; corner < 8; ++corner) {
    double s = 0;
    for (int k = 0; k < 3; ++k) s += planes.normal[k] * (corner >> k & 1 ? region.high[k] : region.low[k]);
    low = std::min(low, s);
    high = std::max(high, s);
  }
  planes.count = count;
  planes.spacing = (high - low) / count;
  planes.first = low + 0.37 * planes.spacing;
  return planes;
}

/// Colour and opacity vary over the whole range of values.
inline TransferFunction smooth_table(int entries = 256, float opacity = 0.2F) {
  TransferFunction f;
  for (int i = 0; i < entries; ++i) {
    const float v = float(i) / float(entries - 1), a = opacity * v * v;
    f.entries.push_back({a * v, a * (1 - v), a * 0.5F, a});
  }
  return f;
}

inline RenderRequest request_for(const Texture& texture, const Matrix4& texture_to_clip, int width, int height,
                                 int planes) {
  RenderRequest r;
  r.volume = texture.description.id;
  r.texture_to_clip = texture_to_clip;
  r.viewport = {3, 5, width, height};
  r.window = r.viewport;
  r.planes = facing_planes(texture_to_clip, r.region, planes);
  r.termination = 0;
  if (texture.description.type == TexelType::rgba8)
    r.classification = LinearMap{};
  else
    r.classification = smooth_table();
  return r;
}

inline Matrix4 usual_camera(int width, int height) {
  return multiply(perspective(40, double(width) / height, 0.1, 10),
                  multiply(look_at({0.9, 0.7, 1.6}, {0, 0, 0}, {0, 1, 0}), unit_cube()));
}

struct Difference {
  double max = 0;
  double rms = 0;
  int pixels_over = 0;  ///< pixels that differ by more than the given bound
};

template <typename A, typename B>
Difference difference(const A& a, const B& b, double bound = 1e300) {
  Difference d;
  double sum = 0;
  for (std::size_t p = 0; p < a.rgba.size(); p += 4) {
    double largest = 0;
    for (std::size_t k = p; k < p + 4; ++k) {
      const double delta = std::abs(double(a.rgba[k]) - double(b.rgba[k]));
      largest = std::max(largest, std::isnan(delta) ? 1e300 : delta);
      sum += delta * delta;
    }
    d.max = std::max(d.max, largest);
    d.pixels_over += largest > bound;
  }
  d.rms = std::sqrt(sum / double(std::max<std::size_t>(a.rgba.size(), 1)));
  return d;
}

}  // namespace understudy::volume::testing
