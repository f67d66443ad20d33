// SPDX-License-Identifier: Apache-2.0
#include "box_ray_caster.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "glsl_program.h"

namespace understudy::spu::testing {
namespace {

constexpr const char* vertex_source =
    "#version 330\n"
    "uniform mat4 camera; uniform vec4 eye; uniform bool way_from_eye; in vec3 corner;\n"
    "out vec3 corner_between;\n"
    "void main() {\n"
    "  corner_between = corner - (way_from_eye ? eye.xyz : vec3(0.0));\n"
    "  gl_Position = camera * vec4(corner, 1.0);\n"
    "}\n";

constexpr const char* fragment_source =
    "#version 330\n"
    // `gradients` is never set and therefore uses the unit of `field`, as in programs that reserve a lighting
    // texture.
    "uniform sampler3D field, gradients; uniform sampler1D table; uniform sampler2D opaque, noise;\n"
    "uniform mat4 inverse_camera; uniform vec4 eye; uniform vec3 extent; uniform float one_step;\n"
    "uniform int composition; uniform bool straight, divided, lit, whole_rays, jittered, noisy, at_least_one, "
    "reads_depth;\n"
    "uniform vec2 window; uniform float past_planes; uniform bool discards, over_background;\n"
    "uniform vec3 background; uniform vec4 shown; uniform float shown_radius, ends_at;\n"
    "uniform bool way_from_eye;\n"
    "uniform float in_croppingPlanes[6]; uniform int in_croppingFlags[32]; uniform float "
    "in_clippingPlanes[49];\n"
    "uniform mat4 in_volumeMatrix[1], in_textureDatasetMatrix[1], in_inverseTextureDatasetMatrix[1];\n"
    "in vec3 corner_between; out vec4 colour; uniform bool lit_from_eye; uniform vec3 tap; uniform float "
    "ambient; vec3 to_eye;\n"
    "vec4 classified(vec3 at) {\n"
    "  vec4 c = texture(table, texture(field, at).r);\n"
    "  if (lit) {\n"
    "    vec3 h = vec3(0.02, 0.0, 0.0);\n"
    "    vec3 g = vec3(texture(gradients, at + h.xyy).r - texture(gradients, at - h.xyy).r,\n"
    "                  texture(gradients, at + h.yxy).r - texture(gradients, at - h.yxy).r,\n"
    "                  texture(gradients, at + h.yyx).r - texture(gradients, at - h.yyx).r);\n"
    "    c.rgb *= length(g) > 0.0 ? 0.2 + 0.8 * abs(normalize(g).x) : 0.2;\n"
    "  }\n"
    "  if (lit_from_eye) {\n"
    "    vec3 h = tap;\n"
    "    vec3 g = vec3(texture(field, at + h * vec3(1.0, 0.0, 0.0)).r - texture(field, at - h * vec3(1.0, 0.0, "
    "0.0)).r,\n"
    "                  texture(field, at + h * vec3(0.0, 1.0, 0.0)).r - texture(field, at - h * vec3(0.0, 1.0, "
    "0.0)).r,\n"
    "                  texture(field, at + h * vec3(0.0, 0.0, 1.0)).r - texture(field, at - h * vec3(0.0, 0.0, "
    "1.0)).r) /\n"
    "             (h * extent);\n"
    "    float steepness = length(g);\n"
    "    float facing = steepness > 0.0 ? abs(dot(g / steepness, to_eye)) : 0.0;\n"
    "    float white = steepness > 0.0 ? 0.2 * pow(max(2.0 * facing * facing - 1.0, 0.0), 8.0) : 0.0;\n"
    "    c.rgb = c.rgb * (ambient + 0.6 * facing) + white;\n"
    "  }\n"
    "  return vec4(c.rgb * c.a, c.a);\n"
    "}\n"
    "bool kept(vec3 at) {\n"
    "  int region = 1, stride = 1;\n"
    "  for (int k = 0; k < 3; ++k, stride *= 3) {\n"
    "    for (int side = 0; side < 2; ++side) {\n"
    "      vec4 plane = vec4(0.0, 0.0, 0.0, 1.0);\n"
    "      plane[k] = in_croppingPlanes[2 * k + side];\n"
    "      if (at[k] >= (in_inverseTextureDatasetMatrix[0] * plane)[k]) region += stride;\n"
    "    }\n"
    "  }\n"
    "  return in_croppingFlags[region] != 0;\n"
    "}\n"
    "void main() {\n"
    "  vec2 here = gl_FragCoord.xy;\n"
    "  if (discards && (any(lessThan(here, shown.xy)) || any(greaterThan(here, shown.zw)))) discard;\n"
    "  if (discards && shown_radius > 0.0 && distance(here, 0.5 * window) > shown_radius) discard;\n"
    "  vec3 place = corner_between + (way_from_eye ? eye.xyz : vec3(0.0));\n"
    "  vec3 along = eye.w != 0.0 ? place - eye.xyz : eye.xyz;\n"
    "  if (whole_rays) {\n"
    "    vec3 to_entry = (vec3(lessThan(along, vec3(0.0))) - place) / along;\n"
    "    place += along * max(to_entry.x, max(to_entry.y, to_entry.z));\n"
    "  }\n"
    "  vec3 step = along / length(along * extent) * one_step;\n"
    "  to_eye = -normalize(along * extent);\n"
    "  vec3 to_exit = (vec3(greaterThan(step, vec3(0.0))) - place) / step;\n"
    "  float steps = min(to_exit.x, min(to_exit.y, to_exit.z));\n"
    "  float first = 1.0, count = floor(steps);\n"
    "  mat4 to_world = in_volumeMatrix[0] * in_textureDatasetMatrix[0];\n"
    "  float begin = 0.0, end_of_ray = steps;\n"
    "  for (int i = 0; i < int(in_clippingPlanes[0]); i += 6) {\n"
    "    vec3 normal = vec3(in_clippingPlanes[i + 4], in_clippingPlanes[i + 5], in_clippingPlanes[i + 6]);\n"
    "    vec3 point = vec3(in_clippingPlanes[i + 1], in_clippingPlanes[i + 2], in_clippingPlanes[i + 3]);\n"
    "    float above = dot(normal, (to_world * vec4(place, 1.0)).xyz - point);\n"
    "    float rise = dot(normal, mat3(to_world) * step);\n"
    "    if (rise > 0.0) begin = max(begin, -above / rise);\n"
    "    else end_of_ray = min(end_of_ray, -above / rise);\n"
    "  }\n"
    "  if (discards && begin >= end_of_ray) discard;\n"
    "  if (begin > 0.0 || end_of_ray < steps)\n"
    "  {\n"
    "    float shown = end_of_ray - begin;\n"
    "    if (end_of_ray < steps && past_planes > 0.0) shown = max(shown, 1.0) + past_planes;\n"
    "    count = floor(min(shown, steps - begin));\n"
    "  }\n"
    "  vec3 from = place + begin * step;\n"
    "  if (divided) {\n"
    "    count = max(floor(steps + 0.5), at_least_one ? 1.0 : 0.0); step *= steps / count; first = 0.0;\n"
    "  }\n"
    "  if (jittered) first = fract(sin(dot(gl_FragCoord.xy, vec2(12.9898, 78.233))) * 43758.5) + 0.5;\n"
    "  if (noisy) first = texture(noise, gl_FragCoord.xy / vec2(textureSize(noise, 0))).r;\n"
    "  count = jittered || noisy ? floor(steps - first) + 1.0 : count;\n"
    "  if (at_least_one) count = max(count, 1.0);\n"
    "  if (discards && count < 1.0) discard;\n"
    "  if (reads_depth) {\n"
    "    vec4 end = vec4(2.0 * gl_FragCoord.xy / window - 1.0, 0.0, 1.0);\n"
    "    end.z = 2.0 * texelFetch(opaque, ivec2(gl_FragCoord.xy), 0).r - 1.0;\n"
    "    if (discards && gl_FragCoord.z * 2.0 - 1.0 >= end.z) discard;\n"
    "    end = inverse_camera * end;\n"
    "    count = min(count, ceil(length((end.xyz / end.w - place) * extent) / one_step));\n"
    "  }\n"
    "  vec4 sum = vec4(0.0); float largest = 0.0, least = 1.0, grey = 0.0, values = 0.0; uint taken = 0u;\n"
    "  for (float i = 0.0; i < count && sum.a < ends_at; ++i) {\n"
    "    vec3 at = from + (first + i) * step;\n"
    "    if (!kept(at)) continue;\n"
    "    vec4 sample_colour = classified(at);\n"
    "    if (composition == 0) sum += (1.0 - sum.a) * sample_colour;\n"
    "    if (composition == 2) sum += sample_colour;\n"
    "    largest = max(largest, texture(field, at).r);\n"
    "    least = min(least, texture(field, at).r);\n"
    "    grey += sample_colour.a * texture(field, at).r;\n"
    "    values += texture(field, at).r;\n"
    "    ++taken;\n"
    "  }\n"
    "  if (composition == 3) largest = least;\n"
    "  if (composition == 1 || composition == 3) { vec4 c = texture(table, largest); sum = vec4(c.rgb * c.a, "
    "c.a); }\n"
    "  if (composition == 4) sum = vec4(vec3(min(grey, 1.0)), 1.0);\n"
    "  if (discards && composition >= 5 && taken == 0u) discard;\n"
    "  if (composition == 5) sum = vec4(vec3(clamp(grey / float(taken), 0.0, 1.0)), 1.0);\n"
    "  if (composition == 6) { vec4 c = texture(table, values / float(taken)); sum = vec4(c.rgb * c.a, c.a); "
    "}\n"
    "  sum.a = min(sum.a, 1.0);\n"
    "  colour = straight && sum.a > 0.0 ? vec4(sum.rgb / sum.a, sum.a) : sum;\n"
    "  if (over_background) colour = vec4(sum.rgb + (1.0 - sum.a) * background, 1.0);\n"
    "}\n";

constexpr const char* wall_vertices =
    "#version 330\n"
    "uniform float depth;\n"
    "void main() {\n"
    "  vec2 unit = vec2(gl_VertexID & 1, gl_VertexID >> 1);\n"
    "  gl_Position = vec4(unit - vec2(1.0, 0.5), 2.0 * depth - 1.0, 1.0);\n"
    "}\n";
constexpr const char* wall_fragments =
    "#version 330\n"
    "out vec4 colour; void main() { colour = vec4(0.9, 0.8, 0.1, 1.0); }\n";

/// Replaces the first occurrence of `from`, which must exist.
void replace(std::string& text, std::string_view from, std::string_view to) {
  text.replace(text.find(from), from.size(), to);
}

/// Two triangles per face, counterclockwise from outside.
std::vector<GLfloat> box_triangles() {
  std::vector<GLfloat> triangles;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const bool high : {false, true}) {
      const std::array<std::array<GLfloat, 2>, 4> square{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
      for (const std::size_t turn : {0, 1, 2, 0, 2, 3}) {
        const auto& [a, b] = square[turn];
        std::array<GLfloat, 3> corner{};
        corner[axis] = high ? 1 : 0;
        corner[(axis + 1) % 3] = high ? a : b;
        corner[(axis + 2) % 3] = high ? b : a;
        triangles.insert(triangles.end(), corner.begin(), corner.end());
      }
    }
  }
  return triangles;
}

using Matrix = std::array<double, 16>;  // column-major

struct Camera {
  Matrix forward;
  Matrix inverse;
  std::array<float, 4> eye;  ///< in the box's coordinates; with w = 0 the viewing direction
};

/// projection * translate(0, 0, -distance) * rotate * scale(extent) * translate(-1/2), and its inverse.
Camera camera_of(const MarchStyle& c, double angle) {
  const double cosine = std::cos(angle * M_PI / 180);
  const double sine = std::sin(angle * M_PI / 180);
  const double tilt = 0.4;
  // Rows of the rotation: about y by the angle, then about x by the tilt.
  const std::array<std::array<double, 3>, 3> turn = {
      {{cosine, 0, sine},
       {std::sin(tilt) * sine, std::cos(tilt), -std::sin(tilt) * cosine},
       {-std::cos(tilt) * sine, std::sin(tilt), std::cos(tilt) * cosine}}};
  const double near = c.near;
  const double far = 10;
  const double f = c.parallel ? 1.0 : 2.8;
  const double zz = c.parallel ? -2 / (far - near) : (far + near) / (near - far);
  const double zt = c.parallel ? -(far + near) / (far - near) : 2 * far * near / (near - far);
  Camera camera{};
  std::array<double, 3> eye{};  // x = extent (t - 1/2); eye space e = turn x - (0, 0, distance)
  for (std::size_t k = 0; k < 3; ++k) {
    const std::array<double, 3> e = {turn[0][k] * c.extent[k], turn[1][k] * c.extent[k],
                                     turn[2][k] * c.extent[k]};
    camera.forward[4 * k] = f * e[0];
    camera.forward[4 * k + 1] = f * e[1];
    camera.forward[4 * k + 2] = zz * e[2];
    camera.forward[4 * k + 3] = c.parallel ? 0 : -e[2];
    eye[k] = c.parallel ? -turn[2][k] / c.extent[k] : turn[2][k] * c.distance / c.extent[k] + 0.5;
    camera.eye[k] = float(eye[k]);
  }
  camera.eye[3] = c.parallel ? 0 : 1;
  for (std::size_t row = 0; row < 4; ++row) {
    double middle = 0;
    for (std::size_t k = 0; k < 3; ++k) middle += 0.5 * camera.forward[4 * k + row];
    camera.forward[12 + row] = -middle;
  }
  camera.forward[14] += -zz * c.distance + zt;
  camera.forward[15] += c.parallel ? 1 : c.distance;
  // Inverse: e from clip, x from e (the rotation's transpose), t from x.
  const auto backwards = [&](std::array<double, 4> clip) {
    std::array<double, 4> e{};
    if (c.parallel) {
      e = {clip[0] / f, clip[1] / f, (clip[2] - zt * clip[3]) / zz, clip[3]};
    } else {
      // clip.w = -e.z, clip.z = zz e.z + zt e.w
      e = {clip[0] / f, clip[1] / f, -clip[3], (clip[2] + zz * clip[3]) / zt};
    }
    e[2] += c.distance * e[3];
    std::array<double, 4> t{0, 0, 0, e[3]};
    for (std::size_t k = 0; k < 3; ++k) {
      const double x = turn[0][k] * e[0] + turn[1][k] * e[1] + turn[2][k] * e[2];
      t[k] = x / c.extent[k] + 0.5 * e[3];
    }
    return t;
  };
  for (std::size_t k = 0; k < 4; ++k) {
    std::array<double, 4> unit{};
    unit[k] = 1;
    const auto column = backwards(unit);
    for (std::size_t row = 0; row < 4; ++row) camera.inverse[4 * k + row] = column[row];
  }
  return camera;
}

using Corner = std::array<double, 3>;

void append_fan(const std::vector<Corner>& polygon, std::vector<GLfloat>& triangles) {
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    for (const std::size_t corner : {std::size_t(0), i - 1, i})
      for (const double x : polygon[corner]) triangles.push_back(GLfloat(x));
  }
}

