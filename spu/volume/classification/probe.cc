#include "spu/volume/classification/probe.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>

#include "spu/volume/classification/pre_integration.h"
#include "spu/volume/context/saved_state.h"
#include "volume/blending_operator.h"

namespace understudy::spu {
namespace {

/// Both the probe's image and its texture are squares of this edge: one texel a pixel.
constexpr int edge = 64;
constexpr int pixels = edge * edge;
static_assert(probed_entries <= pixels);
/// Two probes of one sample agree to this; interpolation of our own inputs is exact, so only rounding remains.
constexpr float same_colour = 2e-4F;
/// Fog is interpolated between values of its number.
constexpr float same_fogged_colour = 4e-3F;

using RenderedImage = std::vector<volume::Rgba>;

/// The framebuffer, textures and vertex array of one probing; all gone afterwards.
class Bench {
 public:
  Bench(const GlContext& context, const Pipeline& pipeline)
      : gl_(*context.gl),
        target_(pipeline.volume.target),
        alpha_test_(!context.core && gl_.IsEnabled(GL_ALPHA_TEST)),
        saved_(context) {
    saved_.borrow_texture(target_, pipeline.volume.unit);
    gl_.GenTextures(1, &texture_);
    gl_.GenRenderbuffers(1, &colour_);
    gl_.GenFramebuffers(1, &framebuffer_);
    gl_.GenVertexArrays(1, &vertex_array_);
    GLint application_renderbuffer = 0;
    gl_.GetIntegerv(GL_RENDERBUFFER_BINDING, &application_renderbuffer);
    gl_.BindRenderbuffer(GL_RENDERBUFFER, colour_);
    gl_.RenderbufferStorage(GL_RENDERBUFFER, GL_RGBA32F, edge, edge);
    gl_.BindRenderbuffer(GL_RENDERBUFFER, GLuint(application_renderbuffer));
    gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    gl_.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colour_);
    gl_.BindVertexArray(vertex_array_);
    gl_.Viewport(0, 0, edge, edge);
  }
  ~Bench() {
    if (program_ != 0) gl_.DeleteProgram(program_);
    gl_.DeleteVertexArrays(1, &vertex_array_);
    gl_.DeleteFramebuffers(1, &framebuffer_);
    gl_.DeleteRenderbuffers(1, &colour_);
    gl_.DeleteTextures(1, &texture_);
  }
  Bench(const Bench&) = delete;
  Bench& operator=(const Bench&) = delete;

  bool complete() const { return gl_.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE; }
  void own(GLuint program) { program_ = program; }
  GLuint program() const { return program_; }

  /// Texels of the probe volume: width x height x 1, `components` floats each.
  void show(GLenum internal_format, GLenum format, int width, int height, const std::vector<float>& texels,
            const std::array<GLint, 4>& swizzle, bool with_swizzle) {
    show(internal_format, format, {width, height, 1}, texels, GL_NEAREST, swizzle, with_swizzle);
  }
  void show(GLenum internal_format, GLenum format, const std::array<int, 3>& size,
            const std::vector<float>& texels, GLenum filter, const std::array<GLint, 4>& swizzle,
            bool with_swizzle) {
    gl_.BindTexture(target_, texture_);
    gl_.TexParameteri(target_, GL_TEXTURE_MIN_FILTER, GLint(filter));
    gl_.TexParameteri(target_, GL_TEXTURE_MAG_FILTER, GLint(filter));
    for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R}) {
      gl_.TexParameteri(target_, axis, GL_CLAMP_TO_EDGE);
    }
    if (with_swizzle) gl_.TexParameteriv(target_, GL_TEXTURE_SWIZZLE_RGBA, swizzle.data());
    if (target_ == GL_TEXTURE_2D) {
      gl_.TexImage2D(target_, 0, GLint(internal_format), size[0], size[1], 0, format, GL_FLOAT, texels.data());
    } else {
      gl_.TexImage3D(target_, 0, GLint(internal_format), size[0], size[1], size[2], 0, format, GL_FLOAT,
                     texels.data());
    }
  }

  /// One fragment a pixel; a pixel whose fragment was discarded keeps `background`. `across` and `up`: by how
  /// much inputs grow over the image's edges; empty where they are constant.
  RenderedImage draw(const InputValues& values, bool with_alpha_test, const volume::Rgba& background = {},
                     const InputValues& across = {}, const InputValues& up = {}) {
    gl_.ClearBufferfv(GL_COLOR, 0, background.data());
    if (with_alpha_test && alpha_test_) gl_.Enable(GL_ALPHA_TEST);
    gl_.UseProgram(program_);
    const InputValues level(values.size());
    give("understudy_value", values);
    give("understudy_across", across.empty() ? level : across);
    give("understudy_up", up.empty() ? level : up);
    gl_.DrawArrays(GL_TRIANGLES, 0, 3);
    if (alpha_test_) gl_.Disable(GL_ALPHA_TEST);
    RenderedImage image(pixels);
    gl_.ReadPixels(0, 0, edge, edge, GL_RGBA, GL_FLOAT, image.data());
    return image;
  }

  bool alpha_test_enabled() const { return alpha_test_; }

 private:
  void give(const char* name, const InputValues& values) {
    const GLint location = gl_.GetUniformLocation(program_, name);
    if (location >= 0 && !values.empty())
      gl_.Uniform4fv(location, GLsizei(values.size()), values.front().data());
  }

  const DispatchTable& gl_;
  GLenum target_;
  bool alpha_test_;  ///< asked before SavedState switches it off
  SavedState saved_;
  GLuint texture_ = 0;
  GLuint colour_ = 0;
  GLuint framebuffer_ = 0;
  GLuint vertex_array_ = 0;
  GLuint program_ = 0;
};

