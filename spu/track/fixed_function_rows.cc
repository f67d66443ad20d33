// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include "spu/track/state_row_kinds.h"

namespace understudy::spu {
namespace {

using namespace state_row_kinds;

constexpr StateRow light(GLenum name, int count, StateGroup group = StateGroup::values) {
  StateRow row = plain(group, Lightfv, {{name, count}});
  row.named = true;
  if (group == StateGroup::eye_space) row.matrix_mode = GL_MODELVIEW;
  return compatibility(asked(Question::light, each(Per::light, GL_LIGHT0, row)));
}
constexpr StateRow clip_plane_row() {
  StateRow row = plain(StateGroup::eye_space, ClipPlane, {{GL_CLIP_PLANE0, 4}});
  row.matrix_mode = GL_MODELVIEW;
  return compatibility(asked(Question::clip_plane, each(Per::clip_plane, GL_CLIP_PLANE0, row)));
}
constexpr StateRow texture_gen(GLenum coordinate, GLenum name, int count) {
  const bool eye = name == GL_EYE_PLANE;
  StateRow row =
      targeted(eye ? StateGroup::eye_space : StateGroup::values, TexGendv, coordinate, {{name, count}});
  row.named = true;
  if (eye) row.matrix_mode = GL_MODELVIEW;
  return compatibility(asked(Question::texture_gen, of_unit(Per::texture_coordinates, row)));
}
constexpr StateRow texture_env(GLenum name, int count = 1, GLenum target = GL_TEXTURE_ENV, int version = 130) {
  StateRow row = targeted(StateGroup::values, TexEnvfv, target, {{name, count}});
  row.named = true;
  return from(version, compatibility(asked(Question::texture_env, of_unit(Per::texture_coordinates, row))));
}
constexpr StateRow material(GLenum face, GLenum name, int count) {
  StateRow row = targeted(StateGroup::values, Materialfv, face, {{name, count}});
  row.named = true;
  return compatibility(asked(Question::material, row));
}

constexpr StateRow lighting_rows[] = {
    light(GL_POSITION, 4, StateGroup::eye_space),
    light(GL_SPOT_DIRECTION, 3, StateGroup::eye_space),
    clip_plane_row(),
    texture_gen(GL_S, GL_EYE_PLANE, 4),
    texture_gen(GL_T, GL_EYE_PLANE, 4),
    texture_gen(GL_R, GL_EYE_PLANE, 4),
    texture_gen(GL_Q, GL_EYE_PLANE, 4),
    light(GL_AMBIENT, 4),
    light(GL_DIFFUSE, 4),
    light(GL_SPECULAR, 4),
    light(GL_SPOT_EXPONENT, 1),
    light(GL_SPOT_CUTOFF, 1),
    light(GL_CONSTANT_ATTENUATION, 1),
    light(GL_LINEAR_ATTENUATION, 1),
    light(GL_QUADRATIC_ATTENUATION, 1),
    fixed(LightModelfv, GL_LIGHT_MODEL_AMBIENT, 4),
    fixed(LightModelf, GL_LIGHT_MODEL_LOCAL_VIEWER),
    fixed(LightModelf, GL_LIGHT_MODEL_TWO_SIDE),
    from(120, fixed(LightModelf, GL_LIGHT_MODEL_COLOR_CONTROL)),
    material(GL_FRONT, GL_AMBIENT, 4),
    material(GL_FRONT, GL_DIFFUSE, 4),
    material(GL_FRONT, GL_SPECULAR, 4),
    material(GL_FRONT, GL_EMISSION, 4),
    material(GL_FRONT, GL_SHININESS, 1),
    material(GL_FRONT, GL_COLOR_INDEXES, 3),
    material(GL_BACK, GL_AMBIENT, 4),
    material(GL_BACK, GL_DIFFUSE, 4),
    material(GL_BACK, GL_SPECULAR, 4),
    material(GL_BACK, GL_EMISSION, 4),
    material(GL_BACK, GL_SHININESS, 1),
    material(GL_BACK, GL_COLOR_INDEXES, 3),
    compatibility(value(ColorMaterial, {{GL_COLOR_MATERIAL_FACE, 1}, {GL_COLOR_MATERIAL_PARAMETER, 1}})),
    compatibility(value(ShadeModel, {{GL_SHADE_MODEL, 1}})),
    compatibility(value(AlphaFunc, {{GL_ALPHA_TEST_FUNC, 1}, {GL_ALPHA_TEST_REF, 1}})),
    fixed(Fogfv, GL_FOG_COLOR, 4),
    fixed(Fogf, GL_FOG_MODE),
    fixed(Fogf, GL_FOG_DENSITY),
    fixed(Fogf, GL_FOG_START),
    fixed(Fogf, GL_FOG_END),
    fixed(Fogf, GL_FOG_INDEX),
    from(140, fixed(Fogf, GL_FOG_COORD_SRC)),
    texture_gen(GL_S, GL_TEXTURE_GEN_MODE, 1),
    texture_gen(GL_T, GL_TEXTURE_GEN_MODE, 1),
    texture_gen(GL_R, GL_TEXTURE_GEN_MODE, 1),
    texture_gen(GL_Q, GL_TEXTURE_GEN_MODE, 1),
    texture_gen(GL_S, GL_OBJECT_PLANE, 4),
    texture_gen(GL_T, GL_OBJECT_PLANE, 4),
    texture_gen(GL_R, GL_OBJECT_PLANE, 4),
    texture_gen(GL_Q, GL_OBJECT_PLANE, 4),
    texture_env(GL_TEXTURE_ENV_MODE),
    texture_env(GL_TEXTURE_ENV_COLOR, 4),
    texture_env(GL_COMBINE_RGB),
    texture_env(GL_COMBINE_ALPHA),
    texture_env(GL_SRC0_RGB),
    texture_env(GL_SRC1_RGB),
    texture_env(GL_SRC2_RGB),
    texture_env(GL_SRC0_ALPHA),
    texture_env(GL_SRC1_ALPHA),
    texture_env(GL_SRC2_ALPHA),
    texture_env(GL_OPERAND0_RGB),
    texture_env(GL_OPERAND1_RGB),
    texture_env(GL_OPERAND2_RGB),
    texture_env(GL_OPERAND0_ALPHA),
    texture_env(GL_OPERAND1_ALPHA),
    texture_env(GL_OPERAND2_ALPHA),
    texture_env(GL_RGB_SCALE),
    texture_env(GL_ALPHA_SCALE),
    texture_env(GL_TEXTURE_LOD_BIAS, 1, GL_TEXTURE_FILTER_CONTROL, 140),
    texture_env(GL_COORD_REPLACE, 1, GL_POINT_SPRITE, 200),
    compatibility(value(ListBase, {{GL_LIST_BASE, 1}})),
};

constexpr StateRow matrix(GLenum mode, GLenum name) {
  StateRow row = plain(StateGroup::matrices, LoadMatrixd, {{name, 16}});
  row.matrix_mode = mode;
  return compatibility(row);
}

constexpr StateRow matrix_rows[] = {
    matrix(GL_MODELVIEW, GL_MODELVIEW_MATRIX),
    matrix(GL_PROJECTION, GL_PROJECTION_MATRIX),
    of_unit(Per::texture_coordinates, matrix(GL_TEXTURE, GL_TEXTURE_MATRIX)),
};

constexpr StateRow current_row(CallId set, GLenum name, int count) {
  return compatibility(plain(StateGroup::current, set, {{name, count}}));
}
constexpr StateRow current_texture_coordinates() {
  StateRow row =
      each(Per::texture_coordinates, GL_TEXTURE0, current_row(MultiTexCoord4f, GL_CURRENT_TEXTURE_COORDS, 4));
  row.selector = Selector::texture_unit;
  return row;
}

constexpr StateRow current_rows[] = {
    current_row(Color4f, GL_CURRENT_COLOR, 4),
    from(140, current_row(SecondaryColor3f, GL_CURRENT_SECONDARY_COLOR, 3)),
    current_row(Normal3f, GL_CURRENT_NORMAL, 3),
    current_row(Indexf, GL_CURRENT_INDEX, 1),
    from(140, current_row(FogCoordf, GL_CURRENT_FOG_COORD, 1)),
    current_row(EdgeFlag, GL_EDGE_FLAG, 1),
    from(130, current_texture_coordinates()),
    from(200, each(Per::vertex_attribute, 0,
                   asked(Question::vertex_attribute,
                         plain(StateGroup::current, VertexAttrib4f, {{GL_CURRENT_VERTEX_ATTRIB, 4}})))),
};

}  // namespace

std::span<const StateRow> fixed_function_rows() {
  static const std::vector<StateRow> rows = [] {
    std::vector<StateRow> all(std::begin(lighting_rows), std::end(lighting_rows));
    all.insert(all.end(), std::begin(matrix_rows), std::end(matrix_rows));
    all.insert(all.end(), std::begin(current_rows), std::end(current_rows));
    return all;
  }();
  return rows;
}

}  // namespace understudy::spu