/// The part of the box's triangles that lies behind `depth`, closed there by a cap.
std::vector<GLfloat> triangles_behind(const Camera& camera, double depth) {
  const auto behind = [&](const Corner& p) {
    double w = camera.forward[15] - depth;
    for (std::size_t k = 0; k < 3; ++k) w += camera.forward[4 * k + 3] * p[k];
    return w;
  };
  const std::vector<GLfloat> whole = box_triangles();
  std::vector<GLfloat> triangles;
  std::vector<Corner> rim;
  for (std::size_t first = 0; first < whole.size(); first += 9) {
    std::vector<Corner> part;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto corner = [&](std::size_t n) {
        const GLfloat* from = whole.data() + first + 3 * (n % 3);
        return Corner{from[0], from[1], from[2]};
      };
      const Corner a = corner(i);
      const Corner b = corner(i + 1);
      if (behind(a) >= 0) part.push_back(a);
      if ((behind(a) >= 0) == (behind(b) >= 0)) continue;
      const double s = behind(a) / (behind(a) - behind(b));
      Corner crossing{};
      for (std::size_t k = 0; k < 3; ++k) crossing[k] = a[k] + s * (b[k] - a[k]);
      part.push_back(crossing);
      rim.push_back(crossing);
    }
    append_fan(part, triangles);
  }
  // The rim lies in a plane of constant depth; its points are sorted by angle about their centre, in eye space.
  const auto seen = [&](const Corner& p) {
    std::array<double, 2> place{camera.forward[12], camera.forward[13]};
    for (std::size_t k = 0; k < 3; ++k) {
      place[0] += camera.forward[4 * k] * p[k];
      place[1] += camera.forward[4 * k + 1] * p[k];
    }
    return place;
  };
  std::array<double, 2> middle{};
  for (const Corner& p : rim) {
    for (std::size_t k = 0; k < 2; ++k) middle[k] += seen(p)[k] / double(rim.size());
  }
  const auto turn = [&](const Corner& p) { return std::atan2(seen(p)[1] - middle[1], seen(p)[0] - middle[0]); };
  std::sort(rim.begin(), rim.end(), [&](const Corner& a, const Corner& b) { return turn(a) < turn(b); });
  append_fan(rim, triangles);
  return triangles;
}

