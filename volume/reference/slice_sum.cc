// SPDX-License-Identifier: Apache-2.0
#include "volume/reference/slice_sum.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <variant>

#include "volume/matrix.h"
#include "volume/request.h"

namespace understudy::volume {

namespace {

using Sample = std::array<double, 4>;

/// A texture with OpenGL's semantics, one texel at a time.
class Texture {
 public:
  Texture(const VolumeDescription& volume, std::span<const std::byte> texels) : volume_(volume) {
    const int channels = volume.type == TexelType::rgba8 ? 4 : 1;
    const std::size_t count = texels.size() / bytes_per_texel(volume.type);
    texels_.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      const std::byte* texel = texels.data() + i * bytes_per_texel(volume.type);
      switch (volume.type) {
        case TexelType::u8:
        case TexelType::rgba8:
          for (int k = 0; k < channels; ++k) texels_[i][k] = std::to_integer<int>(texel[k]) / 255.0;
          break;
        case TexelType::u16: {
          std::uint16_t v;
          std::memcpy(&v, texel, sizeof v);
          texels_[i][0] = v / 65535.0;
          break;
        }
        case TexelType::f32: {
          float v;
          std::memcpy(&v, texel, sizeof v);
          const double huge = std::ldexp(1.0, 125);
          texels_[i][0] = std::isnan(v) ? v : std::clamp(double(v), -huge, huge);
          break;
        }
      }
    }
    for (int k = 0; k < 4; ++k) {
      const double b = volume.border[k];
      border_[k] = volume.type == TexelType::f32 ? b : std::clamp(b, 0.0, 1.0);
    }
  }

  Sample texel(std::array<int, 3> index) const {
    std::size_t place = 0, stride = 1;
    for (int axis = 0; axis < 3; ++axis) {
      const int size = volume_.size[axis];
      if (index[axis] < 0 || index[axis] >= size) {
        if (volume_.wrap[axis] == Wrap::border) return border_;
        if (volume_.wrap[axis] == Wrap::repeat)
          index[axis] = ((index[axis] % size) + size) % size;
        else
          index[axis] = std::clamp(index[axis], 0, size - 1);
      }
      const int low = volume_.stored.low[axis], high = volume_.stored.high[axis];
      place += std::size_t(std::clamp(index[axis], low, high - 1) - low) * stride;
      stride *= std::size_t(high - low);
    }
    return texels_[place];
  }

  Sample nearest(const Vec3& t) const {
    std::array<int, 3> index;
    for (int axis = 0; axis < 3; ++axis)
      index[axis] = std::clamp(int(std::floor(t[axis] * volume_.size[axis])), 0, volume_.size[axis] - 1);
    return texel(index);
  }

  Sample linear(const Vec3& t) const {
    std::array<int, 3> low;
    Vec3 fraction;
    for (int axis = 0; axis < 3; ++axis) {
      const double u = t[axis] * volume_.size[axis] - 0.5;
      low[axis] = int(std::floor(u));
      fraction[axis] = u - low[axis];
    }
    Sample sum{};
    for (int corner = 0; corner < 8; ++corner) {
      double weight = 1;
      std::array<int, 3> index;
      for (int axis = 0; axis < 3; ++axis) {
        const int step = corner >> axis & 1;
        index[axis] = low[axis] + step;
        weight *= step ? fraction[axis] : 1 - fraction[axis];
      }
      const Sample v = texel(index);
      for (int k = 0; k < 4; ++k) sum[k] += weight * v[k];
    }
    if (touches_nan(low)) sum.fill(std::numeric_limits<double>::quiet_NaN());
    return sum;
  }

  /// One byte per texel: axis by axis, as specified for Filter::linear_8_bit.
  Sample linear_8_bit(const Vec3& t) const {
    std::array<int, 3> low;
    std::array<int, 3> step;
    for (int axis = 0; axis < 3; ++axis) {
      const int place = int(std::lround((t[axis] * volume_.size[axis] - 0.5) * filter_steps));
      low[axis] = int(std::floor(double(place) / filter_steps));
      step[axis] = place - low[axis] * filter_steps;
    }
    const auto byte = [&](int x, int y, int z) {
      return int(std::lround(255 * texel({low[0] + x, low[1] + y, low[2] + z})[0]));
    };
    const auto along_x = [&](int y, int z) { return rounded_mix(byte(0, y, z), byte(1, y, z), step[0]); };
    const auto along_y = [&](int z) { return rounded_mix(along_x(0, z), along_x(1, z), step[1]); };
    return {rounded_mix(along_y(0), along_y(1), step[2]) / 255.0};
  }