/// The values of all inputs but the coordinate, in the order in which the probe program numbers them.
InputValues without_coordinate(const FragmentInputs& fragment, const InputValues& values) {
  InputValues others;
  for (std::size_t i = 0; i < fragment.inputs.size(); ++i) {
    if (fragment.inputs[i].name != fragment.coordinate) others.push_back(values[i]);
  }
  return others;
}

float largest_difference(const volume::Rgba& a, const volume::Rgba& b) {
  float largest = 0;
  for (std::size_t c = 0; c < 4; ++c) largest = std::max(largest, std::abs(a[c] - b[c]));
  return largest;
}

bool finite(const RenderedImage& image) {
  return std::all_of(image.begin(), image.end(), [](const volume::Rgba& p) {
    return std::all_of(p.begin(), p.end(), [](float x) { return std::isfinite(x); });
  });
}

/// Whether colours change where the field has a slope: the application looks at more than one place, which flat
/// texels cannot show. The texels rise along all axes, and every sample must get a colour that the table has
/// for about its value.
bool sees_neighbours(Bench& bench, const GlContext& context, const TextureDescription& texture,
                     const std::array<float, 2>& range, const InputValues& inputs, const RenderedImage& table,
                     bool stack) {
  constexpr int weight_error = 32;  // entries: hardware may weight texels by 8 bits
  const std::array<double, 3> slope{1.0 / 6, 2.0 / 6, stack ? 0 : 3.0 / 6};
  const double extent = double(range[1]) - range[0];
  std::vector<float> texels;
  for (int i = 0; i < 8; ++i) {
    const double place = (i & 1) * slope[0] + (i >> 1 & 1) * slope[1] + (i >> 2) * slope[2];
    texels.push_back(float(range[0] + place * extent));
  }
  bench.show(probe_format(texture.base), upload_format(texture.base), {2, 2, 2}, texels, GL_LINEAR,
             texture.swizzle, context.version >= 330);
  const RenderedImage image = bench.draw(inputs, true);
  // Between the texels' centres, and away from them: the slope has a bend there.
  for (int y = edge / 4 + 2; y < 3 * edge / 4 - 2; ++y) {
    for (int x = edge / 4 + 2; x < 3 * edge / 4 - 2; ++x) {
      const double place =
          slope[0] * ((x + 0.5) / edge * 2 - 0.5) + slope[1] * ((y + 0.5) / edge * 2 - 0.5) + slope[2] * 0.5;
      const int entry = int(std::lround(place * (probed_entries - 1)));
      const volume::Rgba& colour = image[std::size_t(y) * edge + std::size_t(x)];
      for (std::size_t c = 0; c < 4; ++c) {
        float low = std::numeric_limits<float>::max();
        float high = std::numeric_limits<float>::lowest();
        for (int i = std::max(entry - weight_error, 0); i <= std::min(entry + weight_error, probed_entries - 1);
             ++i) {
          low = std::min(low, table[std::size_t(i)][c]);
          high = std::max(high, table[std::size_t(i)][c]);
        }
        if (!(colour[c] >= low - same_colour && colour[c] <= high + same_colour)) return true;
      }
    }
  }
  return false;
}