void set_matrix(const DispatchTable& gl, GLuint program, const char* name, const Matrix& matrix) {
  std::array<GLfloat, 16> values{};
  for (std::size_t i = 0; i < 16; ++i) values[i] = GLfloat(matrix[i]);
  gl.UniformMatrix4fv(gl.GetUniformLocation(program, name), 1, GL_FALSE, values.data());
}

/// Dataset coordinates are the box in its own unit; world coordinates are displaced from them.
void set_cuts(const DispatchTable& gl, const MarchStyle& style, GLuint program) {
  Matrix to_dataset{};
  Matrix to_texture{};
  for (std::size_t k = 0; k < 3; ++k) {
    to_dataset[5 * k] = double(style.extent[k]);
    to_texture[5 * k] = 1 / double(style.extent[k]);
  }
  to_dataset[15] = to_texture[15] = 1;
  set_matrix(gl, program, "in_textureDatasetMatrix[0]", to_dataset);
  set_matrix(gl, program, "in_inverseTextureDatasetMatrix[0]", to_texture);
  set_matrix(gl, program, "in_volumeMatrix[0]", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 2, 3, 1});
  const auto at = [&](const char* name) { return gl.GetUniformLocation(program, name); };
  gl.Uniform1fv(at("in_croppingPlanes[0]"), 6, style.cropping_planes.data());
  std::array<GLint, 32> flags{};
  for (std::size_t region = 0; region < 27; ++region)
    flags[region + 1] = GLint(style.kept_regions >> region & 1U);
  gl.Uniform1iv(at("in_croppingFlags[0]"), GLsizei(flags.size()), flags.data());
  std::vector<GLfloat> planes{GLfloat(6 * style.clipping_planes.size())};
  for (const auto& plane : style.clipping_planes) planes.insert(planes.end(), plane.begin(), plane.end());
  gl.Uniform1fv(at("in_clippingPlanes[0]"), GLsizei(planes.size()), planes.data());
  gl.Uniform1f(at("past_planes"), style.past_planes);
}

}  // namespace

