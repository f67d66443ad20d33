// SPDX-License-Identifier: Apache-2.0
// Scenes that draw the same volume by slices, each with different OpenGL features.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "gl_application.h"

namespace understudy::spu::testing {

/// An application's calls in a frame, made through the table that it is given.
struct SliceScene {
  std::string name;
  Profile profile = Profile::compatibility;
  std::function<void(GlApplication&)> set_up;
  std::function<void(GlApplication&, double angle)> slices;  ///< the last call draws a slice
  std::function<void(GlApplication&)> tidy_up;               ///< disables what set_up and slices enabled

  void slices_and_tidy_up(GlApplication& app, double angle) const;
  /// Draws a whole frame: clears, then draws the slices.
  void draw(GlApplication& app, double angle) const;
  /// The same up to the last slice.
  void draw_to_the_last_slice(GlApplication& app, double angle) const;
};

/// How a scene's slices are blended.
struct SliceBlending {
  std::function<void(const DispatchTable&)> set;  ///< sets equation and factors
  bool front_to_back = false;
};
/// SRC_ALPHA, 1 - SRC_ALPHA, back to front.
SliceBlending usual_blending();

/// glBegin/glEnd quads, fixed function, RGBA8 voxels.
SliceScene immediate_rgba();
SliceScene immediate_rgba(const SliceBlending& blending);
/// Like osgvolume: a display list of quads with eye-linear texgen, six clip planes, lighting with a constant
/// normal, an alpha test, and an INTENSITY texture padded to powers of two.
SliceScene display_list_texgen();
/// GLSL 1.20 fragment shader on gl_TexCoord[0] with a 1-D table; one client array refilled for every slice.
SliceScene client_arrays_table();
SliceScene client_arrays_table(const SliceBlending& blending);
/// GLSL 1.20 with a vertex shader and a user-defined varying.
SliceScene vertex_shader_varying();
/// A stack of 2-D textures instead of a 3-D one, each bound for one quad; drawn from either side.
SliceScene texture_stack();
/// An ARB fragment program with a dependent texture read: a 1-D table, or a 2-D one together with an ARB vertex
/// program.
SliceScene assembly_program(bool two_dimensional_table);
/// Core profile, vertex buffer, one batched draw of triangles with uniforms.
SliceScene core_batched();
/// Like PyMOL: polygons recomputed for every frame, a float texture redefined from another format, scale and
/// bias before a float table, fog towards a background colour, a mask sampler without a texture, varyings that
/// are never written or read, a separate alpha blend function.
SliceScene fogged_polygons();

/// Pre-integrated segments: the vertex shader computes front and back coordinate of each segment, a 2-D table
/// takes both values, all in float. The back is offset from the front by a constant vector, or lies on the ray
/// through it.
SliceScene pre_integrated_slices(bool along_rays);
/// glBegin/glEnd quads with an INTENSITY texture, in fixed-function fog of `mode`.
SliceScene fixed_function_fog(GLenum mode);
/// A stack of 2-D textures of `internal_format` under GLSL with a 1-D table; in a core profile from a buffer,
/// with one draw per slice.
SliceScene texture_stack_program(Profile profile, GLenum internal_format);
/// The application computes corners in eye space; the program only projects them.
SliceScene view_space_slices();
/// Core profile, all slices in one strip, joined by degenerate triangles and padded with zeros.
SliceScene degenerate_strip();

std::vector<SliceScene> all_slice_scenes();

/// Replaces the shader of `stage` in the scene's program, the only program of `app`. Linking resets uniforms,
/// so the field is set to texture unit 0 and the table to unit 1 again.
void replace_shader(GlApplication& app, GLenum stage, const char* source);

}  // namespace understudy::spu::testing