 private:
  /// Whether the sample's cell has a NaN corner; samples beyond the outermost texel centres belong to the
  /// outermost cell.
  bool touches_nan(const std::array<int, 3>& low) const {
    for (int corner = 0; corner < 8; ++corner) {
      std::array<int, 3> index;
      for (int axis = 0; axis < 3; ++axis) {
        const int size = volume_.size[axis];
        const bool clamps = volume_.wrap[axis] != Wrap::repeat;
        const int cell = clamps ? std::clamp(low[axis], 0, std::max(size - 2, 0)) : low[axis];
        index[axis] = cell + (corner >> axis & 1);
        if (clamps) index[axis] = std::min(index[axis], size - 1);
      }
      if (std::isnan(texel(index)[0])) return true;
    }
    return false;
  }

  VolumeDescription volume_;
  std::vector<Sample> texels_;
  Sample border_{};
};

/// Computes the fragment of a sample, premultiplied; false when it is discarded.
bool fragment(const Classification& classification, const Sample& sample, Sample& colour) {
  if (const auto* function = std::get_if<TransferFunction>(&classification)) {
    if (std::isnan(sample[0])) return false;
    const double last = double(function->entries.size() - 1);
    const double position =
        std::clamp((sample[0] - function->low) / (double(function->high) - function->low) * last, 0.0, last);
    const auto below = std::size_t(std::floor(position));
    const std::size_t above = std::min(below + 1, function->entries.size() - 1);
    const double s = position - double(below);
    for (int k = 0; k < 4; ++k)
      colour[k] = (1 - s) * double(function->entries[below][k]) + s * double(function->entries[above][k]);
    return true;
  }
  const LinearMap& map = std::get<LinearMap>(classification);
  for (int row = 0; row < 4; ++row) {
    colour[row] = 0;
    for (int k = 0; k < 4; ++k) colour[row] += double(map.matrix[4 * row + k]) * sample[k];
    colour[row] = std::clamp(colour[row], 0.0, 1.0);
  }
  if (colour[3] <= map.alpha_above) return false;
  if (map.multiply_by_alpha)
    for (int k = 0; k < 3; ++k) colour[k] *= colour[3];
  return true;
}

/// Computes the fragment of a slice segment, premultiplied; false when there is none.
bool slice_segment_fragment(const PreIntegrationTable& table, double front, double back, Sample& colour) {
  if (std::isnan(front) || std::isnan(back)) return false;
  const double last = table.edge - 1;
  const auto place = [&](double value) {
    return std::clamp((value - table.low) / (double(table.high) - table.low) * last, 0.0, last);
  };
  const double x = place(front), y = place(back);
  colour = {};
  for (int j = 0; j < table.edge; ++j)
    for (int i = 0; i < table.edge; ++i) {
      // Bilinear weight of the entry.
      const double share = std::max(0.0, 1 - std::abs(x - i)) * std::max(0.0, 1 - std::abs(y - j));
      if (share == 0) continue;
      const Rgba& entry = table.entries[std::size_t(j) * std::size_t(table.edge) + std::size_t(i)];
      for (int k = 0; k < 4; ++k) colour[k] += share * double(entry[k]);
    }
  if (table.multiply_by_alpha)
    for (int k = 0; k < 3; ++k) colour[k] *= colour[3];
  return true;
}

void lay_in_fog(const Fog& fog, const Vec3& t, Sample& colour) {
  const double last = double(fog.entries.size() - 1);
  const double place = std::clamp((dot(fog.normal, t) + fog.offset) * last, 0.0, last);
  const auto below = std::size_t(std::floor(place));
  const std::size_t above = std::min(below + 1, fog.entries.size() - 1);
  const double s = place - double(below);
  const auto entry = [&](std::size_t k) {
    return (1 - s) * double(fog.entries[below][k]) + s * double(fog.entries[above][k]);
  };
  for (std::size_t k = 0; k < 3; ++k) colour[k] = entry(3) * colour[k] + colour[3] * entry(k);
}

/// GL_LESS or GL_LEQUAL against the depth image; pixels without depth pass.
bool nearer(const std::optional<DepthImage>& image, int x, int y, double depth) {
  if (!image) return true;
  const int u = x - image->rect.x, v = y - image->rect.y;
  if (u < 0 || v < 0 || u >= image->rect.width || v >= image->rect.height) return true;
  const double there = image->depth[std::size_t(v) * std::size_t(image->rect.width) + std::size_t(u)];
  return image->or_equal ? depth <= there : depth < there;
}

/// The point at fraction s of the path (in depth) from `near` to `far`, both homogeneous.
Vec3 between(const Vec4& near, const Vec4& far, double s) {
  Vec3 t;
  const double w = near[3] + s * (far[3] - near[3]);
  for (int k = 0; k < 3; ++k) t[k] = (near[k] + s * (far[k] - near[k])) / w;
  return t;
}

bool cut_away(const RenderRequest& request, const Vec3& t) {
  for (const HalfSpace& plane : request.clip_planes)
    if (dot(plane.normal, t) + plane.offset < 0) return true;
  return false;
}

/// Calls `sample_at` with every sample of pixel (x, y) on the request's planes, front to back, and with the
/// second sample of its segment.
template <typename SampleAt>
void meet_planes(const RenderRequest& request, const Vec4& near, const Vec4& far, int x, int y,
                 SampleAt sample_at) {
  for (int i = 0; i < request.planes.count; ++i) {
    // Signed offsets of the pixel's near and far points from the plane: the ray crosses it between them or not
    // at all.
    const double plane = request.planes.first + i * request.planes.spacing;
    const auto offset = [&](const Vec4& p) {
      return dot(request.planes.normal, {p[0], p[1], p[2]}) - plane * p[3];
    };
    const double at_near = offset(near), at_far = offset(far);
    if (at_near == at_far || (at_near > 0) == (at_far > 0)) continue;
    const double s = at_near / (at_near - at_far);
    const Vec3 t = between(near, far, s);
    bool kept = !cut_away(request, t);
    for (int k = 0; k < 3; ++k) kept = kept && t[k] >= request.region.low[k] && t[k] <= request.region.high[k];
    // In clip coordinates both points have w = 1, so depth is linear between them.
    const double depth = request.depth_range[0] + s * (request.depth_range[1] - request.depth_range[0]);
    if (!kept || !nearer(request.depth, x, y, depth)) continue;
    Vec3 behind = t;
    if (request.slice_segment) {
      // The same pixel's point on the plane of the segment's second sample.
      const double further = plane + request.slice_segment->planes * request.planes.spacing;
      const auto to_end = [&](const Vec4& p) {
        return dot(request.planes.normal, {p[0], p[1], p[2]}) - further * p[3];
      };
      behind =
          add(between(near, far, to_end(near) / (to_end(near) - to_end(far))), request.slice_segment->offset);
    }
    sample_at(t, behind);
  }
}

/// The same for samples on steps along the ray.
template <typename SampleAt>
void take_steps(const RenderRequest& request, const Vec4& near, const Vec4& far, int x, int y,
                SampleAt sample_at) {
  const RaySteps& rule = *request.steps;
  const Vec3 start = between(near, far, 0), end = between(near, far, 1);
  // The ray in texture space, extended to both sides as far as the region reaches.
  double enter = -std::numeric_limits<double>::infinity(), leave = -enter;
  for (int k = 0; k < 3; ++k) {
    const double way = end[k] - start[k];
    double a = (request.region.low[k] - start[k]) / way, b = (request.region.high[k] - start[k]) / way;
    if (way == 0) {
      if (start[k] < request.region.low[k] || start[k] > request.region.high[k]) return;
      continue;
    }
    if (a > b) std::swap(a, b);
    enter = std::max(enter, a);
    leave = std::min(leave, b);
  }
  if (!(enter <= leave)) return;
  const auto point = [&](double s) { return add(start, scale(subtract(end, start), s)); };
  const auto steps_between = [&](double a, double b) {
    const Vec3 d = subtract(point(b), point(a));
    Vec3 m;
    for (int r = 0; r < 3; ++r)
      m[r] = rule.metric[3 * r] * d[0] + rule.metric[3 * r + 1] * d[1] + rule.metric[3 * r + 2] * d[2];
    return length(m);
  };
  double steps = steps_between(enter, leave), part = (leave - enter) / steps;
  const double offset = rule.offsets ? rule.offsets->at(x, y) : 0;
  const double first = rule.first + offset;
  const double uncounted = rule.counted_from ? first - *rule.counted_from : 0;
  int count = int(std::floor(steps - (first - uncounted))) + 1;
  if (rule.at_least_one) count = std::max(count, 1);
  if (rule.divided) {
    count = std::max(int(std::floor(steps + rule.rounding)), rule.at_least_one ? 1 : 0);
    if (count < 1) return;
    part = (leave - enter) / count;
  }
  for (int i = 0; i < count; ++i) {
    const double s = enter + (first + i) * part;
    // Depth test against the opaque geometry, which samples may pass by `past_depth` steps, entries not at all.
    const auto visible = [&](double at) {
      if (!request.depth) return true;
      const double n = near[3] * at / (far[3] + at * (near[3] - far[3]));  // from texture space to depth
      return nearer(request.depth, x, y,
                    request.depth_range[0] + n * (request.depth_range[1] - request.depth_range[0]));
    };
    const double depth_s = s - rule.past_depth * part;
    const double counted_s = s - uncounted * part;
    const bool anyway = rule.at_least_one && i == 0 && enter <= 1;
    const bool beyond_end = counted_s > 1 || counted_s > leave;
    if (s < 0 || (beyond_end && !anyway) || cut_away(request, point(s))) continue;
    if ((anyway || visible(depth_s)) && visible(enter)) sample_at(point(s), point(s));
  }
}

}  // namespace

