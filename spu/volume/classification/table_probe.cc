// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/classification/table_probe.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "spu/volume/context/context.h"
#include "volume/blending_operator.h"

namespace understudy::spu {
namespace {

/// Returns whether `value` lies in the range of channel `c` of `entries`. Between two entries the table may
/// have a peak or a step, which is assumed to exceed them by no more than their difference.
bool is_among(float value, std::span<const volume::Rgba> entries, std::size_t c) {
  float low = entries.front()[c];
  float high = low;
  float apart = 0;
  for (std::size_t i = 1; i < entries.size(); ++i) {
    low = std::min(low, entries[i][c]);
    high = std::max(high, entries[i][c]);
    apart = std::max(apart, std::abs(entries[i][c] - entries[i - 1][c]));
  }
  return value >= low - apart - same_colour && value <= high + apart + same_colour;
}

/// Returns whether colours change in a field with a slope: the application samples more than one position,
/// which constant texels cannot show. The texels increase along all axes, and every sample must have a colour
/// that the table has near its value.
bool sees_neighbours(ProbeBench& bench, const GlContext& context, const TextureDescription& texture,
                     const std::array<float, 2>& range, const InputValues& inputs, const ProbedImage& table,
                     bool stack) {
  constexpr int weight_error = 32;  // in entries: hardware may use 8-bit interpolation weights
  const std::array<double, 3> slope{1.0 / 6, 2.0 / 6, stack ? 0 : 3.0 / 6};
  const double extent = double(range[1]) - range[0];
  std::vector<float> texels;
  for (int i = 0; i < 8; ++i) {
    const double place = (i & 1) * slope[0] + (i >> 1 & 1) * slope[1] + (i >> 2) * slope[2];
    texels.push_back(float(range[0] + place * extent));
  }
  bench.show(probe_format(texture.base), upload_format(texture.base), {2, 2, 2}, texels, GL_LINEAR,
             texture.swizzle, context.version >= 330);
  const ProbedImage image = bench.draw(inputs, true);
  // Between the texels' centres, but not close to them, where the slope bends.
  for (int y = probe_edge / 4 + 2; y < 3 * probe_edge / 4 - 2; ++y) {
    for (int x = probe_edge / 4 + 2; x < 3 * probe_edge / 4 - 2; ++x) {
      const double place = slope[0] * ((x + 0.5) / probe_edge * 2 - 0.5) +
                           slope[1] * ((y + 0.5) / probe_edge * 2 - 0.5) + slope[2] * 0.5;
      const int entry = int(std::lround(place * (probed_entries - 1)));
      const volume::Rgba& colour = image[std::size_t(y) * probe_edge + std::size_t(x)];
      const auto first = std::size_t(std::max(entry - weight_error, 0));
      const auto last = std::size_t(std::min(entry + weight_error, probed_entries - 1));
      const auto around = std::span(table).subspan(first, last - first + 1);
      for (std::size_t c = 0; c < 4; ++c)
        if (!is_among(colour[c], around, c)) return true;
    }
  }
  return false;
}

constexpr const char* colours_not_finite = "the fragment stage gives colours that are not finite";

/// Probes the values of a table, with other inputs than those of the run's first vertex.
class TableProbe {
 public:
  TableProbe(ProbeBench& bench, const GlContext& context, const TextureDescription& texture,
             const FragmentInputs& fragment, const std::array<float, 2>& range)
      : bench_(bench),
        context_(context),
        texture_(texture),
        fragment_(fragment),
        range_(range),
        ramp_(probe_pixels) {
    for (int i = 0; i < probe_pixels; ++i) {
      const double place = double(std::min(i, probed_entries - 1)) / (probed_entries - 1);
      ramp_[std::size_t(i)] = float(range[0] + place * (double(range[1]) - range[0]));
    }
  }

