// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/cuts.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "spu/volume/context/context.h"
#include "volume/matrix.h"

namespace understudy::spu {
namespace {

using volume::HalfSpace;

constexpr const char* cropping_planes = "in_croppingPlanes";
constexpr const char* cropping_flags = "in_croppingFlags";
constexpr const char* clipping_planes = "in_clippingPlanes";
constexpr const char* texture_to_dataset = "in_textureDatasetMatrix[0]";
constexpr const char* dataset_to_texture = "in_inverseTextureDatasetMatrix[0]";
constexpr const char* dataset_to_world = "in_volumeMatrix[0]";

constexpr std::size_t regions = 27;
constexpr std::size_t numbers_of_grid = 6;    ///< low and high of each axis
constexpr std::size_t numbers_per_plane = 6;  ///< a point on it, and its normal
constexpr std::size_t most_clipping_planes = 8;

/// Whether the program has this uniform, of this type: another program's uniform of that name may have another.
bool has(const GlContext& context, GLuint program, const std::string& uniform, GLenum type) {
  constexpr int with_indices = 310;
  if (context.version < with_indices) return false;
  GLuint index = GL_INVALID_INDEX;
  const char* const name = uniform.c_str();
  context.gl->GetUniformIndices(program, 1, &name, &index);
  if (index == GL_INVALID_INDEX) return false;
  GLint found = 0;
  context.gl->GetActiveUniformsiv(program, 1, &index, GL_UNIFORM_TYPE, &found);
  return GLenum(found) == type;
}

bool crops(const GlContext& context, GLuint program) {
  return has(context, program, cropping_planes, GL_FLOAT) && has(context, program, cropping_flags, GL_INT) &&
         has(context, program, dataset_to_texture, GL_FLOAT_MAT4);
}

bool clips(const GlContext& context, GLuint program) {
  return has(context, program, clipping_planes, GL_FLOAT) &&
         has(context, program, texture_to_dataset, GL_FLOAT_MAT4) &&
         has(context, program, dataset_to_world, GL_FLOAT_MAT4);
}

GLint element(const DispatchTable& gl, GLuint program, const char* array, std::size_t index) {
  return gl.GetUniformLocation(program, fmt::format("{}[{}]", array, index).c_str());
}

GLfloat number(const DispatchTable& gl, GLuint program, const char* array, std::size_t index) {
  GLfloat value = 0;
  const GLint location = element(gl, program, array, index);
  if (location >= 0) gl.GetUniformfv(program, location, &value);
  return value;
}

volume::Matrix4 matrix(const DispatchTable& gl, GLuint program, const char* name) {
  const GLint location = gl.GetUniformLocation(program, name);
  std::array<GLfloat, 16> column_major{};
  gl.GetUniformfv(program, location, column_major.data());
  volume::Matrix4 m{};
  for (std::size_t row = 0; row < 4; ++row)
    for (std::size_t column = 0; column < 4; ++column) m[4 * row + column] = column_major[4 * column + row];
  return m;
}

/// Cells of the grid, half-open on each axis.
struct Cells {
  std::array<int, 3> low{0, 0, 0};
  std::array<int, 3> high{3, 3, 3};
};

class Parts {
 public:
  Parts(const std::array<bool, regions>& kept, const std::array<double, 6>& planes,
        const std::array<double, 4>& eye)
      : kept_(kept), planes_(planes), eye_(eye) {}

  /// Appends the kept boxes among `cells`, nearest to the eye first.
  void append(const Cells& cells, std::vector<std::vector<HalfSpace>>& parts) const {
    const auto all = volume_of(cells);
    const auto kept = number_kept(cells);
    if (kept == 0) return;
    if (kept == all) {
      parts.push_back(planes_of(cells));
      return;
    }
    // Choose the cut with the most cells on sides that are kept or cropped as a whole.
    std::size_t best_axis = 0;
    int best_at = 0;
    int best = -1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (int at = cells.low[axis] + 1; at < cells.high[axis]; ++at) {
        int whole = 0;
        for (const Cells& side : sides(cells, axis, at)) {
          const int n = number_kept(side);
          if (n == 0 || n == volume_of(side)) whole += volume_of(side);
        }
        if (whole <= best) continue;
        best = whole;
        best_axis = axis;
        best_at = at;
      }
    }
    const auto [low, high] = sides(cells, best_axis, best_at);
    const double plane = planes_[2 * best_axis + std::size_t(best_at - 1)];
    const bool eye_is_low = eye_[best_axis] < eye_[3] * plane;
    append(eye_is_low ? low : high, parts);
    append(eye_is_low ? high : low, parts);
  }