Field texture_field(const VolumeDescription& volume, Filter filter, std::span<const std::byte> texels) {
  const Texture texture(volume, texels);
  if (filter == Filter::nearest) return [texture](const Vec3& t) { return texture.nearest(t); };
  if (filter == Filter::linear_8_bit) return [texture](const Vec3& t) { return texture.linear_8_bit(t); };
  return [texture](const Vec3& t) { return texture.linear(t); };
}

ReferenceImage slice_sum(const Field& field, const RenderRequest& request, const Rect& rect,
                         const Shade& shade) {
  const auto clip_to_texture = inverse(request.texture_to_clip);
  if (!clip_to_texture) throw std::invalid_argument("the matrix from texture to clip space is singular");
  ReferenceImage image{rect, {}};
  const double neutral = request.op == Operator::min ? double(std::numeric_limits<float>::max()) : 0;
  image.rgba.assign(4 * rect.pixels(), neutral);

  const Rect pixels = intersection(rect, intersection(request.window, request.viewport));
  for (int y = pixels.y; y < pixels.y + pixels.height; ++y)
    for (int x = pixels.x; x < pixels.x + pixels.width; ++x) {
      const double X = 2 * (x + 0.5 - request.viewport.x) / request.viewport.width - 1;
      const double Y = 2 * (y + 0.5 - request.viewport.y) / request.viewport.height - 1;
      const Vec4 near = transform(*clip_to_texture, {X, Y, -1, 1}),
                 far = transform(*clip_to_texture, {X, Y, 1, 1});
      double* pixel = image.rgba.data() + (image.at(x, y) - image.rgba.data());
      const auto sample_at = [&](const Vec3& t, const Vec3& behind) {
        Sample colour;
        if (const auto* pairs = std::get_if<PreIntegrationTable>(&request.classification)) {
          if (!slice_segment_fragment(*pairs, field(t)[0], field(behind)[0], colour)) return;
        } else if (!fragment(request.classification, field(t), colour)) {
          return;
        }
        if (shade) colour = shade(t, subtract(between(near, far, 1), between(near, far, 0)), colour);
        if (request.fog) lay_in_fog(*request.fog, t, colour);
        if (request.op == Operator::first_hit) {
          if (pixel[3] > 0 || !(colour[3] > 0)) return;
          constexpr double largest = std::numeric_limits<float>::max();
          for (int k = 0; k < 4; ++k) pixel[k] = std::clamp(colour[k] / colour[3], -largest, largest);
          return;
        }
        if (request.opacity_limit < 1 && pixel[3] >= double(request.opacity_limit)) return;
        const double room = 1 - pixel[3];
        for (int k = 0; k < 4; ++k) switch (request.op) {
            case Operator::over:
              pixel[k] += room * colour[k];
              break;
            case Operator::add:
              pixel[k] += colour[k];
              break;
            case Operator::max:
              pixel[k] = std::max(pixel[k], colour[k]);
              break;
            case Operator::min:
              pixel[k] = std::min(pixel[k], colour[k]);
              break;
            case Operator::first_hit:  // handled above
              break;
          }
      };
      if (request.steps)
        take_steps(request, near, far, x, y, sample_at);
      else
        meet_planes(request, near, far, x, y, sample_at);
    }
  return image;
}

}  // namespace understudy::volume
