// SPDX-License-Identifier: Apache-2.0
// Adaptive steps, part by part, ray by ray: the reference implementation, used where the vector kernel supports
// no instruction set, and by tests to check the vector kernel.
#include <algorithm>
#include <cmath>

#include "volume/raycast/generic_field.h"
#include "volume/raycast/kernel.h"
#include "volume/rgba.h"
#include "volume/texel_type.h"

namespace understudy::volume {

namespace {

template <typename FieldType>
class PartWalk {
 public:
  PartWalk(const Scene& scene, const RayPacket& packet, std::size_t ray)
      : scene_(scene), reader_(scene), begin_(packet.begin[ray]), end_(packet.end[ray]) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      start_[axis] = packet.start[axis][ray];
      step_[axis] = packet.step[axis][ray];
    }
  }

  Rgba walk(int first, int last, KernelCounts& counts) {
    Rgba pixel{};
    int until_test = samples_between_tests;
    for (int k = first; k <= last;) {
      const float u0 = on_ray(k), u1 = on_ray(k + 1);
      move_to(u0);
      if (const float steps = reader_.steps_in_empty(step_); steps >= 0) {
        // Only steps that also end in an empty brick are skipped.
        const int next = int(std::floor(std::min(u0 + steps, float(last) + 1)));
        if (next > k) {
          k = next;
          continue;
        }
      }
      move_to(0.5F * (u1 - u0) + u0);
      const int divisions = divisions_here(), parts = 1 << divisions;
      for (int part = 0; part < parts; ++part) {
        move_to(u0 + (float(part) + 0.5F) / float(parts) * (u1 - u0));
        ++counts.samples_taken;
        compose(divisions, reader_.sample(), u1 - u0, pixel);
      }
      ++k;
      if (--until_test == 0) {
        until_test = samples_between_tests;
        if (1 - pixel[3] < scene_.termination) {
          ++counts.rays_terminated;
          counts.samples_hidden += std::uint64_t(std::max(0, last - k + 1));
          break;
        }
      }
    }
    return pixel;
  }

 private:
  /// Number of halvings of the step in whose middle the reader is.
  int divisions_here() const {
    const auto of_block = int(scene_.division->classes()[reader_.block()]);
    if (of_block == 0) return 0;
    const PartTable& table = *scene_.parts;
    const float value = reader_.sample();
    const float place =
        std::isnan(value) ? 0 : std::clamp((value - table.low()) * table.scale(), 0.0F, table.last());
    const int bin = int(place * (float(StepDivision::bins - 1) / table.last()));
    return int(scene_.division->divisions()[of_block * StepDivision::bins + bin]);
  }

  float on_ray(int k) const { return std::min(std::max(float(k), begin_), end_); }

  void move_to(float u) {
    std::array<float, 3> p;
    for (std::size_t axis = 0; axis < 3; ++axis) p[axis] = u * step_[axis] + start_[axis];
    reader_.move_to(p, scene_.held_low, scene_.held_high);
  }

  /// Composites one part of a step; `length` is the clipped length of that step.
  void compose(int divisions, float value, float length, Rgba& pixel) const {
    if (std::isnan(value)) return;
    const PartTable& table = *scene_.parts;
    const float place = std::clamp((value - table.low()) * table.scale(), 0.0F, table.last());
    const auto entry = std::size_t(place);
    const float* row = table.rows() + 8 * (std::size_t(divisions) * table.entries() + entry);
    Rgba colour;
    for (std::size_t k = 0; k < 4; ++k) colour[k] = row[k] + (place - float(entry)) * row[4 + k];
    resize_layer(std::min(length, 1.0F), colour);
    const float room = 1 - pixel[3];
    for (std::size_t k = 0; k < 4; ++k) pixel[k] += room * colour[k];
  }

  const Scene& scene_;
  FieldReader<FieldType> reader_;
  float begin_, end_;
  std::array<float, 3> start_{}, step_{};
};

template <typename FieldType>
void walk_adaptive_packet(const Scene& scene, const RayPacket& packet, float* rgba, KernelCounts& counts) {
  for (std::size_t ray = 0; ray < packet_rays; ++ray) {
    const Rgba pixel =
        PartWalk<FieldType>(scene, packet, ray).walk(packet.first[ray], packet.last[ray], counts);
    std::copy(pixel.begin(), pixel.end(), rgba + 4 * ray);
  }
}

}  // namespace

void generic_adaptive(const Scene& scene, const RayPacket& packet, float* rgba, KernelCounts& counts) {
  switch (scene.store->description().type) {
    case TexelType::u8:
      return walk_adaptive_packet<StoredTexels<std::uint8_t>>(scene, packet, rgba, counts);
    case TexelType::u16:
      return walk_adaptive_packet<StoredTexels<std::uint16_t>>(scene, packet, rgba, counts);
    case TexelType::f32:
      return walk_adaptive_packet<StoredTexels<float>>(scene, packet, rgba, counts);
    case TexelType::rgba8:  // refused by validate()
      return;
  }
}

}  // namespace understudy::volume