 private:
  static int volume_of(const Cells& cells) {
    int cells_in = 1;
    for (std::size_t k = 0; k < 3; ++k) cells_in *= cells.high[k] - cells.low[k];
    return cells_in;
  }

  int number_kept(const Cells& cells) const {
    int number = 0;
    for (int z = cells.low[2]; z < cells.high[2]; ++z)
      for (int y = cells.low[1]; y < cells.high[1]; ++y)
        for (int x = cells.low[0]; x < cells.high[0]; ++x)
          number += kept_[std::size_t(x) + 3 * std::size_t(y) + 9 * std::size_t(z)] ? 1 : 0;
    return number;
  }

  static std::array<Cells, 2> sides(const Cells& cells, std::size_t axis, int at) {
    std::array<Cells, 2> two{cells, cells};
    two[0].high[axis] = at;
    two[1].low[axis] = at;
    return two;
  }

  std::vector<HalfSpace> planes_of(const Cells& cells) const {
    std::vector<HalfSpace> planes;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      HalfSpace plane;
      if (cells.low[axis] > 0) {
        plane.normal[axis] = 1;
        plane.offset = -planes_[2 * axis + std::size_t(cells.low[axis] - 1)];
        planes.push_back(plane);
      }
      if (cells.high[axis] < 3) {
        plane.normal[axis] = -1;
        plane.offset = planes_[2 * axis + std::size_t(cells.high[axis] - 1)];
        planes.push_back(plane);
      }
    }
    return planes;
  }

  const std::array<bool, regions>& kept_;
  const std::array<double, 6>& planes_;
  const std::array<double, 4>& eye_;
};

std::vector<std::vector<HalfSpace>> cropping_of(const DispatchTable& gl, GLuint program,
                                                const volume::Matrix4& texture_to_clip) {
  const volume::Matrix4 to_texture = matrix(gl, program, dataset_to_texture);
  std::array<double, numbers_of_grid> planes{};
  for (std::size_t i = 0; i < planes.size(); ++i) {
    volume::Vec3 on_axis{};
    on_axis[i / 2] = double(number(gl, program, cropping_planes, i));
    const volume::Vec4 place = volume::transform_point(to_texture, on_axis);
    planes[i] = place[3] != 0 ? place[i / 2] / place[3] : place[i / 2];
  }
  std::array<bool, regions> kept{};
  for (std::size_t region = 0; region < regions; ++region) {
    GLint flag = 0;
    const GLint location = element(gl, program, cropping_flags, region + 1);
    if (location >= 0) gl.GetUniformiv(program, location, &flag);
    kept[region] = flag != 0;
  }
  // The eye is the point that maps to a multiple of (0, 0, 1, 0), on the side of smaller depth.
  const auto back = volume::inverse(texture_to_clip);
  volume::Vec4 eye = volume::transform(back.value_or(volume::identity()), {0, 0, -1, 0});
  const double rounding = 1e-9 * (std::abs(eye[0]) + std::abs(eye[1]) + std::abs(eye[2]));
  if (eye[3] < -rounding)
    for (double& x : eye) x = -x;
  if (std::abs(eye[3]) <= rounding) eye[3] = 0;
  return kept_parts(kept, planes, eye);
}

std::size_t count_of_clipping_planes(const DispatchTable& gl, GLuint program) {
  const auto numbers = std::size_t(std::max(0.0F, number(gl, program, clipping_planes, 0)));
  return std::min(numbers / numbers_per_plane, most_clipping_planes);
}

/// Returns the index in `uniform` if it is an element of `array`.
std::optional<std::size_t> index_in(std::string_view array, std::string_view uniform) {
  if (!uniform.starts_with(array)) return std::nullopt;
  const std::string_view rest = uniform.substr(array.size());
  std::size_t index = 0;
  if (!rest.starts_with('[') || !rest.ends_with(']')) return std::nullopt;
  const char* const end = rest.data() + rest.size() - 1;
  const auto [read_to, error] = std::from_chars(rest.data() + 1, end, index);
  return error == std::errc() && read_to == end ? std::optional(index) : std::nullopt;
}

