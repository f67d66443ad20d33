// Sample by sample, ray by ray, in the words of the definition. It runs where the vector kernel knows no
// instruction set, and tests hold the vector kernel against it.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "volume/raycast/kernel.h"
#include "volume/raycast/ray_caster.h"

namespace understudy::volume {

namespace {

/// A sample of the field in units of the texel type: one component, or RGBA.
template <typename Texel>
struct Field {
  using Sample = float;
  static Sample read(const std::byte* block, int index) {
    Texel texel;
    std::memcpy(&texel, block + std::size_t(index) * sizeof texel, sizeof texel);
    return float(texel);
  }
  static Sample border(const Rgba& rgba) { return rgba[0]; }
  static Sample mix(Sample a, Sample b, float s) { return a + s * (b - a); }
};

struct Colours {
  using Sample = Rgba;
  static Sample read(const std::byte* block, int index) {
    std::array<std::uint8_t, 4> texel;
    std::memcpy(texel.data(), block + std::size_t(index) * sizeof texel, sizeof texel);
    return {float(texel[0]), float(texel[1]), float(texel[2]), float(texel[3])};
  }
  static Sample border(const Rgba& rgba) { return rgba; }
  static Sample mix(const Sample& a, const Sample& b, float s) {
    Sample mixed;
    for (std::size_t k = 0; k < 4; ++k) mixed[k] = a[k] + s * (b[k] - a[k]);
    return mixed;
  }
};

/// Colour and opacity of a scalar sample; false when it contributes nothing (NaN).
bool classify(const Scene& scene, float value, Rgba& colour) {
  if (std::isnan(value)) return false;
  const TransferTable& table = *scene.table;
  const float position = std::clamp((value - table.low()) * table.scale(), 0.0F, table.last());
  const auto entry = std::size_t(position);
  const float fraction = position - float(entry);
  const float* row = table.rows() + 8 * entry;
  for (std::size_t k = 0; k < 4; ++k) colour[k] = row[k] + fraction * row[4 + k];
  return true;
}

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

/// Colour and opacity of a slab; false when it contributes nothing (NaN).
bool classify(const PairLookup& pairs, float front, float back, Rgba& colour) {
  if (std::isnan(front) || std::isnan(back)) return false;
  const auto place = [&](float value) {
    return std::clamp((value - pairs.low()) * pairs.scale(), 0.0F, pairs.last());
  };
  const auto entry = [&](float at) { return std::min(std::size_t(at), std::size_t(pairs.edge()) - 2); };
  const float x = place(front), y = place(back);
  const std::size_t i = entry(x), j = entry(y);
  const float* lower = pairs.entries() + 4 * (j * std::size_t(pairs.edge()) + i);
  const float* upper = lower + 4 * std::size_t(pairs.edge());
  for (std::size_t k = 0; k < 4; ++k) {
    const auto along = [&](const float* row) { return row[k] + (x - float(i)) * (row[4 + k] - row[k]); };
    colour[k] = along(lower) + (y - float(j)) * (along(upper) - along(lower));
  }
  if (pairs.multiply_by_alpha())
    for (std::size_t k = 0; k < 3; ++k) colour[k] *= colour[3];
  return true;
}

/// Colours have no table of pairs.
bool classify(const PairLookup&, const Rgba&, const Rgba&, Rgba&) {
  return false;
}

/// What the fog at lattice position p leaves of a colour.
void lay_in_fog(const FogTable& fog, const std::array<float, 3>& p, Rgba& colour) {
  const std::array<float, 3>& gradient = fog.gradient();
  const float free = gradient[0] * p[0] + gradient[1] * p[1] + gradient[2] * p[2] + fog.offset();
  const float place = std::clamp(free, 0.0F, fog.last());
  const auto entry = std::size_t(place);
  const float* row = fog.rows() + 8 * entry;
  const auto at = [&](std::size_t k) { return row[k] + (place - float(entry)) * row[4 + k]; };
  for (std::size_t k = 0; k < 3; ++k) colour[k] = at(3) * colour[k] + colour[3] * at(k);
}

void compose(Operator op, const Rgba& colour, Rgba& pixel) {
  switch (op) {
    case Operator::over: {
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
  }
}

template <typename FieldType>
class RayWalk {
 public:
  RayWalk(const Scene& scene, const RayStrip& strip, std::size_t ray) : scene_(scene) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      start_[axis] = strip.start[axis][ray];
      step_[axis] = strip.step[axis][ray];
    }
  }

