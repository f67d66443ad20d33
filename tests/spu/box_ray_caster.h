// SPDX-License-Identifier: Apache-2.0
// An application that draws the faces of a box with a fragment shader that marches through the box's volume.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "gl_application.h"

namespace understudy::spu::testing {

/// Variants of the ray march.
struct MarchStyle {
  enum class Composition { over, maximum, sum, minimum, grey_sum, mean_of_colours, mean_of_values };

  Composition composition = Composition::over;
  bool premultiplied = true;  ///< the shader's output, and the blend function
  bool alpha_twice = false;   ///< with `premultiplied`: the blend function multiplies by alpha again
  bool replaces = false;      ///< blending is disabled
  bool adds = false;          ///< blending adds the fragment to the framebuffer
  /// The shader blends its rays over this colour and writes an alpha of 1.
  std::optional<std::array<float, 3>> background{};
  bool writes_depth = false;
  bool discards = true;  ///< rays without a sample, and fragments outside `shown`
  /// Lower left and upper right corner, in window pixels: as vispy clips its views. The default removes one
  /// edge.
  std::array<float, 4> shown{1, 1, 1000, 1000};
  float shown_radius = 0;     ///< discards fragments farther from the window's centre; 0: none
  bool divided = false;       ///< divides the ray into equal parts instead of steps of one length
  bool parallel = false;      ///< the projection
  bool both_faces = false;    ///< neither front nor back faces of the box are culled
  bool face_by_face = false;  ///< each face of the box is a draw
  float ends_at = 0.999F;     ///< rays end at this opacity
  bool way_from_eye = false;  ///< the varying is the vector from the eye to the box's surface
  /// The vertex shader's output and the fragment shader's input have different names, but the same location.
  bool matched_by_location = false;
  bool whole_rays = false;  ///< rays begin at the nearest face, whichever face generates the fragment
  bool lit = false;         ///< brightness depends on the gradient
  /// Diffuse and specular light from the eye, by central differences over 2 `tap`.
  bool lit_from_eye = false;
  float ambient = 0.3F;
  std::array<float, 3> tap{0.3F / 24, 0.3F / 20, 0.3F / 17};  ///< in texture coordinates
  bool tap_of_a_texel = false;                                ///< from the texture's size instead
  bool jittered = false;                                      ///< every ray has its own start offset
  bool noisy = false;  ///< start offsets come from a texture that repeats over the window
  /// A sampler object filters the noise: the texture's own filter requires mipmap levels that it does not have.
  bool noise_sampler = false;
  bool dense_rim = false;                ///< the values are the largest at the faces of the box
  bool at_least_one = false;             ///< rays that are too short still have one sample
  bool reads_depth = false;              ///< rays end at the depth that a texture holds
  std::array<float, 3> extent{1, 1, 1};  ///< of the box, in the unit of `step`
  float step = 0.02F;
  double distance = 3;  ///< from the eye to the centre of the box
  double near = 0.5;    ///< the near plane
  /// Before it is drawn, the box is cut at the near plane and closed there.
  bool closed_before_eye = false;
  bool half_a_wall = false;  ///< the wall is a triangle that ends along a diagonal of the window
  /// Planes of a grid of 27 regions, in dataset coordinates, and the regions that are kept, x fastest.
  std::array<float, 6> cropping_planes{};
  std::uint32_t kept_regions = all_regions;
  static constexpr std::uint32_t all_regions = (1U << 27U) - 1;
  /// A point and a normal each, in world coordinates: rays begin and end at these planes.
  std::vector<std::array<float, 6>> clipping_planes;
  float past_planes = 0;  ///< samples are taken up to this many steps behind a plane
};

class BoxRayCaster {
 public:
  explicit BoxRayCaster(const MarchStyle& style) : style(style) {}

  /// Creates program, box and volume; requires a core profile.
  void set_up(GlApplication& app);
  /// Clears, draws a wall at window depth `wall` unless that is 0, and draws the volume.
  void draw(GlApplication& app, double angle, float wall = 0);
  void set_table(GlApplication& app, float opacity) const;
  void set_noise(GlApplication& app, unsigned seed) const;

  MarchStyle style;
  GLuint program() const { return program_; }

 private:
  GLuint program_ = 0;
  GLuint wall_program_ = 0;
  GLuint box_ = 0;
  GLuint corners_ = 0;
  GLsizei corner_count_ = 36;
  bool closed_before_ = false;
  GLuint depth_ = 0;
};

}  // namespace understudy::spu::testing