  /// All entries of the table, with `inputs`.
  ProbedImage table(const InputValues& inputs) {
    show(probe_edge, ramp_);
    return bench_.draw(without_coordinate(fragment_, inputs), true);
  }
  /// Replaces the entries at multiples of 1/255 by those of 8-bit texels: what a driver makes of a byte may
  /// differ from n/255 in the last bit, which matters to a program that compares samples with such a number.
  void take_bytes(ProbedImage& table, const InputValues& inputs) {
    constexpr int bytes = 256;
    constexpr std::size_t entries_a_byte = (probed_entries - 1) / (bytes - 1);
    std::vector<float> texels(probe_pixels);
    for (int i = 0; i < probe_pixels; ++i) texels[std::size_t(i)] = float(std::min(i, bytes - 1)) / (bytes - 1);
    show(byte_probe_format(texture_.base), probe_edge, texels);
    const ProbedImage seen = bench_.draw(without_coordinate(fragment_, inputs), true);
    for (std::size_t i = 0; i < bytes; ++i) table[entries_a_byte * i] = seen[i];
  }
  /// A table of more entries than an image has pixels.
  ProbedImage table_of(int entries, const InputValues& inputs) {
    const GLenum format = texture_.type == volume::TexelType::u16 ? word_probe_format(texture_.base)
                                                                  : probe_format(texture_.base);
    ProbedImage table;
    table.reserve(std::size_t(entries));
    std::vector<float> texels(probe_pixels);
    for (int first = 0; first < entries; first += probe_pixels) {
      for (int i = 0; i < probe_pixels; ++i) {
        const double place = double(std::min(first + i, entries - 1)) / (entries - 1);
        texels[std::size_t(i)] = float(range_[0] + place * (double(range_[1]) - range_[0]));
      }
      show(format, probe_edge, texels);
      const ProbedImage seen = bench_.draw(without_coordinate(fragment_, inputs), true);
      table.insert(table.end(), seen.begin(), seen.begin() + std::min(probe_pixels, entries - first));
    }
    return table;
  }
  /// One entry, at coordinates all over the volume.
  ProbedImage everywhere(std::size_t entry, const InputValues& inputs) {
    show(1, {ramp_[entry]});
    return bench_.draw(without_coordinate(fragment_, inputs), true);
  }
  /// One entry, while the scalar `number` runs from `low` in the first pixel to `high` in the last.
  ProbedImage along(std::size_t entry, const InputNumber& number, float low, float high) {
    show(1, {ramp_[entry]});
    return bench_.draw_along(fragment_, number, low, high, true);
  }
  InputValues first_but(const InputNumber& number, float value) const {
    return with_number(fragment_.first, number, value);
  }

 private:
  void show(int extent, const std::vector<float>& texels) { show(probe_format(texture_.base), extent, texels); }
  void show(GLenum format, int extent, const std::vector<float>& texels) {
    bench_.show(format, upload_format(texture_.base), extent, extent, texels, texture_.swizzle,
                context_.version >= 330);
  }