  void move_to(int k) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      position_[axis] = float(k) * step_[axis] + start_[axis];
      clamped_[axis] = std::clamp(position_[axis], 0.0F, scene_.top[axis]);
    }
    find_cell();
  }

  /// To the back of the slab whose front lies at sample k.
  void move_behind(int k) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float on_ray = (float(k) + scene_.samples_on) * step_[axis] + start_[axis];
      position_[axis] = on_ray + scene_.cells_away[axis];
      clamped_[axis] = std::clamp(position_[axis], scene_.held_low[axis], scene_.held_high[axis]);
    }
    find_cell();
  }

  const std::array<float, 3>& position() const { return position_; }

  /// How many samples from here on lie in empty blocks for sure; 0 in a block that shows something.
  int empty_ahead() const {
    const int distance = scene_.skip->distances()[block_];
    if (distance == 0) return 0;
    // All blocks fewer than `distance` steps away are empty. Rounding must not carry us past their faces.
    float most = 1e9F;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float low = std::floor(clamped_[axis] / 8) * 8;
      const float room = step_[axis] > 0 ? low + 8 * float(distance) - clamped_[axis]
                                         : clamped_[axis] - low + 8 * float(distance - 1);
      const float speed = std::max(std::abs(step_[axis]), 1e-20F);
      most = std::min(most, (room - scene_.rounding[axis]) / speed * (1 - 1e-6F));
    }
    return int(std::max(most, 0.0F)) + 1;
  }

  typename FieldType::Sample sample() const {
    const std::byte* block = scene_.store->block_data()[block_];
    constexpr int y = BrickStore::block_row, z = BrickStore::block_slice;
    if (scene_.filter == Filter::nearest) {
      const int texel = corner_ + (fraction_[0] >= 0.5F ? 1 : 0) + (fraction_[1] >= 0.5F ? y : 0) +
                        (fraction_[2] >= 0.5F ? z : 0);
      return FieldType::read(block, texel);
    }
    const auto along_x = [&](int i) {
      return FieldType::mix(FieldType::read(block, i), FieldType::read(block, i + 1), fraction_[0]);
    };
    const auto inside = FieldType::mix(
        FieldType::mix(along_x(corner_), along_x(corner_ + y), fraction_[1]),
        FieldType::mix(along_x(corner_ + z), along_x(corner_ + y + z), fraction_[1]), fraction_[2]);
    // Beyond the outermost texel centres the filter mixes in a constant: one axis at a time, so the weights
    // multiply.
    float weight = 1;
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (scene_.has_border[axis]) weight *= std::max(0.0F, 1 - std::abs(position_[axis] - clamped_[axis]));
    return weight == 1 ? inside : FieldType::mix(FieldType::border(scene_.store->border()), inside, weight);
  }

 private:
  /// Where the texels around the clamped position are.
  void find_cell() {
    block_ = 0;
    corner_ = 0;
    std::size_t block_stride = 1;
    int texel_stride = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int cell = int(clamped_[axis]);
      fraction_[axis] = clamped_[axis] - float(cell);
      block_ += std::size_t(cell / BrickStore::block_cells - scene_.store->first_block()[axis]) * block_stride;
      corner_ += cell % BrickStore::block_cells * texel_stride;
      block_stride *= std::size_t(scene_.store->block_counts()[axis]);
      texel_stride *= BrickStore::block_row;
    }
  }

  const Scene& scene_;
  std::array<float, 3> start_, step_, position_, clamped_, fraction_;
  std::size_t block_ = 0;  // among those held
  int corner_ = 0;         // lowest texel of the cell, in the block
};

template <typename FieldType>
void walk_strip(const Scene& scene, const RayStrip& strip, float* rgba, KernelCounts& counts) {
  const float neutral = neutral_value(scene.op);
  for (std::size_t ray = 0; ray < strip_rays; ++ray) {
    Rgba pixel{neutral, neutral, neutral, neutral};
    RayWalk<FieldType> walk(scene, strip, ray);
    const int last = strip.last[ray];
    int until_test = samples_between_tests;
    for (int k = strip.first[ray]; k <= last;) {
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
        if (scene.fog != nullptr) lay_in_fog(*scene.fog, walk.position(), colour);
        compose(scene.op, colour, pixel);
      }
      ++k;
      if (--until_test == 0) {
        until_test = samples_between_tests;
        if (scene.op == Operator::over && 1 - pixel[3] < scene.termination) {
          ++counts.rays_terminated;
          break;
        }
      }
    }
    std::copy(pixel.begin(), pixel.end(), rgba + 4 * ray);
  }
}

}  // namespace

void generic_kernel(const Scene& scene, const RayStrip& strip, float* rgba, KernelCounts& counts) {
  switch (scene.store->description().type) {
    case TexelType::u8:
      return walk_strip<Field<std::uint8_t>>(scene, strip, rgba, counts);
    case TexelType::u16:
      return walk_strip<Field<std::uint16_t>>(scene, strip, rgba, counts);
    case TexelType::f32:
      return walk_strip<Field<float>>(scene, strip, rgba, counts);
    case TexelType::rgba8:
      return walk_strip<Colours>(scene, strip, rgba, counts);
  }
}

}  // namespace understudy::volume
