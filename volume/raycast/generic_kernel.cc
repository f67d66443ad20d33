// SPDX-License-Identifier: Apache-2.0
// Post-classified samples, one by one, ray by ray: the reference implementation, used where the vector kernel
// supports no instruction set, and by tests to check the vector kernel.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>

#include "volume/blending_operator.h"
#include "volume/classification.h"
#include "volume/raycast/generic_field.h"
#include "volume/raycast/kernel.h"
#include "volume/raycast/ray_caster.h"
#include "volume/texel_type.h"

namespace understudy::volume {

namespace {

bool classify(const Scene& scene, const Rgba& texel, Rgba& colour) {
  const LinearMap& map = *scene.map;
  for (std::size_t row = 0; row < 4; ++row) {
    float sum = 0;
    for (std::size_t k = 0; k < 4; ++k) sum += map.matrix[4 * row + k] * (texel[k] / 255.0F);
    colour[row] = std::clamp(sum, 0.0F, 1.0F);
  }
  if (colour[3] <= map.alpha_above) return false;
  if (map.multiply_by_alpha)
    for (std::size_t k = 0; k < 3; ++k) colour[k] *= colour[3];
  return true;
}

/// Volumes of colours have no pre-integration table.
bool classify(const PreIntegrationLookup&, const Rgba&, const Rgba&, Rgba&) {
  return false;
}

/// Applies the fog at lattice position p to a colour.
void lay_in_fog(const FogTable& fog, const std::array<float, 3>& p, Rgba& colour) {
  const std::array<float, 3>& gradient = fog.gradient();
  const float free = gradient[0] * p[0] + gradient[1] * p[1] + gradient[2] * p[2] + fog.offset();
  const float place = std::clamp(free, 0.0F, fog.last());
  const auto entry = std::size_t(place);
  const float* row = fog.rows() + 8 * entry;
  const auto at = [&](std::size_t k) { return row[k] + (place - float(entry)) * row[4 + k]; };
  for (std::size_t k = 0; k < 3; ++k) colour[k] = at(3) * colour[k] + colour[3] * at(k);
}

void compose(const Scene& scene, const Rgba& colour, Rgba& pixel) {
  switch (scene.op) {
    case Operator::over: {
      if (scene.opacity_limit < 1 && pixel[3] >= scene.opacity_limit) break;
      const float room = 1 - pixel[3];
      for (std::size_t k = 0; k < 4; ++k) pixel[k] += room * colour[k];
      break;
    }
    case Operator::add:
      for (std::size_t k = 0; k < 4; ++k) pixel[k] += colour[k];
      break;
    case Operator::max:
      for (std::size_t k = 0; k < 4; ++k) pixel[k] = std::max(pixel[k], colour[k]);
      break;
    case Operator::min:
      for (std::size_t k = 0; k < 4; ++k) pixel[k] = std::min(pixel[k], colour[k]);
      break;
    case Operator::first_hit:
      if (pixel[3] > 0 || !(colour[3] > 0)) break;
      constexpr float largest = std::numeric_limits<float>::max();
      for (std::size_t k = 0; k < 4; ++k) pixel[k] = std::clamp(colour[k] / colour[3], -largest, largest);
      break;
  }
}

template <typename FieldType>
class RayWalk {
 public:
  RayWalk(const Scene& scene, const RayPacket& packet, std::size_t ray) : scene_(scene), reader_(scene) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      start_[axis] = packet.start[axis][ray];
      step_[axis] = packet.step[axis][ray];
    }
  }

  void move_to(int k) {
    std::array<float, 3> position;
    for (std::size_t axis = 0; axis < 3; ++axis) position[axis] = float(k) * step_[axis] + start_[axis];
    reader_.move_to(position, {}, scene_.top);
  }

  /// Moves to the back of the segment whose front lies at sample k.
  void move_behind(int k) {
    std::array<float, 3> position;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float on_ray = (float(k) + scene_.samples_on) * step_[axis] + start_[axis];
      position[axis] = on_ray + scene_.cells_away[axis];
    }
    reader_.move_to(position, scene_.held_low, scene_.held_high);
  }

  const std::array<float, 3>& position() const { return reader_.position(); }

  /// Lower bound of the number of samples from here on in empty bricks; 0 in a block that shows something.
  int empty_ahead() const { return int(std::floor(reader_.steps_in_empty(step_))) + 1; }

  typename FieldType::Sample sample() const { return reader_.sample(); }

 private:
  const Scene& scene_;
  FieldReader<FieldType> reader_;
  std::array<float, 3> start_, step_;
};

template <typename FieldType>
void walk_packet(const Scene& scene, const RayPacket& packet, float* rgba, KernelCounts& counts) {
  const float neutral = neutral_value(scene.op);
  for (std::size_t ray = 0; ray < packet_rays; ++ray) {
    Rgba pixel{neutral, neutral, neutral, neutral};
    RayWalk<FieldType> walk(scene, packet, ray);
    const int last = packet.last[ray];
    int until_test = samples_between_tests;
    for (int k = packet.first[ray]; k <= last;) {
      walk.move_to(k);
      if (const int empty = walk.empty_ahead(); empty > 0) {
        k += empty;
        continue;
      }
      ++counts.samples_taken;
      Rgba colour;
      bool shows = false;
      if (scene.pairs != nullptr) {
        const auto front = walk.sample();
        walk.move_behind(k);
        shows = classify(*scene.pairs, front, walk.sample(), colour);
      } else {
        shows = classify(scene, walk.sample(), colour);
      }
      if (shows) {
        if constexpr (std::is_same_v<typename FieldType::Sample, float>) {
          if (scene.cover_whole_ray && k == last) resize_layer(packet.last_length[ray], colour);
        }
        if (scene.fog != nullptr) lay_in_fog(*scene.fog, walk.position(), colour);
        compose(scene, colour, pixel);
      }
      ++k;
      if (--until_test == 0) {
        until_test = samples_between_tests;
        const bool opaque = scene.op == Operator::over ? 1 - pixel[3] < scene.termination
                                                       : scene.op == Operator::first_hit && pixel[3] > 0;
        if (opaque) {
          ++counts.rays_terminated;
          counts.samples_hidden += std::uint64_t(std::max(0, last - k + 1));
          break;
        }
      }
    }
    std::copy(pixel.begin(), pixel.end(), rgba + 4 * ray);
  }
}

}  // namespace

void generic_kernel(const Scene& scene, const RayPacket& packet, float* rgba, KernelCounts& counts) {
  switch (scene.store->description().type) {
    case TexelType::u8:
      return walk_packet<StoredTexels<std::uint8_t>>(scene, packet, rgba, counts);
    case TexelType::u16:
      return walk_packet<StoredTexels<std::uint16_t>>(scene, packet, rgba, counts);
    case TexelType::f32:
      return walk_packet<StoredTexels<float>>(scene, packet, rgba, counts);
    case TexelType::rgba8:
      return walk_packet<Colours>(scene, packet, rgba, counts);
  }
}

}  // namespace understudy::volume