void BoxRayCaster::set_table(GlApplication& app, float opacity) const {
  std::vector<float> table;
  for (int i = 0; i < 256; ++i) {
    const float s = float(i) / 255;
    table.insert(table.end(), {s, 0.5F + 0.5F * std::sin(9 * s), 1 - s, opacity * s * s});
  }
  app.gl().ActiveTexture(GL_TEXTURE1);
  app.gl().TexImage1D(GL_TEXTURE_1D, 0, GL_RGBA32F, 256, 0, GL_RGBA, GL_FLOAT, table.data());
  app.gl().ActiveTexture(GL_TEXTURE0);
}

void BoxRayCaster::set_noise(GlApplication& app, unsigned seed) const {
  constexpr GLsizei width = 16;
  constexpr GLsizei height = 8;
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(0, 1);
  std::vector<float> noise(std::size_t(width) * height);
  for (float& number : noise) number = uniform(random);
  app.gl().ActiveTexture(GL_TEXTURE3);
  app.gl().TexImage2D(GL_TEXTURE_2D, 0, GL_R32F, width, height, 0, GL_RED, GL_FLOAT, noise.data());
  app.gl().ActiveTexture(GL_TEXTURE0);
}

void BoxRayCaster::set_up(GlApplication& app) {
  const DispatchTable& gl = app.gl();
  const auto texture = [&](GLenum unit, GLenum target, GLint filter) {
    GLuint name = 0;
    gl.GenTextures(1, &name);
    gl.ActiveTexture(unit);
    gl.BindTexture(target, name);
    gl.TexParameteri(target, GL_TEXTURE_MIN_FILTER, filter);
    gl.TexParameteri(target, GL_TEXTURE_MAG_FILTER, filter);
    for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
      gl.TexParameteri(target, axis, GL_CLAMP_TO_EDGE);
    return name;
  };
  texture(GL_TEXTURE1, GL_TEXTURE_1D, GL_LINEAR);
  set_table(app, style.composition == MarchStyle::Composition::maximum ||
                         style.composition == MarchStyle::Composition::minimum
                     ? 0.9F
                 : style.composition == MarchStyle::Composition::grey_sum ? 0.05F
                                                                          : 0.2F);
  depth_ = texture(GL_TEXTURE2, GL_TEXTURE_2D, GL_NEAREST);
  const std::vector<GLfloat> far(std::size_t(GlApplication::size) * GlApplication::size, 1.0F);
  gl.TexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT32F, GlApplication::size, GlApplication::size, 0,
                GL_DEPTH_COMPONENT, GL_FLOAT, far.data());
  texture(GL_TEXTURE3, GL_TEXTURE_2D, GL_NEAREST);
  for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    gl.TexParameteri(GL_TEXTURE_2D, axis, GL_REPEAT);
  if (style.noise_sampler) {
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST_MIPMAP_NEAREST);
    GLuint sampler = 0;
    gl.GenSamplers(1, &sampler);
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
      gl.SamplerParameteri(sampler, filter, GL_NEAREST);
    gl.BindSampler(3, sampler);
  }
  set_noise(app, 1);
  texture(GL_TEXTURE0, GL_TEXTURE_3D, GL_LINEAR);
  const Blob blob;
  std::vector<std::uint8_t> texels = blob.texels();
  // Around the blob all values are 0, which would be the minimum of all rays.
  if (style.composition == MarchStyle::Composition::minimum || style.dense_rim) {
    for (std::uint8_t& texel : texels) texel = std::uint8_t(255 - texel);
  }
  gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  gl.TexImage3D(GL_TEXTURE_3D, 0, GL_R8, blob.x, blob.y, blob.z, 0, GL_RED, GL_UNSIGNED_BYTE, texels.data());
  gl.PixelStorei(GL_UNPACK_ALIGNMENT, 4);

  std::string vertices = vertex_source;
  std::string fragments = fragment_source;
  if (style.tap_of_a_texel) replace(fragments, "vec3 h = tap;", "vec3 h = 1.0 / vec3(textureSize(field, 0));");
  if (style.matched_by_location) {
    for (std::string* const source : {&vertices, &fragments})
      replace(*source, "#version 330\n", "#version 330\n#extension GL_ARB_separate_shader_objects : require\n");
    replace(vertices, "out vec3 corner_between;", "layout(location = 2) out vec3 corner_written;");
    replace(vertices, "corner_between = ", "corner_written = ");
    replace(fragments, "in vec3 corner_between;", "layout(location = 2) in vec3 corner_between;");
  }
  program_ = glsl_program(gl, vertices.c_str(), fragments.c_str());
  wall_program_ = glsl_program(gl, wall_vertices, wall_fragments);
  const std::vector<GLfloat> triangles = box_triangles();
  gl.GenVertexArrays(1, &box_);
  gl.BindVertexArray(box_);
  gl.GenBuffers(1, &corners_);
  gl.BindBuffer(GL_ARRAY_BUFFER, corners_);
  gl.BufferData(GL_ARRAY_BUFFER, GLsizeiptr(triangles.size() * sizeof(GLfloat)), triangles.data(),
                GL_STATIC_DRAW);
  gl.EnableVertexAttribArray(0);
  gl.VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
}

