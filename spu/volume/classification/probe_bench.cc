// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/classification/probe_bench.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "spu/volume/context/context.h"
#include "spu/volume/context/kept_errors.h"

namespace understudy::spu {
namespace {

/// What pixels hold before a draw; no fragment has this colour.
constexpr float never_drawn = std::numeric_limits<float>::lowest();

}  // namespace

ProbeBench::ProbeBench(const GlContext& context, const Pipeline& pipeline)
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
  gl_.RenderbufferStorage(GL_RENDERBUFFER, GL_RGBA32F, probe_edge, probe_edge);
  gl_.BindRenderbuffer(GL_RENDERBUFFER, GLuint(application_renderbuffer));
  gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  gl_.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colour_);
  gl_.BindVertexArray(vertex_array_);
  gl_.Viewport(0, 0, probe_edge, probe_edge);
}

ProbeBench::~ProbeBench() {
  if (program_ != 0) gl_.DeleteProgram(program_);
  gl_.DeleteVertexArrays(1, &vertex_array_);
  gl_.DeleteFramebuffers(1, &framebuffer_);
  gl_.DeleteRenderbuffers(1, &colour_);
  gl_.DeleteTextures(1, &texture_);
}

void ProbeBench::show(GLenum internal_format, GLenum format, const std::array<int, 3>& size,
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

ProbedImage ProbeBench::draw(const InputValues& values, bool with_alpha_test, const volume::Rgba& background,
                             const InputValues& across, const InputValues& up) {
  constexpr std::array clear{never_drawn, never_drawn, never_drawn, never_drawn};
  gl_.ClearBufferfv(GL_COLOR, 0, clear.data());
  if (with_alpha_test && alpha_test_) gl_.Enable(GL_ALPHA_TEST);
  gl_.UseProgram(program_);
  const InputValues level(values.size());
  give("understudy_value", values);
  give("understudy_across", across.empty() ? level : across);
  give("understudy_up", up.empty() ? level : up);
  take_error(gl_);  // of preparations: whether they failed shows in what is drawn
  gl_.DrawArrays(GL_TRIANGLES, 0, 3);
  const GLenum error = take_error(gl_);
  if (error_ == GL_NO_ERROR) error_ = error;
  if (alpha_test_) gl_.Disable(GL_ALPHA_TEST);
  ProbedImage image(probe_pixels);
  gl_.ReadPixels(0, 0, probe_edge, probe_edge, GL_RGBA, GL_FLOAT, image.data());
  drew_any_ = false;
  for (volume::Rgba& pixel : image) {
    const bool drawn = pixel[3] != never_drawn;
    drew_any_ |= drawn;
    if (!drawn) pixel = background;
  }
  return image;
}

void ProbeBench::give(const char* name, const InputValues& values) {
  const GLint location = gl_.GetUniformLocation(program_, name);
  if (location >= 0 && !values.empty()) gl_.Uniform4fv(location, GLsizei(values.size()), values.front().data());
}

InputValues without_coordinate(const FragmentInputs& fragment, const InputValues& values) {
  InputValues others;
  for (std::size_t i = 0; i < fragment.inputs.size(); ++i) {
    if (fragment.inputs[i].name != fragment.coordinate) others.push_back(values[i]);
  }
  return others;
}

ProbedImage ProbeBench::draw_along(const FragmentInputs& fragment, const InputNumber& number, float low,
                                   float high, bool with_alpha_test) {
  const float step = (high - low) / float(probe_pixels - 1);
  const InputValues values = with_number(fragment.first, number, low - step * 0.5F * float(probe_edge + 1));
  const InputValues none(values.size());
  const InputValues across = with_number(none, number, step * float(probe_edge));
  const InputValues up = with_number(none, number, step * float(probe_edge * probe_edge));
  return draw(without_coordinate(fragment, values), with_alpha_test, {}, without_coordinate(fragment, across),
              without_coordinate(fragment, up));
}

InputValues with_number(InputValues inputs, const InputNumber& number, float value) {
  inputs[number.input][number.component] = value;
  return inputs;
}

std::vector<InputNumber> varying_numbers(const FragmentInputs& fragment) {
  std::vector<InputNumber> numbers;
  for (std::size_t i = 0; i < fragment.inputs.size(); ++i) {
    if (fragment.inputs[i].name == fragment.coordinate) continue;
    for (std::size_t c = 0; c < 4; ++c) {
      if (!(fragment.range.low[i][c] == fragment.range.high[i][c])) numbers.push_back({i, c});
    }
  }
  return numbers;
}

InputRange widened(InputRange range, const std::vector<InputNumber>& numbers) {
  for (const InputNumber& number : numbers) {
    float& low = range.low[number.input][number.component];
    float& high = range.high[number.input][number.component];
    const float extent = high - low;
    low -= extent;
    high += extent;
  }
  return range;
}

float largest_difference(const ProbedImage& a, const ProbedImage& b) {
  float largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const float difference = largest_difference(a[i], b[i]);
    if (std::isnan(difference)) return difference;
    largest = std::max(largest, difference);
  }
  return largest;
}

bool clamp_as_stored(volume::Rgba& colour, bool floating) {
  if (floating) return *std::min_element(colour.begin(), colour.end()) >= 0 && colour[3] <= 1;
  for (float& component : colour) component = std::clamp(component, 0.0F, 1.0F);
  return true;
}

}  // namespace understudy::spu