/// Whether texels in [0,1] may give colours outside of it.
bool leaves_unit_interval(const std::array<float, 16>& matrix) {
  for (std::size_t row = 0; row < 4; ++row) {
    float low = 0;
    float high = 0;
    for (std::size_t column = 0; column < 4; ++column) {
      low += std::min(matrix[4 * row + column], 0.0F);
      high += std::max(matrix[4 * row + column], 0.0F);
    }
    if (low < -same_colour || high > 1 + same_colour) return true;
  }
  return false;
}

/// One component of one input.
struct Number {
  std::size_t input = 0;  ///< in the order of FragmentInputs::inputs
  std::size_t component = 0;
};

/// The numbers that vary over the run, the coordinate left out.
std::vector<Number> varying_numbers(const FragmentInputs& fragment) {
  std::vector<Number> numbers;
  for (std::size_t i = 0; i < fragment.inputs.size(); ++i) {
    if (fragment.inputs[i].name == fragment.coordinate) continue;
    for (std::size_t c = 0; c < 4; ++c) {
      if (!(fragment.range.low[i][c] == fragment.range.high[i][c])) numbers.push_back({i, c});
    }
  }
  return numbers;
}

/// The range, and as much again on both sides where it is one: a view that turns does not ask for another
/// probe.
InputRange widened(InputRange range, const std::vector<Number>& numbers) {
  for (const Number& number : numbers) {
    float& low = range.low[number.input][number.component];
    float& high = range.high[number.input][number.component];
    const float extent = high - low;
    low -= extent;
    high += extent;
  }
  return range;
}

float largest_difference(const RenderedImage& a, const RenderedImage& b) {
  float largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const float difference = largest_difference(a[i], b[i]);
    if (!(difference <= largest)) largest = difference;
  }
  return largest;
}

/// Shows the probe program a table's samples under other inputs than the run's first vertex has.
class TableProbe {
 public:
  TableProbe(Bench& bench, const GlContext& context, const TextureDescription& texture,
             const FragmentInputs& fragment, const std::array<float, 2>& range)
      : bench_(bench), context_(context), texture_(texture), fragment_(fragment), ramp_(pixels) {
    for (int i = 0; i < pixels; ++i) {
      const double place = double(std::min(i, probed_entries - 1)) / (probed_entries - 1);
      ramp_[std::size_t(i)] = float(range[0] + place * (double(range[1]) - range[0]));
    }
  }

  /// All entries of the table, with the inputs given.
  RenderedImage table(const InputValues& inputs) {
    show(edge, ramp_);
    return bench_.draw(without_coordinate(fragment_, inputs), true);
  }
  /// One entry, at coordinates all over the volume.
  RenderedImage everywhere(std::size_t entry, const InputValues& inputs) {
    show(1, {ramp_[entry]});
    return bench_.draw(without_coordinate(fragment_, inputs), true);
  }
  /// One entry, while one number runs from `low` in the first pixel to `high` in the last.
  RenderedImage along(std::size_t entry, const Number& number, float low, float high) {
    show(1, {ramp_[entry]});
    const float step = (high - low) / float(pixels - 1);
    InputValues values = fragment_.first;
    InputValues across(values.size());
    InputValues up(values.size());
    values[number.input][number.component] = low - step * 0.5F * float(edge + 1);
    across[number.input][number.component] = step * float(edge);
    up[number.input][number.component] = step * float(edge * edge);
    return bench_.draw(without_coordinate(fragment_, values), true, {}, without_coordinate(fragment_, across),
                       without_coordinate(fragment_, up));
  }
  InputValues first_but(const Number& number, float value) const {
    InputValues values = fragment_.first;
    values[number.input][number.component] = value;
    return values;
  }

 private:
  void show(int extent, const std::vector<float>& texels) {
    bench_.show(probe_format(texture_.base), upload_format(texture_.base), extent, extent, texels,
                texture_.swizzle, context_.version >= 330);
  }

  Bench& bench_;
  const GlContext& context_;
  const TextureDescription& texture_;
  const FragmentInputs& fragment_;
  std::vector<float> ramp_;
};