  ProbeBench& bench_;
  const GlContext& context_;
  const TextureDescription& texture_;
  const FragmentInputs& fragment_;
  std::array<float, 2> range_;
  std::vector<float> ramp_;
};

/// Returns the fog by `number`, the only scalar that colours depend on; null if it is no fog. Sets `table` to
/// the colours where the fog is thinnest.
std::optional<MeasuredFog> probe_fog(TableProbe& probe, const InputNumber& number, const InputRange& needed,
                                     const InputRange& range, bool premultiplied, ProbedImage& table) {
  const float low = range.low[number.input][number.component];
  const float high = range.high[number.input][number.component];
  std::vector<float> values(probe_pixels);
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = low + (high - low) * float(i) / float(probe_pixels - 1);
  const auto bound = [&](const InputValues& end) { return end[number.input][number.component]; };
  auto fog = measure_fog(table, premultiplied, values, {bound(needed.low), bound(needed.high)},
                         [&](std::size_t entry) { return probe.along(entry, number, low, high); });
  if (!fog) return std::nullopt;
  fog->input = number.input;
  fog->component = number.component;
  table = probe.table(probe.first_but(number, fog->reference));
  // The fog was measured with a few samples, and must hold for all.
  for (const std::size_t k : {std::size_t(0), fog->entries.size() / 2, fog->entries.size() - 1}) {
    const volume::Rgba& entry = fog->entries[k];
    const float value = fog->low + (fog->high - fog->low) * float(k) / float(fog->entries.size() - 1);
    const ProbedImage seen = probe.table(probe.first_but(number, value));
    for (std::size_t i = 0; i < seen.size(); ++i) {
      if (!(std::abs(seen[i][3] - table[i][3]) <= same_colour)) return std::nullopt;
      for (std::size_t c = 0; seen[i][3] > 0 && c < 3; ++c) {
        const float added = premultiplied ? seen[i][3] * entry[c] : entry[c];
        const float expected = entry[3] * std::clamp(table[i][c], 0.0F, 1.0F) + added;
        if (!(std::abs(expected - std::clamp(seen[i][c], 0.0F, 1.0F)) <= same_fogged_colour))
          return std::nullopt;
      }
    }
  }
  return fog;
}

/// Returns the varying scalars that the table depends on as they run over `range`.
std::vector<InputNumber> telling_numbers(TableProbe& probe, const ProbedImage& table,
                                         const FragmentInputs& fragment, const InputRange& range) {
  std::vector<InputNumber> telling;
  for (const InputNumber& number : varying_numbers(fragment)) {
    for (const InputValues* end : {&range.low, &range.high}) {
      const float value = (*end)[number.input][number.component];
      if (largest_difference(probe.table(probe.first_but(number, value)), table) <= same_colour) continue;
      telling.push_back(number);
      break;
    }
  }
  return telling;
}

/// Explains the inputs that vary over the run: colours do not depend on them, or only by fog; `table` then
/// becomes the colours where it is thinnest. Null if colours depend on more.
std::optional<Probed> explained_inputs(TableProbe& probe, const FragmentInputs& fragment, bool premultiplied,
                                       ProbedImage& table) {
  for (const InputRange& tried : {widened(fragment.range, varying_numbers(fragment)), fragment.range}) {
    Probed probed;
    probed.range = tried;
    const std::vector<InputNumber> telling = telling_numbers(probe, table, fragment, tried);
    if (telling.empty()) return probed;
    if (telling.size() > 1 || fragment.inputs[telling.front().input].integer) continue;
    probed.fog = probe_fog(probe, telling.front(), fragment.range, tried, premultiplied, table);
    if (!probed.fog) continue;
    probed.range.low[probed.fog->input][probed.fog->component] = probed.fog->low;
    probed.range.high[probed.fog->input][probed.fog->component] = probed.fog->high;
    return probed;
  }
  return std::nullopt;
}

/// Returns `inputs` with the scalar of the fog, if there is fog, at the value where the table was drawn.
InputValues at_reference(InputValues inputs, const std::optional<MeasuredFog>& fog) {
  if (fog) inputs[fog->input][fog->component] = fog->reference;
  return inputs;
}

/// Returns whether samples have the colours of `table` with these inputs and at other coordinates, probed with
/// a single texel that covers the whole image.
bool same_everywhere(TableProbe& probe, const ProbedImage& table, const InputValues& inputs) {
  for (const int entry :
       {0, probed_entries / 5, probed_entries / 2, 4 * probed_entries / 5, probed_entries - 1}) {
    for (const volume::Rgba& colour : probe.everywhere(std::size_t(entry), inputs)) {
      if (!(largest_difference(colour, table[std::size_t(entry)]) <= same_colour)) return false;
    }
  }
  return true;
}

/// The table as the nodes use it: premultiplied. Null if its colours cannot be composed.
std::optional<volume::TransferFunction> composable(std::span<const volume::Rgba> table,
                                                   const Pipeline& pipeline,
                                                   const std::array<float, 2>& range) {
  volume::TransferFunction function;
  function.low = range[0];
  function.high = range[1];
  function.entries.assign(table.begin(), table.end());
  for (volume::Rgba& entry : function.entries) {
    if (!clamp_as_stored(entry, pipeline.target.floating)) return std::nullopt;
    if (pipeline.blending.premultiplied) continue;
    for (std::size_t c = 0; c < 3; ++c) entry[c] *= entry[3];
  }
  return function;
}

}  // namespace

ProbeFinding probe_table(ProbeBench& bench, const GlContext& context, const Pipeline& pipeline,
                         const TextureDescription& texture, const FragmentInputs& fragment,
                         const std::array<float, 2>& range) {
  TableProbe probe(bench, context, texture, fragment, range);
  ProbedImage table = probe.table(fragment.first);
  if (!bench.drew_any()) return no_fragment_drawn;
  if (!finite(table)) return colours_not_finite;

  // A discarded fragment is transparent to every operator but the minimum, for which zero is a value.
  if (pipeline.blending.op == volume::Operator::min || pipeline.blending.alpha.op == volume::Operator::min) {
    if (bench.draw(without_coordinate(fragment, fragment.first), true, {1, 1, 1, 1}) != table)
      return "fragments are discarded under a minimum";
  }
  auto probed = explained_inputs(probe, fragment, pipeline.blending.premultiplied, table);
  if (!probed || !same_everywhere(probe, table, at_reference(fragment.last, probed->fog)))
    return more_than_the_sample;

  const InputValues tabled = at_reference(fragment.first, probed->fog);
  // The fixed function of a stack's slices samples one position only.
  const bool one_place = pipeline.stack && pipeline.program == 0;
  if (!one_place && sees_neighbours(bench, context, texture, range, without_coordinate(fragment, tabled), table,
                                    pipeline.stack))
    return "the colour depends on the field around the sample (gradient, lighting)";
  if (texture.type == volume::TexelType::u8) probe.take_bytes(table, tabled);
  const int entries = table_entries(texture, range);
  if (entries > probed_entries) table = probe.table_of(entries, tabled);
  if (!finite(table)) return colours_not_finite;
  auto function = composable(std::span(table).first(std::size_t(entries)), pipeline, range);
  if (!function) return "the colours leave [0,1] in a float framebuffer";
  probed->classification = *std::move(function);
  return *std::move(probed);
}

}  // namespace understudy::spu
