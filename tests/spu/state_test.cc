// SPDX-License-Identifier: Apache-2.0
// Substitution leaves no trace in the state: OpenGL queries return the same after a substituted draw as after
// the application's own.
#include <gtest/gtest.h>

#include <map>
#include <memory>

#include "box_ray_caster.h"
#include "slice_scenes.h"
#include "spu/chain.h"

namespace understudy::spu::testing {
namespace {

using State = std::map<std::string, std::vector<double>>;

struct Asked {
  const char* name;
  GLenum value;
  int count;
};

#define ASK(name, count) \
  { #name, name, count }

/// State that Understudy's drawing might change, and related state. Names of objects that Understudy creates do
/// not belong to the application.
const std::vector<Asked>& asked_everywhere() {
  static const std::vector<Asked> list = {ASK(GL_ACTIVE_TEXTURE, 1),
                                          ASK(GL_ARRAY_BUFFER_BINDING, 1),
                                          ASK(GL_BLEND_COLOR, 4),
                                          ASK(GL_BLEND_DST_ALPHA, 1),
                                          ASK(GL_BLEND_DST_RGB, 1),
                                          ASK(GL_BLEND_EQUATION_ALPHA, 1),
                                          ASK(GL_BLEND_EQUATION_RGB, 1),
                                          ASK(GL_BLEND_SRC_ALPHA, 1),
                                          ASK(GL_BLEND_SRC_RGB, 1),
                                          ASK(GL_COLOR_CLEAR_VALUE, 4),
                                          ASK(GL_COLOR_WRITEMASK, 4),
                                          ASK(GL_CULL_FACE_MODE, 1),
                                          ASK(GL_CURRENT_PROGRAM, 1),
                                          ASK(GL_DEPTH_CLEAR_VALUE, 1),
                                          ASK(GL_DEPTH_FUNC, 1),
                                          ASK(GL_DEPTH_RANGE, 2),
                                          ASK(GL_DEPTH_WRITEMASK, 1),
                                          ASK(GL_DRAW_BUFFER, 1),
                                          ASK(GL_DRAW_FRAMEBUFFER_BINDING, 1),
                                          ASK(GL_ELEMENT_ARRAY_BUFFER_BINDING, 1),
                                          ASK(GL_FRONT_FACE, 1),
                                          ASK(GL_LINE_WIDTH, 1),
                                          ASK(GL_LOGIC_OP_MODE, 1),
                                          ASK(GL_PACK_ALIGNMENT, 1),
                                          ASK(GL_PACK_IMAGE_HEIGHT, 1),
                                          ASK(GL_PACK_LSB_FIRST, 1),
                                          ASK(GL_PACK_ROW_LENGTH, 1),
                                          ASK(GL_PACK_SKIP_IMAGES, 1),
                                          ASK(GL_PACK_SKIP_PIXELS, 1),
                                          ASK(GL_PACK_SKIP_ROWS, 1),
                                          ASK(GL_PACK_SWAP_BYTES, 1),
                                          ASK(GL_PIXEL_PACK_BUFFER_BINDING, 1),
                                          ASK(GL_PIXEL_UNPACK_BUFFER_BINDING, 1),
                                          ASK(GL_POINT_SIZE, 1),
                                          ASK(GL_READ_BUFFER, 1),
                                          ASK(GL_READ_FRAMEBUFFER_BINDING, 1),
                                          ASK(GL_RENDERBUFFER_BINDING, 1),
                                          ASK(GL_SAMPLE_COVERAGE_VALUE, 1),
                                          ASK(GL_SCISSOR_BOX, 4),
                                          ASK(GL_STENCIL_FUNC, 1),
                                          ASK(GL_STENCIL_WRITEMASK, 1),
                                          ASK(GL_TEXTURE_BINDING_1D, 1),
                                          ASK(GL_TEXTURE_BINDING_2D, 1),
                                          ASK(GL_TEXTURE_BINDING_3D, 1),
                                          ASK(GL_TRANSFORM_FEEDBACK_BUFFER_BINDING, 1),
                                          ASK(GL_UNIFORM_BUFFER_BINDING, 1),
                                          ASK(GL_UNPACK_ALIGNMENT, 1),
                                          ASK(GL_UNPACK_IMAGE_HEIGHT, 1),
                                          ASK(GL_UNPACK_LSB_FIRST, 1),
                                          ASK(GL_UNPACK_ROW_LENGTH, 1),
                                          ASK(GL_UNPACK_SKIP_IMAGES, 1),
                                          ASK(GL_UNPACK_SKIP_PIXELS, 1),
                                          ASK(GL_UNPACK_SKIP_ROWS, 1),
                                          ASK(GL_UNPACK_SWAP_BYTES, 1),
                                          ASK(GL_VERTEX_ARRAY_BINDING, 1),
                                          ASK(GL_VIEWPORT, 4)};
  return list;
}

const std::vector<Asked>& asked_of_compatibility() {
  static const std::vector<Asked> list = {ASK(GL_ALPHA_TEST_FUNC, 1),
                                          ASK(GL_ALPHA_TEST_REF, 1),
                                          ASK(GL_ATTRIB_STACK_DEPTH, 1),
                                          ASK(GL_CLIENT_ACTIVE_TEXTURE, 1),
                                          ASK(GL_CLIENT_ATTRIB_STACK_DEPTH, 1),
                                          ASK(GL_CURRENT_COLOR, 4),
                                          ASK(GL_CURRENT_NORMAL, 3),
                                          ASK(GL_CURRENT_TEXTURE_COORDS, 4),
                                          ASK(GL_FEEDBACK_BUFFER_SIZE, 1),
                                          ASK(GL_FEEDBACK_BUFFER_TYPE, 1),
                                          ASK(GL_LIST_INDEX, 1),
                                          ASK(GL_MATRIX_MODE, 1),
                                          ASK(GL_MODELVIEW_MATRIX, 16),
                                          ASK(GL_MODELVIEW_STACK_DEPTH, 1),
                                          ASK(GL_PROJECTION_MATRIX, 16),
                                          ASK(GL_PROJECTION_STACK_DEPTH, 1),
                                          ASK(GL_RENDER_MODE, 1),
                                          ASK(GL_SHADE_MODEL, 1),
                                          ASK(GL_TEXTURE_MATRIX, 16),
                                          ASK(GL_TEXTURE_STACK_DEPTH, 1),
                                          ASK(GL_VERTEX_ARRAY_POINTER, 0)};
  return list;
}

#undef ASK

const std::vector<std::pair<const char*, GLenum>>& capabilities(Profile profile) {
  static const std::vector<std::pair<const char*, GLenum>> core = {{"BLEND", GL_BLEND},
                                                                   {"CULL_FACE", GL_CULL_FACE},
                                                                   {"DEPTH_TEST", GL_DEPTH_TEST},
                                                                   {"DITHER", GL_DITHER},
                                                                   {"MULTISAMPLE", GL_MULTISAMPLE},
                                                                   {"SCISSOR_TEST", GL_SCISSOR_TEST},
                                                                   {"STENCIL", GL_STENCIL_TEST},
                                                                   {"DISCARD", GL_RASTERIZER_DISCARD},
                                                                   {"LOGIC_OP", GL_COLOR_LOGIC_OP},
                                                                   {"CLIP0", GL_CLIP_DISTANCE0},
                                                                   {"CLIP5", GL_CLIP_DISTANCE0 + 5},
                                                                   {"POLYGON_OFFSET", GL_POLYGON_OFFSET_FILL}};
  static const std::vector<std::pair<const char*, GLenum>> compatibility = [] {
    auto all = core;
    for (const auto& extra : std::initializer_list<std::pair<const char*, GLenum>>{
             {"ALPHA_TEST", GL_ALPHA_TEST},
             {"FOG", GL_FOG},
             {"LIGHTING", GL_LIGHTING},
             {"TEXTURE_1D", GL_TEXTURE_1D},
             {"TEXTURE_2D", GL_TEXTURE_2D},
             {"TEXTURE_3D", GL_TEXTURE_3D},
             {"GEN_S", GL_TEXTURE_GEN_S},
             {"VERTEX_ARRAY", GL_VERTEX_ARRAY},
             {"TEXTURE_COORD_ARRAY", GL_TEXTURE_COORD_ARRAY}}) {
      all.push_back(extra);
    }
    return all;
  }();
  return profile == Profile::core ? core : compatibility;
}

State dump(const DispatchTable& gl, Profile profile) {
  State state;
  auto lists = {asked_everywhere(), profile == Profile::core ? std::vector<Asked>{} : asked_of_compatibility()};
  for (const auto& list : lists) {
    for (const Asked& asked : list) {
      if (asked.count == 0) continue;
      std::vector<double> values(16, 0.0);
      gl.GetDoublev(asked.value, values.data());
      values.resize(std::size_t(asked.count));
      state[asked.name] = values;
    }
  }
  for (const auto& [name, capability] : capabilities(profile)) {
    state[name] = {double(gl.IsEnabled(capability))};
  }
  GLint mode[2] = {};
  gl.GetIntegerv(GL_POLYGON_MODE, mode);
  state["GL_POLYGON_MODE"] = {double(mode[0])};
  GLint active = 0;
  gl.GetIntegerv(GL_ACTIVE_TEXTURE, &active);
  for (int unit = 0; unit < 4; ++unit) {
    gl.ActiveTexture(GLenum(GL_TEXTURE0 + unit));
    for (const auto& [name, binding] : {std::pair{"1D", GL_TEXTURE_BINDING_1D},
                                        {"2D", GL_TEXTURE_BINDING_2D},
                                        {"3D", GL_TEXTURE_BINDING_3D},
                                        {"sampler", GL_SAMPLER_BINDING}}) {
      GLint bound = 0;
      gl.GetIntegerv(GLenum(binding), &bound);
      state["unit " + std::to_string(unit) + " " + name] = {double(bound)};
    }
  }
  gl.ActiveTexture(GLenum(active));
  return state;
}

SliceScene box_of_a_ray_caster() {
  SliceScene scene{"the box of a ray caster that reads noise and depth", Profile::core};
  auto caster = std::make_shared<BoxRayCaster>(MarchStyle{.noisy = true, .reads_depth = true});
  scene.set_up = [caster](GlApplication& app) { caster->set_up(app); };
  scene.slices = [caster](GlApplication& app, double angle) { caster->draw(app, angle); };
  scene.tidy_up = [](GlApplication&) {};
  return scene;
}

TEST(StateNeutrality, ASubstitutedDrawLeavesWhatTheApplicationsOwnLeaves) {
  std::vector<SliceScene> scenes = all_slice_scenes();
  scenes.push_back(box_of_a_ray_caster());
  for (const SliceScene& scene : scenes) {
    auto app = GlApplication::start(scene.profile);
    if (!app) GTEST_SKIP() << "no EGL context here";
    scene.set_up(*app);
    // Non-default values, to distinguish a restored default from an untouched one.
    app->gl().PixelStorei(GL_PACK_ALIGNMENT, 2);
    app->gl().PixelStorei(GL_UNPACK_SKIP_PIXELS, 3);
    app->gl().Enable(GL_SCISSOR_TEST);
    app->gl().Scissor(1, 2, 90, 91);
    app->gl().ActiveTexture(GL_TEXTURE0);
    const auto frame = [&](bool under) {
      app->use_chain(under);
      scene.draw(*app, 30);
      app->use_chain(under);
      if (under) Chain::current()->settle();
      return dump(app->driver(), scene.profile);
    };
    const State bare = frame(false);
    const State under = frame(true);
    EXPECT_EQ(app->substituted(), 1U) << scene.name << ": " << app->last_reason();
    for (const auto& [name, values] : bare) EXPECT_EQ(values, under.at(name)) << scene.name << ": " << name;
    EXPECT_EQ(app->error(), GLenum(GL_NO_ERROR)) << scene.name;
    std::printf("%s: %zu states equal\n", scene.name.c_str(), bare.size());
  }
}

TEST(StateNeutrality, TheApplicationsOwnErrorStaysItsOwn) {
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here";
  const SliceScene scene = client_arrays_table();
  scene.set_up(*app);
  app->gl().Enable(0x1234);  // an error of the application
  scene.draw(*app, 10);
  EXPECT_EQ(app->gl().GetError(), GLenum(GL_INVALID_ENUM));
  EXPECT_EQ(app->gl().GetError(), GLenum(GL_NO_ERROR));
  EXPECT_EQ(app->substituted(), 1U) << app->last_reason();
}

}  // namespace
}  // namespace understudy::spu::testing
