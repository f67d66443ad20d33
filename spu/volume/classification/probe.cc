#include "spu/volume/classification/probe.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>

#include "spu/volume/saved_state.h"

namespace understudy::spu {
namespace {

/// Both the probe's picture and its texture are squares of this edge: one texel a pixel.
constexpr int edge = 64;
constexpr int pixels = edge * edge;
static_assert(probed_entries <= pixels);
/// Two probes of one sample agree to this; interpolation of our own inputs is exact, so only rounding remains.
constexpr float same_colour = 2e-4F;

using Picture = std::vector<volume::Rgba>;

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

  /// One fragment a pixel; a pixel whose fragment was discarded keeps `background`.
  Picture draw(const InputValues& values, bool with_alpha_test, const volume::Rgba& background = {}) {
    gl_.ClearBufferfv(GL_COLOR, 0, background.data());
    if (with_alpha_test && alpha_test_) gl_.Enable(GL_ALPHA_TEST);
    gl_.UseProgram(program_);
    const GLint location = gl_.GetUniformLocation(program_, "understudy_value");
    if (location >= 0 && !values.empty()) {
      gl_.Uniform4fv(location, GLsizei(values.size()), values.front().data());
    }
    gl_.DrawArrays(GL_TRIANGLES, 0, 3);
    if (alpha_test_) gl_.Disable(GL_ALPHA_TEST);
    Picture picture(pixels);
    gl_.ReadPixels(0, 0, edge, edge, GL_RGBA, GL_FLOAT, picture.data());
    return picture;
  }

  bool alpha_test_enabled() const { return alpha_test_; }

 private:
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

bool finite(const Picture& picture) {
  return std::all_of(picture.begin(), picture.end(), [](const volume::Rgba& p) {
    return std::all_of(p.begin(), p.end(), [](float x) { return std::isfinite(x); });
  });
}

/// Whether colours change where the field has a slope: the application looks at more than one place, which flat
/// texels cannot show. The texels rise along all axes, and every sample must get a colour that the table has
/// for about its value.
bool sees_neighbours(Bench& bench, const GlContext& context, const TextureDescription& texture,
                     const std::array<float, 2>& range, const InputValues& inputs, const Picture& table) {
  constexpr int weight_error = 32;  // entries: hardware may weight texels by 8 bits
  constexpr std::array<double, 3> slope{1.0 / 6, 2.0 / 6, 3.0 / 6};
  const double extent = double(range[1]) - range[0];
  std::vector<float> texels;
  for (int i = 0; i < 8; ++i) {
    const double place = (i & 1) * slope[0] + (i >> 1 & 1) * slope[1] + (i >> 2) * slope[2];
    texels.push_back(float(range[0] + place * extent));
  }
  bench.show(probe_format(texture.base), upload_format(texture.base), {2, 2, 2}, texels, GL_LINEAR,
             texture.swizzle, context.version >= 330);
  const Picture picture = bench.draw(inputs, true);
  // Between the texels' centres, and away from them: the slope has a bend there.
  for (int y = edge / 4 + 2; y < 3 * edge / 4 - 2; ++y) {
    for (int x = edge / 4 + 2; x < 3 * edge / 4 - 2; ++x) {
      const double place =
          slope[0] * ((x + 0.5) / edge * 2 - 0.5) + slope[1] * ((y + 0.5) / edge * 2 - 0.5) + slope[2] * 0.5;
      const int entry = int(std::lround(place * (probed_entries - 1)));
      const volume::Rgba& colour = picture[std::size_t(y) * edge + std::size_t(x)];
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

ProbeFinding probe_table(Bench& bench, const GlContext& context, const Pipeline& pipeline,
                         const TextureDescription& texture, const FragmentInputs& fragment,
                         const std::array<float, 2>& range) {
  const GLenum internal_format = probe_format(texture.base);
  const GLenum format = upload_format(texture.base);
  const bool with_swizzle = context.version >= 330;
  std::vector<float> ramp(pixels);
  for (int i = 0; i < pixels; ++i) {
    const double place = double(std::min(i, probed_entries - 1)) / (probed_entries - 1);
    ramp[std::size_t(i)] = float(range[0] + place * (double(range[1]) - range[0]));
  }
  const InputValues first = without_coordinate(fragment, fragment.first);
  const InputValues last = without_coordinate(fragment, fragment.last);
  bench.show(internal_format, format, edge, edge, ramp, texture.swizzle, with_swizzle);
  const Picture table = bench.draw(first, true);
  if (!finite(table)) return "the fragment stage gives colours that are not finite";

  // A fragment that is discarded is transparent to every operator but the minimum, for which zero is a value.
  if (pipeline.blending.op == volume::Operator::min || pipeline.blending.alpha.op == volume::Operator::min) {
    if (bench.draw(first, true, {1, 1, 1, 1}) != table) return "fragments are discarded under a minimum";
  }

  // The same samples with other coordinates and other inputs: a single texel, spread over the whole picture.
  for (const int entry :
       {0, probed_entries / 5, probed_entries / 2, 4 * probed_entries / 5, probed_entries - 1}) {
    bench.show(internal_format, format, 1, 1, {ramp[std::size_t(entry)]}, texture.swizzle, with_swizzle);
    for (const volume::Rgba& colour : bench.draw(last, true)) {
      if (!(largest_difference(colour, table[std::size_t(entry)]) <= same_colour)) {
        return "the colour depends on more than the sample (position, lighting)";
      }
    }
  }

  // The fixed function of a stack's slices looks at one place only.
  if (!pipeline.stack && sees_neighbours(bench, context, texture, range, first, table))
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
  return volume::Classification{std::move(function)};
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
  bench.show(GL_RGBA32F, GL_RGBA, edge, edge, texels, texture.swizzle, context.version >= 330);
  const Picture mapped = bench.draw(without_coordinate(fragment, fragment.first), false);
  for (std::size_t row = 0; row < 4; ++row) {
    for (std::size_t column = 0; column < 4; ++column) map.matrix[4 * row + column] = mapped[column + 1][row];
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
  bench.show(GL_RGBA32F, GL_RGBA, 1, 1, {0.25F, 0.5F, 0.75F, 0.5F}, texture.swizzle, context.version >= 330);
  const Picture constant = bench.draw(without_coordinate(fragment, fragment.last), false);
  for (std::size_t row = 0; row < 4; ++row) {
    const float* m = &map.matrix[4 * row];
    const float expected = 0.25F * m[0] + 0.5F * m[1] + 0.75F * m[2] + 0.5F * m[3];
    for (const volume::Rgba& colour : constant) {
      if (!(std::abs(colour[row] - expected) <= same_colour)) {
        return "the colour depends on more than the sample (position, lighting)";
      }
    }
  }
  return volume::Classification{map};
}

}  // namespace

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
  return probe_table(bench, context, pipeline, texture, fragment, range);
}

}  // namespace understudy::spu