/// The fog in the one number that colours depend on; null when there is no such thing. Leaves in `table` the
/// colours where the fog is thinnest.
std::optional<MeasuredFog> probe_fog(TableProbe& probe, const Number& number, const InputRange& needed,
                                     const InputRange& range, bool premultiplied, RenderedImage& table) {
  const float low = range.low[number.input][number.component];
  const float high = range.high[number.input][number.component];
  std::vector<float> values(pixels);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = low + (high - low) * float(i) / float(pixels - 1);
  const auto bound = [&](const InputValues& end) { return end[number.input][number.component]; };
  auto fog = measure_fog(table, premultiplied, values, {bound(needed.low), bound(needed.high)},
                         [&](std::size_t entry) { return probe.along(entry, number, low, high); });
  if (!fog) return std::nullopt;
  fog->input = number.input;
  fog->component = number.component;
  table = probe.table(probe.first_but(number, fog->reference));
  // It was found with a few samples, and must hold for all.
  for (const std::size_t k : {std::size_t(0), fog->entries.size() / 2, fog->entries.size() - 1}) {
    const volume::Rgba& entry = fog->entries[k];
    const float value = fog->low + (fog->high - fog->low) * float(k) / float(fog->entries.size() - 1);
    const RenderedImage seen = probe.table(probe.first_but(number, value));
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

/// Shows the probe program segments whose ends are known: the coordinate runs through the middle layer of
/// three, and the input that may address the volume a second time through the lowest.
class SegmentProbe {
 public:
  SegmentProbe(Bench& bench, const GlContext& context, const TextureDescription& texture,
               const FragmentInputs& fragment, std::size_t end)
      : bench_(bench), context_(context), texture_(texture), fragment_(fragment), end_(end) {}

  RenderedImage pairs(const SegmentValues& front, const SegmentValues& back, const InputValues& inputs) {
    std::vector<float> texels(back.begin(), back.end());
    texels.insert(texels.end(), front.begin(), front.end());
    texels.insert(texels.end(), front.begin(), front.end());
    show({edge, 1, 3}, texels, GL_NEAREST);
    return draw(inputs, {0, 0.5F, in_lowest_layer, 1}, {}, {1, 0, 0, 0});
  }
  /// One pair, at coordinates all over the volume.
  RenderedImage everywhere(float front, float back, const InputValues& inputs) {
    show({1, 1, 3}, {back, front, front}, GL_NEAREST);
    return draw(inputs, {0, 0, in_lowest_layer, 1}, {0.7F, 0.2F, 0, 0}, {0.1F, 0.8F, 0, 0});
  }
  /// Texels that rise along all axes; the second sample lies `off` the first.
  RenderedImage slope(const std::vector<float>& texels, const std::array<float, 3>& off) {
    show({2, 2, 2}, texels, GL_LINEAR);
    return draw(fragment_.first, {off[0], off[1], 0.5F + off[2], 1}, {1, 0, 0, 0}, {0, 1, 0, 0});
  }

 private:
  static constexpr float in_lowest_layer = 1.0F / 6;

  void show(const std::array<int, 3>& size, const std::vector<float>& texels, GLenum filter) {
    bench_.show(probe_format(texture_.base), upload_format(texture_.base), size, texels, filter,
                texture_.swizzle, context_.version >= 330);
  }
  RenderedImage draw(InputValues inputs, const std::array<float, 4>& end,
                     const std::array<float, 4>& end_across, const std::array<float, 4>& end_up) {
    InputValues across(inputs.size());
    InputValues up(inputs.size());
    inputs[end_] = end;
    across[end_] = end_across;
    up[end_] = end_up;
    return bench_.draw(without_coordinate(fragment_, inputs), true, {}, without_coordinate(fragment_, across),
                       without_coordinate(fragment_, up));
  }

  Bench& bench_;
  const GlContext& context_;
  const TextureDescription& texture_;
  const FragmentInputs& fragment_;
  std::size_t end_;
};

/// Whether colours between the ends of segments are those of the table where the field has a slope.
bool slice_segments_see_neighbours(SegmentProbe& probe, const volume::PreIntegrationTable& table) {
  constexpr double weight_error = 4.0 / 510;  // hardware may weight texels by 8 bits
  constexpr std::array<double, 3> slope{1.0 / 6, 2.0 / 6, 3.0 / 6};
  constexpr std::array<float, 3> off{0.03F, -0.05F, 0.04F};
  const double extent = double(table.high) - table.low;
  std::vector<float> texels;
  for (int i = 0; i < 8; ++i) {
    const double place = (i & 1) * slope[0] + (i >> 1 & 1) * slope[1] + (i >> 2) * slope[2];
    texels.push_back(float(table.low + place * extent));
  }
  const RenderedImage image = probe.slope(texels, off);
  constexpr int rim = edge / 4 + 6;
  for (int y = rim; y < edge - rim; ++y) {
    for (int x = rim; x < edge - rim; ++x) {
      const auto place = [&](double away) {
        const std::array<double, 3> at{(x + 0.5) / edge + away * off[0], (y + 0.5) / edge + away * off[1],
                                       0.5 + away * off[2]};
        double sum = 0;
        for (std::size_t k = 0; k < 3; ++k) sum += slope[k] * (2 * at[k] - 0.5);
        return sum;
      };
      const auto [low, high] = colours_around(table, place(0), place(1), weight_error * (table.edge - 1));
      const volume::Rgba& colour = image[std::size_t(y) * edge + std::size_t(x)];
      for (std::size_t c = 0; c < 4; ++c) {
        if (!(colour[c] >= low[c] - same_fogged_colour && colour[c] <= high[c] + same_fogged_colour))
          return true;
      }
    }
  }
  return false;
}

/// The pre-integration table that explains the colours, where input `end` addresses the volume a second time;
/// null when they depend on more.
std::optional<Probed> probe_slice_segments(SegmentProbe& probe, const Pipeline& pipeline,
                                           const FragmentInputs& fragment, const std::array<float, 2>& range,
                                           std::size_t end) {
  if (pipeline.blending.op == volume::Operator::min || pipeline.blending.alpha.op == volume::Operator::min)
    return std::nullopt;
  SegmentValues spread{};
  for (std::size_t i = 0; i < spread.size(); ++i) {
    const double place = double(i) / double(spread.size() - 1);
    spread[i] = float(range[0] + place * (double(range[1]) - range[0]));
  }
  const RenderedImage some = probe.pairs(spread, spread, fragment.first);
  const auto same_everywhere = [&](const InputValues& inputs) {
    for (const std::size_t front : {std::size_t(0), segment_tile / 5, segment_tile / 2, segment_tile - 1}) {
      for (const std::size_t back :
           {std::size_t(0), segment_tile / 3, 4 * segment_tile / 5, segment_tile - 1}) {
        for (const volume::Rgba& colour : probe.everywhere(spread[front], spread[back], inputs)) {
          if (!(largest_difference(colour, some[back * segment_tile + front]) <= same_colour)) return false;
        }
      }
    }
    return true;
  };
  if (!finite(some) || !same_everywhere(fragment.first) || !same_everywhere(fragment.last)) return std::nullopt;
  Probed probed;
  const std::vector<Number> varying = varying_numbers(fragment);
  probed.range = widened(fragment.range, varying);
  for (const Number& number : varying) {
    if (number.input == end) continue;
    for (const InputValues* bound : {&probed.range.low, &probed.range.high}) {
      InputValues inputs = fragment.first;
      inputs[number.input][number.component] = (*bound)[number.input][number.component];
      if (!(largest_difference(probe.pairs(spread, spread, inputs), some) <= same_colour)) return std::nullopt;
    }
  }
  volume::PreIntegrationTable table =
      measure_segments([&](const SegmentValues& front,
                           const SegmentValues& back) { return probe.pairs(front, back, fragment.first); },
                       range, pipeline.blending.premultiplied);
  if (!finite(table.entries) || slice_segments_see_neighbours(probe, table)) return std::nullopt;
  for (volume::Rgba& entry : table.entries) {
    if (pipeline.target.floating) {
      if (*std::min_element(entry.begin(), entry.end()) < 0 || entry[3] > 1) return std::nullopt;
    } else {
      for (float& component : entry) component = std::clamp(component, 0.0F, 1.0F);
    }
  }
  // Where the second sample lies is the geometry's matter, and may change.
  probed.range.low[end].fill(std::numeric_limits<float>::lowest());
  probed.range.high[end].fill(std::numeric_limits<float>::max());
  probed.segment_end = end;
  probed.classification = std::move(table);
  return probed;
}

ProbeFinding probe_table(Bench& bench, const GlContext& context, const Pipeline& pipeline,
                         const TextureDescription& texture, const FragmentInputs& fragment,
                         const std::array<float, 2>& range) {
  constexpr const char* more_than_the_sample =
      "the colour depends on more than the sample (position, lighting)";
  TableProbe probe(bench, context, texture, fragment, range);
  RenderedImage table = probe.table(fragment.first);
  if (!finite(table)) return "the fragment stage gives colours that are not finite";

  // A fragment that is discarded is transparent to every operator but the minimum, for which zero is a value.
  if (pipeline.blending.op == volume::Operator::min || pipeline.blending.alpha.op == volume::Operator::min) {
    if (bench.draw(without_coordinate(fragment, fragment.first), true, {1, 1, 1, 1}) != table)
      return "fragments are discarded under a minimum";
  }

  const std::vector<Number> varying = varying_numbers(fragment);
  Probed probed;
  InputValues elsewhere = fragment.last;
  bool explained = false;
  for (const InputRange& tried : {widened(fragment.range, varying), fragment.range}) {
    probed.range = tried;
    std::vector<Number> telling;  // on which the colour depends
    for (const Number& number : varying) {
      for (const InputValues* end : {&tried.low, &tried.high}) {
        const float value = (*end)[number.input][number.component];
        if (largest_difference(probe.table(probe.first_but(number, value)), table) <= same_colour) continue;
        telling.push_back(number);
        break;
      }
    }
    if (telling.size() == 1 && !fragment.inputs[telling.front().input].integer)
      probed.fog =
          probe_fog(probe, telling.front(), fragment.range, tried, pipeline.blending.premultiplied, table);
    if (probed.fog) {
      elsewhere[probed.fog->input][probed.fog->component] = probed.fog->reference;
      probed.range.low[probed.fog->input][probed.fog->component] = probed.fog->low;
      probed.range.high[probed.fog->input][probed.fog->component] = probed.fog->high;
    }
    explained = telling.empty() || probed.fog;
    if (explained) break;
  }
  if (!explained) return more_than_the_sample;

  // The same samples with other coordinates and other inputs: a single texel, spread over the whole image.
  for (const int entry :
       {0, probed_entries / 5, probed_entries / 2, 4 * probed_entries / 5, probed_entries - 1}) {
    for (const volume::Rgba& colour : probe.everywhere(std::size_t(entry), elsewhere)) {
      if (!(largest_difference(colour, table[std::size_t(entry)]) <= same_colour)) return more_than_the_sample;
    }
  }

  InputValues tabled = fragment.first;
  if (probed.fog) tabled[probed.fog->input][probed.fog->component] = probed.fog->reference;
  // The fixed function of a stack's slices looks at one place only.
  const bool one_place = pipeline.stack && pipeline.program == 0;
  if (!one_place && sees_neighbours(bench, context, texture, range, without_coordinate(fragment, tabled), table,
                                    pipeline.stack))
    return "the colour depends on the field around the sample (gradient, lighting)";

  volume::TransferFunction function;
  function.low = range[0];
  function.high = range[1];
  function.entries.assign(table.begin(), table.begin() + probed_entries);
  for (volume::Rgba& entry : function.entries) {
    // The application's framebuffer clamps fragments before it blends them, unless it is float.
    if (pipeline.target.floating) {
      const bool composable = *std::min_element(entry.begin(), entry.end()) >= 0 && entry[3] <= 1;
      if (!composable) return "the colours leave [0,1] in a float framebuffer";
    } else {
      for (float& component : entry) component = std::clamp(component, 0.0F, 1.0F);
    }
    if (pipeline.blending.premultiplied) continue;
    for (std::size_t c = 0; c < 3; ++c) entry[c] *= entry[3];
  }
  probed.classification = std::move(function);
  return probed;
}

ProbeFinding probe_map(Bench& bench, const GlContext& context, const Pipeline& pipeline,
                       const TextureDescription& texture, const FragmentInputs& fragment) {
  volume::LinearMap map;
  map.multiply_by_alpha = !pipeline.blending.premultiplied;
  if (bench.alpha_test_enabled()) {
    const DispatchTable& gl = *context.gl;
    GLint compare = 0;
    GLfloat reference = 0;
    gl.GetIntegerv(GL_ALPHA_TEST_FUNC, &compare);
    gl.GetFloatv(GL_ALPHA_TEST_REF, &reference);
    if (compare == GL_GREATER) {
      map.alpha_above = reference;
    } else if (compare != GL_ALWAYS) {
      return "the alpha test on a colour volume is not GREATER";
    }
  }
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(0.0F, 1.0F);
  std::vector<float> texels(std::size_t(4) * pixels);
  for (float& x : texels) x = uniform(random);
  // Black, then each component alone: the columns of the map.
  std::fill_n(texels.begin(), 20, 0.0F);
  for (std::size_t c = 0; c < 4; ++c) texels[4 * (c + 1) + c] = 1.0F;
  // Colours without alpha have one everywhere, and what black gives is that alpha's column.
  for (std::size_t i = 3; texture.opaque && i < texels.size(); i += 4) texels[i] = 1.0F;
  const GLenum format = texture.opaque ? GL_RGB32F : GL_RGBA32F;
  bench.show(format, GL_RGBA, edge, edge, texels, texture.swizzle, context.version >= 330);
  const RenderedImage mapped = bench.draw(without_coordinate(fragment, fragment.first), false);
  for (std::size_t row = 0; row < 4; ++row) {
    for (std::size_t column = 0; column < 4; ++column) {
      const float of_alpha = texture.opaque ? mapped[0][row] : 0.0F;
      map.matrix[4 * row + column] =
          texture.opaque && column == 3 ? of_alpha : mapped[column + 1][row] - of_alpha;
    }
  }
  for (std::size_t i = 0; i < pixels; ++i) {
    volume::Rgba expected{};
    for (std::size_t row = 0; row < 4; ++row) {
      for (std::size_t column = 0; column < 4; ++column) {
        expected[row] += map.matrix[4 * row + column] * texels[4 * i + column];
      }
    }
    if (!(largest_difference(mapped[i], expected) <= same_colour))
      return "the map of a colour volume is not linear";
  }
  if (pipeline.target.floating && leaves_unit_interval(map.matrix))
    return "the colours leave [0,1] in a float framebuffer";
  const float alpha = texture.opaque ? 1.0F : 0.5F;
  bench.show(format, GL_RGBA, 1, 1, {0.25F, 0.5F, 0.75F, alpha}, texture.swizzle, context.version >= 330);
  const RenderedImage constant = bench.draw(without_coordinate(fragment, fragment.last), false);
  for (std::size_t row = 0; row < 4; ++row) {
    const float* m = &map.matrix[4 * row];
    const float expected = 0.25F * m[0] + 0.5F * m[1] + 0.75F * m[2] + alpha * m[3];
    for (const volume::Rgba& colour : constant) {
      if (!(std::abs(colour[row] - expected) <= same_colour)) {
        return "the colour depends on more than the sample (position, lighting)";
      }
    }
  }
  return Probed{map, std::nullopt, fragment.range};
}

}  // namespace

GLenum probe_format(BaseFormat base) {
  switch (base) {
    case BaseFormat::luminance:
      return GL_LUMINANCE32F_ARB;
    case BaseFormat::intensity:
      return GL_INTENSITY32F_ARB;
    case BaseFormat::alpha:
      return GL_ALPHA32F_ARB;
    case BaseFormat::rgba:
      return GL_RGBA32F;
    default:
      return GL_R32F;
  }
}

GLenum upload_format(BaseFormat base) {
  switch (base) {
    case BaseFormat::luminance:
      return GL_LUMINANCE;
    case BaseFormat::alpha:
      return GL_ALPHA;
    case BaseFormat::rgba:
      return GL_RGBA;
    default:
      return GL_RED;
  }
}

ProbeFinding probe_classification(const GlContext& context, const Pipeline& pipeline,
                                  const TextureDescription& texture, const FragmentInputs& fragment,
                                  const std::array<float, 2>& range) {
  Bench bench(context, pipeline);
  if (!bench.complete()) return "the driver offers no float framebuffer to probe with";
  std::string trouble;
  bench.own(probe_program(context, fragment.record.get(), fragment.inputs, fragment.coordinate, trouble));
  if (bench.program() == 0) return trouble;
  if (fragment.record != nullptr) copy_uniforms(context, fragment.application, bench.program());
  if (texture.base == BaseFormat::rgba) return probe_map(bench, context, pipeline, texture, fragment);
  ProbeFinding finding = probe_table(bench, context, pipeline, texture, fragment, range);
  for (const std::size_t end : fragment.segment_ends) {
    if (std::holds_alternative<Probed>(finding)) break;
    SegmentProbe slice_segments(bench, context, texture, fragment, end);
    if (auto pairs = probe_slice_segments(slice_segments, pipeline, fragment, range, end))
      finding = *std::move(pairs);
  }
  return finding;
}

}  // namespace understudy::spu
