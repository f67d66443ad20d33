// SPDX-License-Identifier: Apache-2.0
#include "spu/track/state_rows.h"

#include <algorithm>
#include <vector>

#include "spu/track/state_row_kinds.h"

namespace understudy::spu {
namespace {

using namespace state_row_kinds;

constexpr StateRow framebuffer_rows[] = {
    below(300, plain(StateGroup::of_framebuffer, DrawBuffer, {{GL_DRAW_BUFFER, 1}})),
    from(300, targeted(StateGroup::framebuffer, BindFramebuffer, GL_DRAW_FRAMEBUFFER,
                       {{GL_DRAW_FRAMEBUFFER_BINDING, 1}})),
    from(300, targeted(StateGroup::framebuffer, BindFramebuffer, GL_READ_FRAMEBUFFER,
                       {{GL_READ_FRAMEBUFFER_BINDING, 1}})),
    // OpenGL 3 guarantees eight.
    from(300, plain(StateGroup::of_framebuffer, DrawBuffers,
                    {{GL_DRAW_BUFFER0, 1},
                     {GL_DRAW_BUFFER1, 1},
                     {GL_DRAW_BUFFER2, 1},
                     {GL_DRAW_BUFFER3, 1},
                     {GL_DRAW_BUFFER4, 1},
                     {GL_DRAW_BUFFER5, 1},
                     {GL_DRAW_BUFFER6, 1},
                     {GL_DRAW_BUFFER7, 1}})),
    plain(StateGroup::of_framebuffer, ReadBuffer, {{GL_READ_BUFFER, 1}}),
};

constexpr StateRow client_array(GLenum name) {
  return compatibility(
      asked(Question::enabled, plain(StateGroup::of_vertex_array, EnableClientState, {{name, 1}})));
}
constexpr StateRow client_texture_array() {
  StateRow row = client_array(GL_TEXTURE_COORD_ARRAY);
  row.per = Per::texture_coordinates;
  row.selector = Selector::client_texture_unit;
  return row;
}

constexpr StateRow vertex_array_rows[] = {
    from(300, plain(StateGroup::vertex_array, BindVertexArray, {{GL_VERTEX_ARRAY_BINDING, 1}})),
    client_array(GL_VERTEX_ARRAY),
    client_array(GL_NORMAL_ARRAY),
    client_array(GL_COLOR_ARRAY),
    client_array(GL_INDEX_ARRAY),
    client_array(GL_EDGE_FLAG_ARRAY),
    client_array(GL_SECONDARY_COLOR_ARRAY),
    client_array(GL_FOG_COORD_ARRAY),
    client_texture_array(),
    from(200, each(Per::vertex_attribute, 0,
                   asked(Question::vertex_attribute, plain(StateGroup::of_vertex_array, EnableVertexAttribArray,
                                                           {{GL_VERTEX_ATTRIB_ARRAY_ENABLED, 1}})))),
    from(150, targeted(StateGroup::of_vertex_array, BindBuffer, GL_ELEMENT_ARRAY_BUFFER,
                       {{GL_ELEMENT_ARRAY_BUFFER_BINDING, 1}})),
};

constexpr StateRow buffer(int version, GLenum target, GLenum binding) {
  return from(version, targeted(StateGroup::bindings, BindBuffer, target, {{binding, 1}}));
}
constexpr StateRow buffer_range(int version, Per per, GLenum target, GLenum binding, GLenum start,
                                GLenum size) {
  return from(version,
              asked(Question::address_indexed, each(per, 0,
                                                    targeted(StateGroup::indexed_buffers, BindBufferRange,
                                                             target, {{binding, 1}, {start, 1}, {size, 1}}))));
}
constexpr StateRow texture(int version, GLenum target, GLenum binding) {
  return from(version,
              of_unit(Per::texture_unit, targeted(StateGroup::bindings, BindTexture, target, {{binding, 1}})));
}

constexpr StateRow binding_rows[] = {
    buffer_range(310, Per::uniform_buffer, GL_UNIFORM_BUFFER, GL_UNIFORM_BUFFER_BINDING,
                 GL_UNIFORM_BUFFER_START, GL_UNIFORM_BUFFER_SIZE),
    buffer_range(430, Per::storage_buffer, GL_SHADER_STORAGE_BUFFER, GL_SHADER_STORAGE_BUFFER_BINDING,
                 GL_SHADER_STORAGE_BUFFER_START, GL_SHADER_STORAGE_BUFFER_SIZE),
    buffer_range(420, Per::counter_buffer, GL_ATOMIC_COUNTER_BUFFER, GL_ATOMIC_COUNTER_BUFFER_BINDING,
                 GL_ATOMIC_COUNTER_BUFFER_START, GL_ATOMIC_COUNTER_BUFFER_SIZE),
    buffer(310, GL_UNIFORM_BUFFER, GL_UNIFORM_BUFFER_BINDING),
    buffer(430, GL_SHADER_STORAGE_BUFFER, GL_SHADER_STORAGE_BUFFER_BINDING),
    buffer(420, GL_ATOMIC_COUNTER_BUFFER, GL_ATOMIC_COUNTER_BUFFER_BINDING),
    buffer(150, GL_ARRAY_BUFFER, GL_ARRAY_BUFFER_BINDING),
    buffer(210, GL_PIXEL_PACK_BUFFER, GL_PIXEL_PACK_BUFFER_BINDING),
    buffer(210, GL_PIXEL_UNPACK_BUFFER, GL_PIXEL_UNPACK_BUFFER_BINDING),
    buffer(310, GL_COPY_READ_BUFFER, GL_COPY_READ_BUFFER_BINDING),
    buffer(310, GL_COPY_WRITE_BUFFER, GL_COPY_WRITE_BUFFER_BINDING),
    buffer(310, GL_TEXTURE_BUFFER, GL_TEXTURE_BUFFER_BINDING),
    buffer(400, GL_DRAW_INDIRECT_BUFFER, GL_DRAW_INDIRECT_BUFFER_BINDING),
    buffer(430, GL_DISPATCH_INDIRECT_BUFFER, GL_DISPATCH_INDIRECT_BUFFER_BINDING),
    buffer(440, GL_QUERY_BUFFER, GL_QUERY_BUFFER_BINDING),
    from(300,
         targeted(StateGroup::bindings, BindRenderbuffer, GL_RENDERBUFFER, {{GL_RENDERBUFFER_BINDING, 1}})),
    from(410, plain(StateGroup::bindings, BindProgramPipeline, {{GL_PROGRAM_PIPELINE_BINDING, 1}})),
    from(200, plain(StateGroup::bindings, UseProgram, {{GL_CURRENT_PROGRAM, 1}})),
    texture(110, GL_TEXTURE_1D, GL_TEXTURE_BINDING_1D),
    texture(110, GL_TEXTURE_2D, GL_TEXTURE_BINDING_2D),
    texture(120, GL_TEXTURE_3D, GL_TEXTURE_BINDING_3D),
    texture(130, GL_TEXTURE_CUBE_MAP, GL_TEXTURE_BINDING_CUBE_MAP),
    texture(300, GL_TEXTURE_1D_ARRAY, GL_TEXTURE_BINDING_1D_ARRAY),
    texture(300, GL_TEXTURE_2D_ARRAY, GL_TEXTURE_BINDING_2D_ARRAY),
    texture(310, GL_TEXTURE_RECTANGLE, GL_TEXTURE_BINDING_RECTANGLE),
    texture(310, GL_TEXTURE_BUFFER, GL_TEXTURE_BINDING_BUFFER),
    texture(320, GL_TEXTURE_2D_MULTISAMPLE, GL_TEXTURE_BINDING_2D_MULTISAMPLE),
    texture(320, GL_TEXTURE_2D_MULTISAMPLE_ARRAY, GL_TEXTURE_BINDING_2D_MULTISAMPLE_ARRAY),
    texture(400, GL_TEXTURE_CUBE_MAP_ARRAY, GL_TEXTURE_BINDING_CUBE_MAP_ARRAY),
    from(330,
         of_unit(Per::texture_unit, each(Per::texture_unit, 0,
                                         plain(StateGroup::bindings, BindSampler, {{GL_SAMPLER_BINDING, 1}})))),
};

constexpr StateRow polygon_mode(GLenum face, int element) {
  StateRow row = targeted(StateGroup::values, PolygonMode, face, {{GL_POLYGON_MODE, 1}});
  row.from_value = element;
  return row;
}

constexpr StateRow raster_rows[] = {
    value(PointSize, {{GL_POINT_SIZE, 1}}),
    from(140, fixed(PointParameterf, GL_POINT_SIZE_MIN)),
    from(140, fixed(PointParameterf, GL_POINT_SIZE_MAX)),
    from(140, named(PointParameterf, GL_POINT_FADE_THRESHOLD_SIZE)),
    from(140, fixed(PointParameterfv, GL_POINT_DISTANCE_ATTENUATION, 3)),
    from(200, named(PointParameterf, GL_POINT_SPRITE_COORD_ORIGIN)),
    value(LineWidth, {{GL_LINE_WIDTH, 1}}),
    compatibility(value(LineStipple, {{GL_LINE_STIPPLE_REPEAT, 1}, {GL_LINE_STIPPLE_PATTERN, 1}})),
    compatibility(polygon_mode(GL_FRONT, 0)),
    compatibility(polygon_mode(GL_BACK, 1)),
    core(polygon_mode(GL_FRONT_AND_BACK, 0)),
    value(PolygonOffset, {{GL_POLYGON_OFFSET_FACTOR, 1}, {GL_POLYGON_OFFSET_UNITS, 1}}),
    value(CullFace, {{GL_CULL_FACE_MODE, 1}}),
    value(FrontFace, {{GL_FRONT_FACE, 1}}),
    from(320, value(ProvokingVertex, {{GL_PROVOKING_VERTEX, 1}})),
    from(310, value(PrimitiveRestartIndex, {{GL_PRIMITIVE_RESTART_INDEX, 1}})),
    from(400, named(PatchParameteri, GL_PATCH_VERTICES)),
    from(400, named(PatchParameterfv, GL_PATCH_DEFAULT_OUTER_LEVEL, 4)),
    from(400, named(PatchParameterfv, GL_PATCH_DEFAULT_INNER_LEVEL, 2)),
    from(130, value(SampleCoverage, {{GL_SAMPLE_COVERAGE_VALUE, 1}, {GL_SAMPLE_COVERAGE_INVERT, 1}})),
    from(320, asked(Question::integer_indexed,
                    each(Per::sample_mask, 0, value(SampleMaski, {{GL_SAMPLE_MASK_VALUE, 1}})))),
    from(400, value(MinSampleShading, {{GL_MIN_SAMPLE_SHADING_VALUE, 1}})),
    from(450, value(ClipControl, {{GL_CLIP_ORIGIN, 1}, {GL_CLIP_DEPTH_MODE, 1}})),
    below(410, value(Viewport, {{GL_VIEWPORT, 4}})),
    below(410, value(Scissor, {{GL_SCISSOR_BOX, 4}})),
    below(410, value(DepthRange, {{GL_DEPTH_RANGE, 2}})),
    from(410,
         asked(Question::float_indexed, each(Per::viewport, 0, value(ViewportIndexedf, {{GL_VIEWPORT, 4}})))),
    from(410, asked(Question::integer_indexed,
                    each(Per::viewport, 0, value(ScissorIndexed, {{GL_SCISSOR_BOX, 4}})))),
    from(410, asked(Question::double_indexed,
                    each(Per::viewport, 0, value(DepthRangeIndexed, {{GL_DEPTH_RANGE, 2}})))),
    fixed(Hint, GL_PERSPECTIVE_CORRECTION_HINT),
    fixed(Hint, GL_POINT_SMOOTH_HINT),
    named(Hint, GL_LINE_SMOOTH_HINT),
    named(Hint, GL_POLYGON_SMOOTH_HINT),
    fixed(Hint, GL_FOG_HINT),
    from(140, fixed(Hint, GL_GENERATE_MIPMAP_HINT)),
    from(130, named(Hint, GL_TEXTURE_COMPRESSION_HINT)),
    from(200, named(Hint, GL_FRAGMENT_SHADER_DERIVATIVE_HINT)),
};

constexpr StateRow per_draw_buffer(CallId set, std::initializer_list<StateQuery> queries) {
  return asked(Question::integer_indexed, each(Per::draw_buffer, 0, value(set, queries)));
}

constexpr StateRow fragment_rows[] = {
    below(400, value(BlendFuncSeparate, {{GL_BLEND_SRC_RGB, 1},
                                         {GL_BLEND_DST_RGB, 1},
                                         {GL_BLEND_SRC_ALPHA, 1},
                                         {GL_BLEND_DST_ALPHA, 1}})),
    below(400, value(BlendEquationSeparate, {{GL_BLEND_EQUATION_RGB, 1}, {GL_BLEND_EQUATION_ALPHA, 1}})),
    from(400,
         per_draw_buffer(
             BlendFuncSeparatei,
             {{GL_BLEND_SRC_RGB, 1}, {GL_BLEND_DST_RGB, 1}, {GL_BLEND_SRC_ALPHA, 1}, {GL_BLEND_DST_ALPHA, 1}})),
    from(400,
         per_draw_buffer(BlendEquationSeparatei, {{GL_BLEND_EQUATION_RGB, 1}, {GL_BLEND_EQUATION_ALPHA, 1}})),
    value(BlendColor, {{GL_BLEND_COLOR, 4}}),
    value(LogicOp, {{GL_LOGIC_OP_MODE, 1}}),
    below(300, value(ColorMask, {{GL_COLOR_WRITEMASK, 4}})),
    from(300, per_draw_buffer(ColorMaski, {{GL_COLOR_WRITEMASK, 4}})),
    value(ClearColor, {{GL_COLOR_CLEAR_VALUE, 4}}),
    value(ClearDepth, {{GL_DEPTH_CLEAR_VALUE, 1}}),
    value(ClearStencil, {{GL_STENCIL_CLEAR_VALUE, 1}}),
    compatibility(value(ClearAccum, {{GL_ACCUM_CLEAR_VALUE, 4}})),
    compatibility(value(ClearIndex, {{GL_INDEX_CLEAR_VALUE, 1}})),
    compatibility(value(IndexMask, {{GL_INDEX_WRITEMASK, 1}})),
    value(DepthFunc, {{GL_DEPTH_FUNC, 1}}),
    value(DepthMask, {{GL_DEPTH_WRITEMASK, 1}}),
    from(200, targeted(StateGroup::values, StencilFuncSeparate, GL_FRONT,
                       {{GL_STENCIL_FUNC, 1}, {GL_STENCIL_REF, 1}, {GL_STENCIL_VALUE_MASK, 1}})),
    from(200, targeted(StateGroup::values, StencilFuncSeparate, GL_BACK,
                       {{GL_STENCIL_BACK_FUNC, 1}, {GL_STENCIL_BACK_REF, 1}, {GL_STENCIL_BACK_VALUE_MASK, 1}})),
    from(200,
         targeted(StateGroup::values, StencilOpSeparate, GL_FRONT,
                  {{GL_STENCIL_FAIL, 1}, {GL_STENCIL_PASS_DEPTH_FAIL, 1}, {GL_STENCIL_PASS_DEPTH_PASS, 1}})),
    from(200, targeted(StateGroup::values, StencilOpSeparate, GL_BACK,
                       {{GL_STENCIL_BACK_FAIL, 1},
                        {GL_STENCIL_BACK_PASS_DEPTH_FAIL, 1},
                        {GL_STENCIL_BACK_PASS_DEPTH_PASS, 1}})),
    from(200, targeted(StateGroup::values, StencilMaskSeparate, GL_FRONT, {{GL_STENCIL_WRITEMASK, 1}})),
    from(200, targeted(StateGroup::values, StencilMaskSeparate, GL_BACK, {{GL_STENCIL_BACK_WRITEMASK, 1}})),
    from(300, fixed(ClampColor, GL_CLAMP_VERTEX_COLOR)),
    from(300, fixed(ClampColor, GL_CLAMP_FRAGMENT_COLOR)),
    from(300, named(ClampColor, GL_CLAMP_READ_COLOR)),
};

constexpr StateRow pixel_rows[] = {
    named(PixelStorei, GL_PACK_SWAP_BYTES),
    named(PixelStorei, GL_PACK_LSB_FIRST),
    named(PixelStorei, GL_PACK_ROW_LENGTH),
    from(120, named(PixelStorei, GL_PACK_IMAGE_HEIGHT)),
    named(PixelStorei, GL_PACK_SKIP_ROWS),
    named(PixelStorei, GL_PACK_SKIP_PIXELS),
    from(120, named(PixelStorei, GL_PACK_SKIP_IMAGES)),
    named(PixelStorei, GL_PACK_ALIGNMENT),
    named(PixelStorei, GL_UNPACK_SWAP_BYTES),
    named(PixelStorei, GL_UNPACK_LSB_FIRST),
    named(PixelStorei, GL_UNPACK_ROW_LENGTH),
    from(120, named(PixelStorei, GL_UNPACK_IMAGE_HEIGHT)),
    named(PixelStorei, GL_UNPACK_SKIP_ROWS),
    named(PixelStorei, GL_UNPACK_SKIP_PIXELS),
    from(120, named(PixelStorei, GL_UNPACK_SKIP_IMAGES)),
    named(PixelStorei, GL_UNPACK_ALIGNMENT),
    fixed(PixelTransferf, GL_MAP_COLOR),
    fixed(PixelTransferf, GL_MAP_STENCIL),
    fixed(PixelTransferf, GL_INDEX_SHIFT),
    fixed(PixelTransferf, GL_INDEX_OFFSET),
    fixed(PixelTransferf, GL_RED_SCALE),
    fixed(PixelTransferf, GL_RED_BIAS),
    fixed(PixelTransferf, GL_GREEN_SCALE),
    fixed(PixelTransferf, GL_GREEN_BIAS),
    fixed(PixelTransferf, GL_BLUE_SCALE),
    fixed(PixelTransferf, GL_BLUE_BIAS),
    fixed(PixelTransferf, GL_ALPHA_SCALE),
    fixed(PixelTransferf, GL_ALPHA_BIAS),
    fixed(PixelTransferf, GL_DEPTH_SCALE),
    fixed(PixelTransferf, GL_DEPTH_BIAS),
    compatibility(value(PixelZoom, {{GL_ZOOM_X, 1}, {GL_ZOOM_Y, 1}})),
};

constexpr StateRow fixed_capability(GLenum name) {
  return compatibility(capability(name));
}
constexpr StateRow unit_capability(int version, GLenum name) {
  return from(version, of_unit(Per::texture_coordinates, fixed_capability(name)));
}
constexpr StateRow numbered_capability(Per per, GLenum first) {
  return each(per, first, capability(first));
}
constexpr StateRow indexed_capability(int version, Per per, GLenum name) {
  StateRow row =
      each(per, 0, asked(Question::enabled_indexed, plain(StateGroup::capabilities, Enablei, {{name, 1}})));
  return from(version, row);
}

constexpr StateRow capability_rows[] = {
    below(300, capability(GL_BLEND)),
    indexed_capability(300, Per::draw_buffer, GL_BLEND),
    below(410, capability(GL_SCISSOR_TEST)),
    indexed_capability(410, Per::viewport, GL_SCISSOR_TEST),
    capability(GL_COLOR_LOGIC_OP),
    capability(GL_CULL_FACE),
    capability(GL_DEPTH_TEST),
    capability(GL_DITHER),
    capability(GL_LINE_SMOOTH),
    capability(GL_POLYGON_OFFSET_FILL),
    capability(GL_POLYGON_OFFSET_LINE),
    capability(GL_POLYGON_OFFSET_POINT),
    capability(GL_POLYGON_SMOOTH),
    capability(GL_STENCIL_TEST),
    from(130, capability(GL_MULTISAMPLE)),
    from(130, capability(GL_SAMPLE_ALPHA_TO_COVERAGE)),
    from(130, capability(GL_SAMPLE_ALPHA_TO_ONE)),
    from(130, capability(GL_SAMPLE_COVERAGE)),
    from(200, capability(GL_PROGRAM_POINT_SIZE)),
    from(300, capability(GL_FRAMEBUFFER_SRGB)),
    from(300, capability(GL_RASTERIZER_DISCARD)),
    from(310, capability(GL_PRIMITIVE_RESTART)),
    from(320, capability(GL_DEPTH_CLAMP)),
    from(320, capability(GL_TEXTURE_CUBE_MAP_SEAMLESS)),
    from(320, capability(GL_SAMPLE_MASK)),
    from(400, capability(GL_SAMPLE_SHADING)),
    from(430, capability(GL_PRIMITIVE_RESTART_FIXED_INDEX)),
    from(430, capability(GL_DEBUG_OUTPUT)),
    from(430, capability(GL_DEBUG_OUTPUT_SYNCHRONOUS)),
    numbered_capability(Per::clip_plane, GL_CLIP_PLANE0),
    compatibility(numbered_capability(Per::light, GL_LIGHT0)),
    fixed_capability(GL_ALPHA_TEST),
    fixed_capability(GL_AUTO_NORMAL),
    fixed_capability(GL_FOG),
    fixed_capability(GL_INDEX_LOGIC_OP),
    fixed_capability(GL_LIGHTING),
    fixed_capability(GL_LINE_STIPPLE),
    fixed_capability(GL_MAP1_COLOR_4),
    fixed_capability(GL_MAP1_NORMAL),
    fixed_capability(GL_MAP1_TEXTURE_COORD_1),
    fixed_capability(GL_MAP1_TEXTURE_COORD_2),
    fixed_capability(GL_MAP1_TEXTURE_COORD_3),
    fixed_capability(GL_MAP1_TEXTURE_COORD_4),
    fixed_capability(GL_MAP1_VERTEX_3),
    fixed_capability(GL_MAP1_VERTEX_4),
    fixed_capability(GL_MAP2_COLOR_4),
    fixed_capability(GL_MAP2_NORMAL),
    fixed_capability(GL_MAP2_TEXTURE_COORD_1),
    fixed_capability(GL_MAP2_TEXTURE_COORD_2),
    fixed_capability(GL_MAP2_TEXTURE_COORD_3),
    fixed_capability(GL_MAP2_TEXTURE_COORD_4),
    fixed_capability(GL_MAP2_VERTEX_3),
    fixed_capability(GL_MAP2_VERTEX_4),
    fixed_capability(GL_NORMALIZE),
    fixed_capability(GL_POINT_SMOOTH),
    fixed_capability(GL_POLYGON_STIPPLE),
    from(120, fixed_capability(GL_RESCALE_NORMAL)),
    from(140, fixed_capability(GL_COLOR_SUM)),
    from(200, fixed_capability(GL_POINT_SPRITE)),
    from(200, fixed_capability(GL_VERTEX_PROGRAM_TWO_SIDE)),
    unit_capability(110, GL_TEXTURE_1D),
    unit_capability(110, GL_TEXTURE_2D),
    unit_capability(120, GL_TEXTURE_3D),
    unit_capability(130, GL_TEXTURE_CUBE_MAP),
    unit_capability(310, GL_TEXTURE_RECTANGLE),
    unit_capability(110, GL_TEXTURE_GEN_S),
    unit_capability(110, GL_TEXTURE_GEN_T),
    unit_capability(110, GL_TEXTURE_GEN_R),
    unit_capability(110, GL_TEXTURE_GEN_Q),
    // Last: once it is enabled, the current colour changes the material.
    fixed_capability(GL_COLOR_MATERIAL),
};

constexpr StateRow selector_rows[] = {
    compatibility(plain(StateGroup::selectors, MatrixMode, {{GL_MATRIX_MODE, 1}})),
    from(130,
         compatibility(plain(StateGroup::selectors, ClientActiveTexture, {{GL_CLIENT_ACTIVE_TEXTURE, 1}}))),
    from(130, plain(StateGroup::selectors, ActiveTexture, {{GL_ACTIVE_TEXTURE, 1}})),
};

}  // namespace

std::span<const StateRow> state_rows() {
  static const std::vector<StateRow> rows = [] {
    std::vector<StateRow> all;
    for (const std::span<const StateRow> part :
         {std::span<const StateRow>(framebuffer_rows), std::span<const StateRow>(vertex_array_rows),
          std::span<const StateRow>(binding_rows), fixed_function_rows(),
          std::span<const StateRow>(raster_rows), std::span<const StateRow>(fragment_rows),
          std::span<const StateRow>(pixel_rows), std::span<const StateRow>(capability_rows),
          std::span<const StateRow>(selector_rows)}) {
      all.insert(all.end(), part.begin(), part.end());
    }
    std::stable_sort(all.begin(), all.end(),
                     [](const StateRow& a, const StateRow& b) { return a.group < b.group; });
    return all;
  }();
  return rows;
}

}  // namespace understudy::spu
