// SPDX-License-Identifier: Apache-2.0
// A run of slices is drawn several times: for inspection, for comparison, and by the application itself. Each
// time its vertices must get the colours of the first time, and afterwards the application must find the
// colours that it set.
#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <memory>
#include <vector>

#include "drawing.h"

namespace understudy::spu::testing {
namespace {

constexpr int slices = 40;
constexpr std::array<GLfloat, 4> first_colour{0.9F, 0.8F, 0.7F, 0.6F};
constexpr std::array<GLfloat, 4> last_colour{1, 0.1F, 0, 0.2F};

/// Four corners of slice `i`: three texture coordinates and three position coordinates each. The last slice is
/// moved by `stray`.
std::array<std::array<GLfloat, 6>, 4> corners(int i, float stray) {
  std::array<std::array<GLfloat, 6>, 4> all{};
  const float z = (float(i) + 0.5F) / slices + (i + 1 == slices ? stray : 0);
  constexpr std::array<std::array<GLfloat, 2>, 4> square{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  for (std::size_t k = 0; k < 4; ++k) {
    const auto [x, y] = square[k];
    all[k] = {x, y, z, x - 0.5F, y - 0.5F, z - 0.5F};
  }
  return all;
}

void draw_singly(GlApplication& app, int i, float stray) {
  app.gl().Begin(GL_QUADS);
  for (const auto& corner : corners(i, stray)) {
    app.gl().TexCoord3fv(corner.data());
    app.gl().Vertex3fv(corner.data() + 3);
  }
  app.gl().End();
}

/// From an application array that is refilled for every slice.
void draw_from_memory(GlApplication& app, int i, float stray) {
  static std::array<std::array<GLfloat, 6>, 4> memory;
  memory = corners(i, stray);
  if (i == 0) {
    app.gl().EnableClientState(GL_VERTEX_ARRAY);
    app.gl().EnableClientState(GL_TEXTURE_COORD_ARRAY);
    app.gl().TexCoordPointer(3, GL_FLOAT, sizeof memory[0], memory[0].data());
    app.gl().VertexPointer(3, GL_FLOAT, sizeof memory[0], memory[0].data() + 3);
  }
  app.gl().DrawArrays(GL_QUADS, 0, 4);
}

struct Way {
  const char* name;
  void (*draw)(GlApplication& app, int i, float stray);
};

class CurrentAttributes : public ::testing::TestWithParam<Way> {
 protected:
  void SetUp() override {
    app_ = GlApplication::start(Profile::compatibility);
    if (!app_) GTEST_SKIP() << "no EGL context here; install libegl1 and libgl1-mesa-dri";
    load_colours(*app_);
    app_->gl().TexEnvi(GL_TEXTURE_ENV, GL_TEXTURE_ENV_MODE, GL_MODULATE);
  }

  /// The slices get the first colour; the last colour is set while their run is still open.
  std::vector<float> frame(bool under, float stray = 0) {
    app_->use_chain(under);
    app_->gl().Viewport(0, 0, GlApplication::size, GlApplication::size);
    app_->gl().ClearColor(0.1F, 0.2F, 0.3F, 1);
    app_->gl().Clear(GL_COLOR_BUFFER_BIT);
    look(*app_, View::perspective, 25);
    app_->gl().Enable(GL_BLEND);
    app_->gl().BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    app_->gl().Enable(GL_TEXTURE_3D);
    app_->gl().Color4fv(first_colour.data());
    for (int i = 0; i < slices; ++i) GetParam().draw(*app_, i, stray);
    app_->gl().Color4fv(last_colour.data());
    app_->gl().Disable(GL_TEXTURE_3D);
    app_->gl().Disable(GL_BLEND);
    std::array<GLfloat, 4> left{};
    app_->gl().GetFloatv(GL_CURRENT_COLOR, left.data());
    EXPECT_EQ(left, last_colour);
    app_->end_frame();
    return app_->read_pixels();
  }

  std::unique_ptr<GlApplication> app_;
};

TEST_P(CurrentAttributes, AreThoseOfTheFirstTimeWhereTheApplicationDrawsInTheEnd) {
  constexpr float stray = 0.01F;  // so that the slices are inspected, but not substituted
  const auto bare = frame(false, stray);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(frame(true, stray), bare) << "frame " << i;
  EXPECT_EQ(app_->substituted(), 0U);
  EXPECT_EQ(app_->last_reason(), "slices are not equally spaced");
  EXPECT_EQ(app_->error(), GLenum(GL_NO_ERROR));
}

TEST_P(CurrentAttributes, AreThoseOfTheFirstTimeWhereImagesAreCompared) {
  const auto bare = frame(false);
  for (int i = 0; i < 12; ++i) EXPECT_GE(psnr(frame(true), bare), 40) << "frame " << i;
  EXPECT_EQ(app_->substituted(), 12U) << app_->last_reason();
  EXPECT_EQ(app_->error(), GLenum(GL_NO_ERROR));
}

INSTANTIATE_TEST_SUITE_P(Of, CurrentAttributes,
                         ::testing::Values(Way{"SlicesOfSingleVertices", draw_singly},
                                           Way{"SlicesFromMemory", draw_from_memory}),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace understudy::spu::testing
