// SPDX-License-Identifier: Apache-2.0
#include "apps/viewer/modes/bricks.h"

#include <algorithm>
#include <cmath>

#include "apps/viewer/modes/compatibility.h"
#include "apps/viewer/modes/table_slices.h"
#include "apps/viewer/modes/volume_texture.h"

namespace viewer {

namespace {

constexpr std::int64_t brick_edge = 64;  ///< maximum edge of a brick's texture, in texels
constexpr double far_away = 1e6;         ///< distance of the assumed eye of an orthographic camera

/// The texels of one brick along one axis, and the part of the volume that it shows: between the texel centres
/// that it shares with its neighbours, or up to the volume's edge.
struct Interval {
  std::int64_t first, texels;
  double low, high;  ///< part of the volume, in [0,1]
};

std::vector<Interval> cut_axis(std::int64_t size) {
  std::vector<Interval> intervals;
  for (std::int64_t first = 0;; first += brick_edge - 1) {
    const bool last = first + brick_edge >= size;
    const std::int64_t texels = last ? size - first : brick_edge;
    const double n = static_cast<double>(size);
    intervals.push_back({first, texels, first == 0 ? 0.0 : (static_cast<double>(first) + 0.5) / n,
                         last ? 1.0 : (static_cast<double>(first + texels) - 0.5) / n});
    if (last) return intervals;
  }
}

struct Brick {
  std::array<Interval, 3> along;
  Texture texture;
};

std::vector<std::byte> texels_of(const Texels& texels, const std::array<Interval, 3>& along) {
  const std::size_t bytes = texels.format == TexelFormat::unorm8    ? 1
                            : texels.format == TexelFormat::unorm16 ? 2
                                                                    : 4;
  const auto row = static_cast<std::size_t>(along[0].texels) * bytes;
  std::vector<std::byte> part;
  for (std::int64_t z = along[2].first; z < along[2].first + along[2].texels; ++z)
    for (std::int64_t y = along[1].first; y < along[1].first + along[1].texels; ++y) {
      const auto at =
          static_cast<std::size_t>((z * texels.size[1] + y) * texels.size[0] + along[0].first) * bytes;
      part.insert(part.end(), texels.data.begin() + static_cast<std::ptrdiff_t>(at),
                  texels.data.begin() + static_cast<std::ptrdiff_t>(at + row));
    }
  return part;
}

/// Returns the part of a convex polygon with sign * (texture[axis] - bound) >= 0.
std::vector<SliceVertex> cut(const std::vector<SliceVertex>& polygon, std::size_t axis, float bound,
                             float sign) {
  std::vector<SliceVertex> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const SliceVertex &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const float da = sign * (a.texture[axis] - bound), db = sign * (b.texture[axis] - bound);
    if (da >= 0) kept.push_back(a);
    if ((da >= 0) == (db >= 0)) continue;
    const float t = da / (da - db);
    SliceVertex between;
    for (std::size_t k = 0; k < 3; ++k) {
      between.texture[k] = a.texture[k] + t * (b.texture[k] - a.texture[k]);
      between.position[k] = a.position[k] + t * (b.position[k] - a.position[k]);
    }
    between.texture[axis] = bound;
    kept.push_back(between);
  }
  return kept;
}

/// Returns the part of all slices that is inside the brick, with the brick's own texture coordinates.
SliceStack part_of(const SliceStack& stack, const std::array<Interval, 3>& along, const VolumeSize& size) {
  SliceStack part;
  for (const Slice& slice : stack.slices) {
    std::vector<SliceVertex> polygon(stack.vertices.begin() + slice.first,
                                     stack.vertices.begin() + slice.first + slice.count);
    for (std::size_t axis = 0; axis < 3 && polygon.size() >= 3; ++axis) {
      polygon = cut(polygon, axis, static_cast<float>(along[axis].low), 1);
      polygon = cut(polygon, axis, static_cast<float>(along[axis].high), -1);
    }
    if (polygon.size() < 3) continue;
    part.slices.push_back({slice.offset, static_cast<std::uint32_t>(part.vertices.size()),
                           static_cast<std::uint32_t>(polygon.size())});
    for (SliceVertex& vertex : polygon) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double texel = static_cast<double>(vertex.texture[axis]) * static_cast<double>(size[axis]);
        vertex.texture[axis] = static_cast<float>((texel - static_cast<double>(along[axis].first)) /
                                                  static_cast<double>(along[axis].texels));
      }
      part.vertices.push_back(vertex);
    }
  }
  return part;
}

/// Returns the eye in object space; for orthographic images, a point far away opposite
/// to the direction of view.
Vec3 eye_of(const Matrices& matrices) {
  const Mat4& m = matrices.modelview;
  const double squared_scale = m[0] * m[0] + m[1] * m[1] + m[2] * m[2];
  const auto from_eye_space = [&](const Vec3& v) {
    Vec3 result{};
    for (std::size_t k = 0; k < 3; ++k)
      result[k] = (m[4 * k] * v[0] + m[4 * k + 1] * v[1] + m[4 * k + 2] * v[2]) / squared_scale;
    return result;
  };
  const bool orthographic = matrices.projection[15] == 1;
  return from_eye_space(orthographic ? Vec3{0, 0, far_away} : Vec3{-m[12], -m[13], -m[14]});
}

class BricksMode : public Mode {
 public:
  BricksMode(const Texels& texels, const std::string& file)
      : format_(luminance_format(texels.format)),
        size_(texels.size),
        box_(box_of(texels.size, texels.spacing)),
        slices_("bricks") {
    for (const Interval& z : cut_axis(size_[2]))
      for (const Interval& y : cut_axis(size_[1]))
        for (const Interval& x : cut_axis(size_[0])) {
          const std::array<Interval, 3> along = {x, y, z};
          const std::vector<std::byte> part = texels_of(texels, along);
          bricks_.push_back(
              {along, make_volume_texture(format_, {x.texels, y.texels, z.texels}, part.data(), file)});
        }
  }

  void set_table(const Table& table) override { upload_table(slices_.table(), table); }

  void draw_opaque(const OpaqueGeometry& geometry, const Matrices& matrices) override {
    draw_opaque_immediate(geometry, matrices);
  }

  void draw_slices(const SliceStack& stack, const Matrices& matrices) override {
    // In a grid, a brick hides only bricks that are no nearer to the eye along any axis, so the sum of these
    // distances gives a visibility order.
    const Vec3 eye = eye_of(matrices);
    const auto distance = [&](const Brick& brick) {
      double sum = 0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double middle = (0.5 * (brick.along[axis].low + brick.along[axis].high) - 0.5) * box_.edges[axis];
        sum += std::abs(middle - eye[axis]);
      }
      return stack.front_to_back ? -sum : sum;
    };
    std::sort(bricks_.begin(), bricks_.end(),
              [&](const Brick& a, const Brick& b) { return distance(a) > distance(b); });
    for (const Brick& brick : bricks_)
      slices_.draw(part_of(stack, brick.along, size_), matrices, brick.texture);
  }

  std::string_view texture_format() const override { return format_.name; }

 private:
  VolumeTextureFormat format_;
  VolumeSize size_;
  Box box_;
  TableSlices slices_;
  std::vector<Brick> bricks_;
};

}  // namespace

std::unique_ptr<Mode> make_bricks_mode(const Texels& texels, const std::string& file) {
  return std::make_unique<BricksMode>(texels, file);
}

}  // namespace viewer
