// SPDX-License-Identifier: Apache-2.0
// Surfaces, light and pre-integration, one segment at a time, ray by ray: the reference implementation, used
// where the vector kernel supports no instruction set, and by tests to check the vector kernel.
#include <algorithm>
#include <array>
#include <cmath>

#include "volume/raycast/generic_field.h"
#include "volume/raycast/kernel.h"
#include "volume/raycast/surface_search.h"
#include "volume/rgba.h"
#include "volume/texel_type.h"

namespace understudy::volume {

namespace {

using Place = std::array<float, 3>;

/// Composites `colour` behind `pixel`, unless the pixel's opacity has reached `limit`.
void compose(const Rgba& colour, Rgba& pixel, float limit = 1) {
  if (limit < 1 && pixel[3] >= limit) return;
  const float room = 1 - pixel[3];
  for (std::size_t k = 0; k < 4; ++k) pixel[k] += room * colour[k];
}

template <typename FieldType>
class SegmentWalk {
 public:
  SegmentWalk(const Scene& scene, const RayPacket& packet, std::size_t ray)
      : scene_(scene),
        segments_(*scene.segments),
        reader_(scene),
        begin_(packet.begin[ray]),
        end_(packet.end[ray]),
        first_(packet.first[ray]),
        last_(packet.last[ray]) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      start_[axis] = packet.start[axis][ray];
      step_[axis] = packet.step[axis][ray];
    }
    if (segments_.prepared_light) {
      light_ = segments_.prepared_light->light(step_);
      half_ = segments_.prepared_light->half(step_);
    }
  }

  Rgba walk(KernelCounts& counts) {
    Rgba pixel{};
    int until_test = samples_between_tests;
    for (int k = first_; k <= last_;) {
      const float u = on_ray(k);
      const float front = value_at(place(u));
      if (const float steps = reader_.steps_in_empty(step_); steps >= 0) {
        // Only segments that also end in an empty brick are skipped.
        const int next = int(std::floor(std::min(u + steps, float(last_) + 1)));
        if (next > k) {
          k = next;
          continue;
        }
      }
      ++counts.samples_taken;
      show(k, front, pixel);
      ++k;
      if (--until_test == 0) {
        until_test = samples_between_tests;
        if (1 - pixel[3] < scene_.termination) {
          ++counts.rays_terminated;
          counts.samples_hidden += std::uint64_t(std::max(0, last_ - k + 1));
          break;
        }
      }
    }
    return pixel;
  }

 private:
  float on_ray(int k) const { return std::min(std::max(float(k), begin_), end_); }

  Place place(float u) const {
    Place p;
    for (std::size_t axis = 0; axis < 3; ++axis) p[axis] = u * step_[axis] + start_[axis];
    return p;
  }

  float value_at(const Place& p) {
    reader_.move_to(p, scene_.held_low, scene_.held_high);
    return reader_.sample();
  }

  /// Composites sample k and segment k.
  void show(int k, float front, Rgba& pixel) {
    const float u0 = on_ray(k), u1 = on_ray(k + 1);
    const Place from = place(u0), to = place(u1);
    Rgba sampled{};
    if (!segments_.pre_integrated && k >= 0 && classify(scene_, front, sampled) && segments_.lit_samples)
      lay_in_light(from, sampled);
    const bool parted = !segments_.levels.empty() || segments_.pre_integrated;
    const float back = parted ? value_at(to) : front;
    if (!parted || std::isnan(front) || std::isnan(back)) return compose(sampled, pixel, scene_.opacity_limit);
    SurfaceSearch search{0, front, back};
    const auto point = [&](float share) {
      Place p;
      for (std::size_t axis = 0; axis < 3; ++axis) p[axis] = from[axis] + share * (to[axis] - from[axis]);
      return p;
    };
    const float cells = std::hypot(to[0] - from[0], to[1] - from[1], to[2] - from[2]);
    float layer = 1;  // remaining length of the sample's layer, in steps
    const auto piece = [&](float begin, float end, float at_begin, float at_end) {
      if (!segments_.pre_integrated || !(end > begin)) return;
      Rgba colour = shown_between(at_begin, at_end, (end - begin) * (u1 - u0));
      if (segments_.lit_samples) lay_in_light(point(0.5F * (begin + end)), colour);
      compose(colour, pixel);
    };
    const std::size_t count = segments_.levels.size();
    for (std::size_t i = 0; i < count; ++i) {
      const Level& level = segments_.levels[front < back ? i : count - 1 - i];
      if ((front >= level.value) == (back >= level.value)) continue;
      const SurfaceSearch before = search;
      if (!search.find(level.value, cells, [&](float share) { return value_at(point(share)); })) continue;
      const float in_front = (search.front - before.front) * (u1 - u0);
      Rgba part = sampled;
      resize_layer(std::min(in_front, 1.0F), part);
      compose(part, pixel);
      layer -= in_front;
      piece(before.front, search.front, before.at_front, level.value);
      Rgba colour = level.colour;
      if (segments_.prepared_light) lay_in_light(point(search.front), colour);
      compose(colour, pixel);
    }
    resize_layer(std::min(layer, 1.0F), sampled);
    compose(sampled, pixel);
    piece(search.front, 1, search.at_front, back);
  }