std::vector<HalfSpace> clipping_of(const DispatchTable& gl, GLuint program) {
  std::vector<HalfSpace> planes;
  const volume::Matrix4 texture_to_world =
      volume::multiply(matrix(gl, program, dataset_to_world), matrix(gl, program, texture_to_dataset));
  const std::size_t count = count_of_clipping_planes(gl, program);
  for (std::size_t i = 0; i < count; ++i) {
    volume::Vec3 point{};
    volume::Vec3 normal{};
    for (std::size_t k = 0; k < 3; ++k) {
      point[k] = double(number(gl, program, clipping_planes, 1 + numbers_per_plane * i + k));
      normal[k] = double(number(gl, program, clipping_planes, 4 + numbers_per_plane * i + k));
    }
    // A plane is a row vector: it is transformed by the matrix itself, not by its inverse.
    const volume::Vec4 in_world{normal[0], normal[1], normal[2], -volume::dot(normal, point)};
    volume::Vec4 in_texture{};
    for (std::size_t column = 0; column < 4; ++column)
      for (std::size_t row = 0; row < 4; ++row)
        in_texture[column] += in_world[row] * texture_to_world[4 * row + column];
    planes.push_back({{in_texture[0], in_texture[1], in_texture[2]}, in_texture[3]});
  }
  return planes;
}

}  // namespace

std::vector<std::vector<HalfSpace>> kept_parts(const std::array<bool, regions>& kept,
                                               const std::array<double, 6>& planes,
                                               const std::array<double, 4>& eye) {
  std::vector<std::vector<HalfSpace>> parts;
  Parts(kept, planes, eye).append({}, parts);
  // If everything is cropped, one part remains that keeps nothing.
  if (parts.empty()) parts.push_back({{{0, 0, 0}, -1}});
  return parts;
}

Cuts read_cuts(const GlContext& context, GLuint program, const volume::Matrix4& texture_to_clip) {
  Cuts cuts;
  if (crops(context, program)) cuts.parts = cropping_of(*context.gl, program, texture_to_clip);
  if (clips(context, program)) cuts.clipping = clipping_of(*context.gl, program);
  return cuts;
}

CutUniforms::CutUniforms(const GlContext& context, GLuint program) : crops_(crops(context, program)) {
  if (clips(context, program))
    clipping_numbers_ = 1 + numbers_per_plane * count_of_clipping_planes(*context.gl, program);
}

bool CutUniforms::contains(std::string_view uniform) const {
  if (const auto plane = index_in(cropping_planes, uniform)) return crops_ && *plane < numbers_of_grid;
  if (const auto flag = index_in(cropping_flags, uniform)) return crops_ && *flag > 0 && *flag <= regions;
  const auto number = index_in(clipping_planes, uniform);
  return number && *number < clipping_numbers_;
}

LiftedCuts::LiftedCuts(const GlContext& context, GLuint program) : gl_(*context.gl), program_(program) {
  constexpr std::size_t flags = 32;
  if (crops(context, program)) {
    for (std::size_t i = 0; i < flags; ++i) {
      const GLint location = element(gl_, program_, cropping_flags, i);
      if (location < 0) break;
      cropping_flags_.push_back(0);
      gl_.GetUniformiv(program_, location, &cropping_flags_.back());
    }
    const std::vector<GLint> all(cropping_flags_.size(), 1);
    gl_.Uniform1iv(element(gl_, program_, cropping_flags, 0), GLsizei(all.size()), all.data());
  }
  if (!clips(context, program)) return;
  clipping_numbers_ = number(gl_, program_, clipping_planes, 0);
  gl_.Uniform1f(element(gl_, program_, clipping_planes, 0), 0);
}

LiftedCuts::~LiftedCuts() {
  if (!cropping_flags_.empty())
    gl_.Uniform1iv(element(gl_, program_, cropping_flags, 0), GLsizei(cropping_flags_.size()),
                   cropping_flags_.data());
  if (clipping_numbers_) gl_.Uniform1f(element(gl_, program_, clipping_planes, 0), *clipping_numbers_);
}

}  // namespace understudy::spu
