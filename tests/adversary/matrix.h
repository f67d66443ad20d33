// SPDX-License-Identifier: Apache-2.0
// Vectors of three, matrices of four columns, and the cameras that the scenarios look through.
#pragma once

#include <array>

namespace adversary {

struct Vector {
  float x = 0, y = 0, z = 0;
};
constexpr Vector operator+(Vector a, Vector b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
constexpr Vector operator-(Vector a, Vector b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
constexpr Vector operator*(float s, Vector a) {
  return {s * a.x, s * a.y, s * a.z};
}
constexpr float dot(Vector a, Vector b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
Vector cross(Vector a, Vector b);
Vector normalized(Vector a);

/// Columns first, as OpenGL takes them.
using Matrix = std::array<float, 16>;
Matrix operator*(const Matrix& a, const Matrix& b);
extern const Matrix identity;

/// The volume is the box [0,1]^3, so that a position is its texture coordinate.
struct Camera {
  Vector eye;
  Vector forward;  ///< of unit length
  Matrix projection;
  Matrix view;
  Matrix clip_from_object() const { return projection * view; }
};

enum class Projection { perspective, parallel };

struct Orbit {
  float azimuth = 30, elevation = 20;  ///< degrees
  float distance = 2.6F;               ///< of the eye from the volume's centre
  float degrees_each_frame = 1;
  Projection projection = Projection::perspective;
  float sideways = 0;  ///< how far the eye moves to its right without turning
};

/// Looks at the volume's centre; the volume fills most of the window.
Camera camera_at(const Orbit& orbit, int frame, float aspect = 1);

}  // namespace adversary