  /// Colour of `length` steps on which the field varies linearly between two values. Beyond either end of the
  /// table, the entry at that end applies, so the path is split there.
  Rgba shown_between(float front, float back, float length) const {
    const PreIntegrationLookup& pairs = *scene_.pairs;
    const auto place = [&](float value) {
      constexpr float far = 1e18F;  // keeps differences of positions finite
      return std::clamp((value - pairs.low()) * pairs.scale(), -far, far);
    };
    const auto inside = [&](float at) { return std::clamp(at, 0.0F, pairs.last()); };
    const float from = place(front), to = place(back), first = inside(from), last = inside(to);
    float enters = 0, leaves = 1;  // where the path enters and leaves the table, as fractions of its length
    if (first != last) {
      enters = (first - from) / (to - from);
      leaves = (last - from) / (to - from);
    }
    Rgba sum{};
    compose(stretch(first, first, enters * length), sum);
    compose(stretch(first, last, (leaves - enters) * length), sum);
    compose(stretch(last, last, (1 - leaves) * length), sum);
    return sum;
  }

  /// Colour between two positions in the table. A part of a step is more homogeneous than the whole, where the
  /// front attenuates the light of the back: to second order, its colour is a mean of the segment's and of its
  /// mirror image's.
  Rgba stretch(float front, float back, float length) const {
    Rgba colour = interpolated(*scene_.pairs, front, back);
    if (length < 1) {
      const Rgba mirrored = interpolated(*scene_.pairs, back, front);
      for (std::size_t k = 0; k < 3; ++k) colour[k] += 0.5F * (1 - length) * (mirrored[k] - colour[k]);
      resize_layer(length, colour);
    }
    return colour;
  }

  void lay_in_light(const Place& p, Rgba& colour) {
    const PreparedLight& prepared_light = *segments_.prepared_light;
    std::array<double, 3> gradient{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Place beside = p;
      const float reach = prepared_light.reach[axis];
      beside[axis] = p[axis] + reach;
      const double ahead = value_at(beside);
      beside[axis] = p[axis] - reach;
      gradient[axis] = (ahead - value_at(beside)) / (2 * double(reach));
    }
    double square = 0, to_light = 0, to_half = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t k = 0; k < 3; ++k)
        square += gradient[i] * double(prepared_light.metric[3 * i + k]) * gradient[k];
      to_light -= gradient[i] * double(light_[i]);
      to_half -= gradient[i] * double(half_[i]);
    }
    Rgba even = colour;
    for (std::size_t k = 0; k < 3; ++k) even[k] *= prepared_light.model.even[k];
    const double slope = square > 0 ? std::sqrt(square) : 0;
    // Gradient opacity; applied to the colour of a constant field here, and to a lit colour below.
    const auto fade = [&] {
      if (prepared_light.gradient_opacity.factors.empty()) return;
      const auto factor = float(prepared_light.gradient_opacity.at(slope));
      for (float& channel : colour) channel *= factor;
    };
    if (slope == 0) {
      colour = even;
      fade();
      return;
    }
    const double length = prepared_light.guard.length_of_normal(slope);
    const auto cosine = [&](double projection) {
      const double c = projection / slope * length;
      return std::min(prepared_light.model.two_sided ? std::abs(c) : std::max(c, 0.0), 1.0);
    };
    const double share =
        slope < double(prepared_light.full_slope) ? slope / double(prepared_light.full_slope) : 1;
    double diffuse = cosine(to_light);
    double gleam = std::pow(cosine(to_half), double(prepared_light.model.shininess));
    if (!prepared_light.model.response.empty()) {
      const LightResponse response = prepared_light.response_at(float(to_light / slope * length));
      diffuse = double(response.diffuse);
      gleam = double(response.specular);
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const double own = double(colour[k]);
      double lit =
          (double(prepared_light.model.ambient[k]) + double(prepared_light.model.diffuse[k]) * diffuse) * own +
          double(prepared_light.model.specular[k]) * gleam * double(colour[3]);
      if (std::isfinite(prepared_light.model.brightest))
        lit = std::min(lit, double(prepared_light.model.brightest) * double(colour[3]));
      colour[k] = float(double(even[k]) + share * (lit - double(even[k])));
    }
    fade();
  }

  const Scene& scene_;
  const SegmentScene& segments_;
  FieldReader<FieldType> reader_;
  float begin_, end_;
  int first_, last_;
  Place start_{}, step_{}, light_{}, half_{};
};

template <typename FieldType>
void walk_segment_packet(const Scene& scene, const RayPacket& packet, float* rgba, KernelCounts& counts) {
  for (std::size_t ray = 0; ray < packet_rays; ++ray) {
    const Rgba pixel = SegmentWalk<FieldType>(scene, packet, ray).walk(counts);
    std::copy(pixel.begin(), pixel.end(), rgba + 4 * ray);
  }
}

}  // namespace

void generic_segments(const Scene& scene, const RayPacket& packet, float* rgba, KernelCounts& counts) {
  switch (scene.store->description().type) {
    case TexelType::u8:
      return walk_segment_packet<StoredTexels<std::uint8_t>>(scene, packet, rgba, counts);
    case TexelType::u16:
      return walk_segment_packet<StoredTexels<std::uint16_t>>(scene, packet, rgba, counts);
    case TexelType::f32:
      return walk_segment_packet<StoredTexels<float>>(scene, packet, rgba, counts);
    case TexelType::rgba8:  // refused by validate()
      return;
  }
}

}  // namespace understudy::volume
