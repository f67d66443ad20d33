// SPDX-License-Identifier: Apache-2.0
// Runs the application's fragment pipeline on known texels: a float framebuffer of its own, a texture in place
// of the volume, and a program whose inputs are given.
#pragma once

#include <array>
#include <vector>

#include "spu/volume/classification/colour_difference.h"
#include "spu/volume/classification/probe.h"
#include "spu/volume/context/saved_state.h"
#include "volume/rgba.h"

namespace understudy::spu {

/// The image and the texture of a probe are squares of this edge: one texel per pixel.
constexpr int probe_edge = 64;
constexpr int probe_pixels = probe_edge * probe_edge;
static_assert(probed_entries <= probe_pixels);
/// Two probes of one sample agree to this: our inputs are interpolated exactly, so only rounding remains.
constexpr float same_colour = 2e-4F;
/// The same under fog, which is interpolated between values of its scalar.
constexpr float same_fogged_colour = 4e-3F;

/// Why nothing is known after a first draw that left no pixel: the draw failed, or nothing is visible.
constexpr const char* no_fragment_drawn = "the fragment stage draws nothing, whatever the sample";
constexpr const char* more_than_the_sample = "the colour depends on more than the sample (position, lighting)";

/// Row by row, one fragment per pixel.
using ProbedImage = std::vector<volume::Rgba>;

/// A scalar: one component of one input.
struct InputNumber {
  std::size_t input = 0;  ///< in the order of FragmentInputs::inputs
  std::size_t component = 0;
};

/// The framebuffer, textures and vertex array of one probing; the destructor deletes them.
class ProbeBench {
 public:
  ProbeBench(const GlContext& context, const Pipeline& pipeline);
  ~ProbeBench();
  ProbeBench(const ProbeBench&) = delete;
  ProbeBench& operator=(const ProbeBench&) = delete;

  bool complete() const { return gl_.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE; }
  void own(GLuint program) { program_ = program; }
  GLuint program() const { return program_; }

  /// Uploads the texels of the probe volume: width x height x 1, as floats in `format`.
  void show(GLenum internal_format, GLenum format, int width, int height, const std::vector<float>& texels,
            const std::array<GLint, 4>& swizzle, bool with_swizzle) {
    show(internal_format, format, {width, height, 1}, texels, GL_NEAREST, swizzle, with_swizzle);
  }
  void show(GLenum internal_format, GLenum format, const std::array<int, 3>& size,
            const std::vector<float>& texels, GLenum filter, const std::array<GLint, 4>& swizzle,
            bool with_swizzle);

  /// Draws one fragment per pixel; a pixel whose fragment is discarded keeps `background`. `across` and `up`:
  /// increase of the inputs over the width and height of the image; empty if they are constant.
  ProbedImage draw(const InputValues& values, bool with_alpha_test, const volume::Rgba& background = {},
                   const InputValues& across = {}, const InputValues& up = {});

  /// The same with the inputs of `fragment`, while the scalar `number` runs from `low` in the first pixel to
  /// `high` in the last.
  ProbedImage draw_along(const FragmentInputs& fragment, const InputNumber& number, float low, float high,
                         bool with_alpha_test);

  /// Whether the last draw left any fragment.
  bool drew_any() const { return drew_any_; }
  /// The first error that the driver raised for a draw; GL_NO_ERROR: none. What was drawn is not known then.
  GLenum error() const { return error_; }

  bool alpha_test_enabled() const { return alpha_test_; }

 private:
  void give(const char* name, const InputValues& values);

  const DispatchTable& gl_;
  GLenum target_;
  bool alpha_test_;  ///< queried before SavedState disables it
  SavedState saved_;
  GLuint texture_ = 0;
  GLuint colour_ = 0;
  GLuint framebuffer_ = 0;
  GLuint vertex_array_ = 0;
  GLuint program_ = 0;
  bool drew_any_ = false;
  GLenum error_ = GL_NO_ERROR;
};

/// Returns the values of all inputs but the coordinate, in the order in which the probe program numbers them.
InputValues without_coordinate(const FragmentInputs& fragment, const InputValues& values);

/// Returns the scalars that vary over the run, other than those of the coordinate.
std::vector<InputNumber> varying_numbers(const FragmentInputs& fragment);

/// Returns `inputs` with the scalar `number` set to `value`.
InputValues with_number(InputValues inputs, const InputNumber& number, float value);

/// Returns `range` with the range of each of `numbers` extended by its length on both sides, so that a view
/// that turns requires no new probe.
InputRange widened(InputRange range, const std::vector<InputNumber>& numbers);

/// Returns the largest difference over all pixels and channels.
float largest_difference(const ProbedImage& a, const ProbedImage& b);

/// Clamps a colour as the application's framebuffer stores it before blending, unless it is `floating`. Returns
/// false if a float framebuffer would hold a colour that cannot be composed.
bool clamp_as_stored(volume::Rgba& colour, bool floating);

}  // namespace understudy::spu