void BoxRayCaster::draw(GlApplication& app, double angle, float wall) {
  // The dispatch table changes with the phase of the stream, so it is fetched for every call.
  const auto gl = [&]() -> const DispatchTable& { return app.gl(); };
  const Camera camera = camera_of(style, angle);
  gl().Viewport(0, 0, GlApplication::size, GlApplication::size);
  gl().DepthMask(GL_TRUE);
  gl().ClearColor(0.1F, 0.2F, 0.3F, 0.0F);
  gl().Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  gl().BindVertexArray(box_);
  gl().Enable(GL_DEPTH_TEST);
  if (wall > 0) {
    gl().UseProgram(wall_program_);
    gl().Uniform1f(gl().GetUniformLocation(wall_program_, "depth"), wall);
    gl().DrawArrays(GL_TRIANGLE_STRIP, 0, style.half_a_wall ? 3 : 4);
  }
  if (style.reads_depth) {
    gl().ActiveTexture(GL_TEXTURE2);
    gl().CopyTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 0, 0, GlApplication::size, GlApplication::size);
    gl().ActiveTexture(GL_TEXTURE0);
  }
  gl().DepthMask(style.writes_depth ? GL_TRUE : GL_FALSE);
  if (!style.both_faces) gl().Enable(GL_CULL_FACE);
  if (!style.replaces) gl().Enable(GL_BLEND);
  gl().BlendFunc(style.premultiplied && !style.alpha_twice ? GL_ONE : GL_SRC_ALPHA,
                 style.adds ? GL_ONE : GL_ONE_MINUS_SRC_ALPHA);
  gl().UseProgram(program_);
  const auto at = [&](const char* name) { return gl().GetUniformLocation(program_, name); };
  set_matrix(gl(), program_, "camera", camera.forward);
  set_matrix(gl(), program_, "inverse_camera", camera.inverse);
  gl().Uniform4fv(at("eye"), 1, camera.eye.data());
  gl().Uniform3fv(at("extent"), 1, style.extent.data());
  gl().Uniform2f(at("window"), GlApplication::size, GlApplication::size);
  gl().Uniform1f(at("one_step"), style.step);
  gl().Uniform1i(at("field"), 0);
  gl().Uniform1i(at("table"), 1);
  gl().Uniform1i(at("opaque"), 2);
  gl().Uniform1i(at("noise"), 3);
  gl().Uniform1i(at("over_background"), style.background ? 1 : 0);
  gl().Uniform3fv(at("background"), 1, style.background.value_or(std::array<float, 3>{}).data());
  gl().Uniform1i(at("composition"), int(style.composition));
  gl().Uniform1i(at("straight"), style.premultiplied ? 0 : 1);
  gl().Uniform1i(at("divided"), style.divided ? 1 : 0);
  gl().Uniform1i(at("lit"), style.lit ? 1 : 0);
  gl().Uniform1i(at("lit_from_eye"), style.lit_from_eye ? 1 : 0);
  gl().Uniform3fv(at("tap"), 1, style.tap.data());
  gl().Uniform1f(at("ambient"), style.ambient);
  gl().Uniform1i(at("whole_rays"), style.whole_rays ? 1 : 0);
  gl().Uniform1i(at("jittered"), style.jittered ? 1 : 0);
  gl().Uniform1i(at("at_least_one"), style.at_least_one ? 1 : 0);
  gl().Uniform1i(at("discards"), style.discards ? 1 : 0);
  gl().Uniform4fv(at("shown"), 1, style.shown.data());
  gl().Uniform1f(at("shown_radius"), style.shown_radius);
  gl().Uniform1f(at("ends_at"), style.ends_at);
  gl().Uniform1i(at("way_from_eye"), style.way_from_eye ? 1 : 0);
  gl().Uniform1i(at("noisy"), style.noisy ? 1 : 0);
  gl().Uniform1i(at("reads_depth"), style.reads_depth ? 1 : 0);
  set_cuts(gl(), style, program_);
  if (style.closed_before_eye || closed_before_) {
    const std::vector<GLfloat> triangles =
        style.closed_before_eye ? triangles_behind(camera, 1.1 * style.near) : box_triangles();
    gl().BindBuffer(GL_ARRAY_BUFFER, corners_);
    gl().BufferData(GL_ARRAY_BUFFER, GLsizeiptr(triangles.size() * sizeof(GLfloat)), triangles.data(),
                    GL_STREAM_DRAW);
    corner_count_ = GLsizei(triangles.size() / 3);
    closed_before_ = style.closed_before_eye;
  }
  const GLsizei of_draw = style.face_by_face ? 6 : corner_count_;
  for (GLint first = 0; first < corner_count_; first += of_draw) gl().DrawArrays(GL_TRIANGLES, first, of_draw);
  gl().Disable(GL_BLEND);
  gl().Disable(GL_CULL_FACE);
}

}  // namespace understudy::spu::testing
