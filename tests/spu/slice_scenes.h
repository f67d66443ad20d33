// SPDX-License-Identifier: Apache-2.0
// Scenes that draw the same volume by slices, each in another way of speaking OpenGL.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "gl_application.h"

namespace understudy::spu::testing {

/// What one application does in a frame, through whatever table it is given.
struct SliceScene {
  std::string name;
  Profile profile = Profile::compatibility;
  std::function<void(GlApplication&)> set_up;
  std::function<void(GlApplication&, double angle)> slices;  ///< its last call is a slice's
  std::function<void(GlApplication&)> tidy_up;               ///< switches off what they switched on

  void slices_and_tidy_up(GlApplication& app, double angle) const;
  /// A whole frame: clears, then draws the slices.
  void draw(GlApplication& app, double angle) const;
  /// The same up to the last slice.
  void draw_to_the_last_slice(GlApplication& app, double angle) const;
};

/// How a scene's slices go on top of each other.
struct SliceBlending {
  std::function<void(const DispatchTable&)> set;  ///< equation and factors
  bool front_to_back = false;
};
/// SRC_ALPHA, 1 - SRC_ALPHA, back to front.
SliceBlending usual_blending();

/// glBegin/glEnd quads, fixed function, RGBA8 voxels.
SliceScene immediate_rgba();
SliceScene immediate_rgba(const SliceBlending& blending);
/// A display list of quads with eye-linear texgen, six clip planes, lighting with a constant normal, an alpha
/// test, and an INTENSITY texture padded to powers of two: what osgvolume does.
SliceScene display_list_texgen();
/// GLSL 1.20 fragment shader on gl_TexCoord[0] with a 1-D table; one client array refilled for every slice.
SliceScene client_arrays_table();
SliceScene client_arrays_table(const SliceBlending& blending);
/// GLSL 1.20 with a vertex shader and a varying of its own.
SliceScene vertex_shader_varying();
/// A stack of 2-D textures instead of a 3-D one, each bound for one quad; drawn from either side.
SliceScene texture_stack();
/// An ARB fragment program whose second look-up depends on the first: a 1-D table, or a 2-D one under an ARB
/// vertex program.
SliceScene assembly_program(bool two_dimensional_table);
/// Core profile, vertex buffer, one batched draw of triangles with uniforms.
SliceScene core_batched();
/// Polygons computed anew for every frame, a float texture that was defined in another format before, scale and
/// bias before a table of floats, fog towards a background colour, a mask sampler without texture, varyings
/// that nobody writes or reads, an alpha blend function of its own: what PyMOL does.
SliceScene fogged_polygons();

/// Pre-integrated segments: front and back coordinate of each segment from the vertex shader, a 2-D table over
/// both values, float throughout. The back lies behind the front by one vector, or on the ray through it.
SliceScene pre_integrated_slices(bool along_rays);
/// glBegin/glEnd quads through an INTENSITY texture, in fixed-function fog of `mode`.
SliceScene fixed_function_fog(GLenum mode);
/// A stack of 2-D textures of `internal_format` under GLSL with a 1-D table; in a core profile from a buffer, a
/// draw for each slice.
SliceScene texture_stack_program(Profile profile, GLenum internal_format);
/// Corners computed by the application in the eye's space; the program has nothing but a projection.
SliceScene view_space_slices();
/// Core profile, all slices in one strip, joined by degenerate triangles and filled up with zeros.
SliceScene degenerate_strip();

std::vector<SliceScene> all_slice_scenes();

/// Gives the scene's program, the only one that `app` has, another shader for `stage`. Linking forgets
/// uniforms: the field stays on texture unit 0, the table on 1.
void replace_shader(GlApplication& app, GLenum stage, const char* source);

}  // namespace understudy::spu::testing
