// SPDX-License-Identifier: Apache-2.0
// Many slices per call, indices with a base vertex, or instances: as viewers draw whose slices are polygons of
// three to six corners in one buffer, or copies of one polygon.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "gl_application.h"
#include "glsl_program.h"

namespace understudy::spu::testing {
namespace {

constexpr int slices = 40;  // as in the vertex shader
constexpr int corners = 4;  ///< per slice

/// Arguments for drawing all slices, in buffers or in the application's memory.
struct SliceArrays {
  std::vector<GLfloat> places;
  std::vector<GLint> first;
  std::vector<GLsizei> count;
  std::vector<GLushort> indices;      ///< of all slices, one after the other
  std::vector<const void*> own;       ///< where each slice's indices begin
  std::vector<const void*> of_first;  ///< where the first slice's indices begin, repeated for each slice
  std::vector<GLuint> commands;       ///< for indirect draws: of arrays, then of elements
  const void* indirect_arrays = nullptr;
  const void* indirect_elements = nullptr;
  std::vector<GLint> base;  ///< base vertices for `of_first`
};

SliceArrays slice_arrays() {
  SliceArrays arrays;
  for (int i = 0; i < slices; ++i) {
    const auto z = GLfloat((i + 0.5) / slices);
    for (const auto& [x, y] : {std::pair{0.0F, 0.0F}, {1.0F, 0.0F}, {1.0F, 1.0F}, {0.0F, 1.0F}})
      arrays.places.insert(arrays.places.end(), {x, y, z});
    arrays.first.push_back(corners * i);
    arrays.count.push_back(corners);
    arrays.base.push_back(corners * i);
    for (int c = 0; c < corners; ++c) arrays.indices.push_back(GLushort(corners * i + c));
  }
  for (int i = 0; i < slices; ++i)
    arrays.commands.insert(arrays.commands.end(), {GLuint(corners), 1, GLuint(corners * i), 0});
  for (int i = 0; i < slices; ++i)
    arrays.commands.insert(arrays.commands.end(), {GLuint(corners), 1, GLuint(corners * i), 0, 0});
  return arrays;
}

struct Way {
  const char* name;
  std::function<void(GlApplication&, const SliceArrays&)> draw;
  bool only_buffers = false;
};

std::vector<Way> ways() {
  return {
      {"glMultiDrawArrays",
       [](GlApplication& app, const SliceArrays& a) {
         app.gl().MultiDrawArrays(GL_TRIANGLE_FAN, a.first.data(), a.count.data(), slices);
       }},
      {"glMultiDrawElements",
       [](GlApplication& app, const SliceArrays& a) {
         app.gl().MultiDrawElements(GL_TRIANGLE_FAN, a.count.data(), GL_UNSIGNED_SHORT, a.own.data(), slices);
       }},
      {"glMultiDrawElementsBaseVertex",
       [](GlApplication& app, const SliceArrays& a) {
         app.gl().MultiDrawElementsBaseVertex(GL_TRIANGLE_FAN, a.count.data(), GL_UNSIGNED_SHORT,
                                              a.of_first.data(), slices, a.base.data());
       }},
      {"glMultiDrawArraysIndirect",
       [](GlApplication& app, const SliceArrays& a) {
         app.gl().MultiDrawArraysIndirect(GL_TRIANGLE_FAN, a.indirect_arrays, slices, 0);
       },
       true},
      {"glMultiDrawElementsIndirect",
       [](GlApplication& app, const SliceArrays& a) {
         app.gl().MultiDrawElementsIndirect(GL_TRIANGLE_FAN, GL_UNSIGNED_SHORT, a.indirect_elements, slices, 0);
       },
       true},
      {"glDrawArraysIndirect",
       [](GlApplication& app, const SliceArrays& a) {
         for (std::size_t i = 0; i < slices; ++i)
           app.gl().DrawArraysIndirect(
               GL_TRIANGLE_FAN,
               reinterpret_cast<const void*>(reinterpret_cast<std::uintptr_t>(a.indirect_arrays) +
                                             i * 4 * sizeof(GLuint)));
       },
       true},
      {"two glMultiDrawElements",
       [](GlApplication& app, const SliceArrays& a) {
         constexpr int half = slices / 2;
         app.gl().MultiDrawElements(GL_TRIANGLE_FAN, a.count.data(), GL_UNSIGNED_SHORT, a.own.data(), half);
         app.gl().MultiDrawElements(GL_TRIANGLE_FAN, a.count.data() + half, GL_UNSIGNED_SHORT,
                                    a.own.data() + half, slices - half);
       }},
      {"glDrawElementsBaseVertex",
       [](GlApplication& app, const SliceArrays& a) {
         for (std::size_t i = 0; i < slices; ++i)
           app.gl().DrawElementsBaseVertex(GL_TRIANGLE_FAN, corners, GL_UNSIGNED_SHORT, a.of_first[i],
                                           a.base[i]);
       }},
      {"glDrawRangeElementsBaseVertex",
       [](GlApplication& app, const SliceArrays& a) {
         for (std::size_t i = 0; i < slices; ++i)
           app.gl().DrawRangeElementsBaseVertex(GL_TRIANGLE_FAN, 0, corners - 1, corners, GL_UNSIGNED_SHORT,
                                                a.of_first[i], a.base[i]);
       }},
      {"glDrawArraysInstanced",
       [](GlApplication& app, const SliceArrays&) {
         app.gl().DrawArraysInstanced(GL_TRIANGLE_FAN, 0, corners, slices);
       },
       true},
      {"glDrawElementsInstanced",
       [](GlApplication& app, const SliceArrays& a) {
         app.gl().DrawElementsInstanced(GL_TRIANGLE_FAN, corners, GL_UNSIGNED_SHORT, a.of_first[0], slices);
       },
       true},
      {"glDrawElementsInstancedBaseVertex",
       [](GlApplication& app, const SliceArrays& a) {
         app.gl().DrawElementsInstancedBaseVertex(GL_TRIANGLE_FAN, corners, GL_UNSIGNED_SHORT, a.own[1], slices,
                                                  -corners);
       },
       true},
  };
}

/// Slices of one volume, from buffers (core profile) or from memory (compatibility profile).
class Slices {
 public:
  explicit Slices(bool in_memory)
      : app(GlApplication::start(in_memory ? Profile::compatibility : Profile::core)), arrays_(slice_arrays()) {
    if (!app) return;
    const DispatchTable& gl = app->gl();
    const char* vertices =
        "#version 330\n"
        "in vec3 corner; out vec3 place; uniform vec2 turn;\n"
        "void main() {\n"
        "  place = corner; place.z += float(gl_InstanceID) / 40.0;\n"
        "  vec3 p = place - 0.5;\n"
        "  gl_Position = vec4(turn.x * p.x + turn.y * p.z, p.y, turn.y * p.x - turn.x * p.z, 1.0);\n"
        "}\n";
    const char* fragments =
        "#version 330\n"
        "uniform sampler3D field; in vec3 place; out vec4 colour;\n"
        "void main() { float s = texture(field, place).r; colour = vec4(s, 1.0 - s, 0.4, 0.2 * s * s); }\n";
    program_ = glsl_program(gl, vertices, fragments);
    const Blob blob;
    GLuint texture = 0;
    gl.GenTextures(1, &texture);
    gl.BindTexture(GL_TEXTURE_3D, texture);
    gl.TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
      gl.TexParameteri(GL_TEXTURE_3D, axis, GL_CLAMP_TO_EDGE);
    gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    gl.TexImage3D(GL_TEXTURE_3D, 0, GL_R8, blob.x, blob.y, blob.z, 0, GL_RED, GL_UNSIGNED_BYTE,
                  blob.texels().data());
    const auto* const base = reinterpret_cast<const std::byte*>(arrays_.indices.data());
    for (std::size_t i = 0; i < slices; ++i) {
      const std::size_t offset = i * corners * sizeof(GLushort);
      arrays_.own.push_back(in_memory ? base + offset : reinterpret_cast<const void*>(offset));
      arrays_.of_first.push_back(in_memory ? base : nullptr);
    }
    if (!in_memory) {
      GLuint array = 0;
      std::array<GLuint, 3> buffers{};
      gl.GenVertexArrays(1, &array);
      gl.BindVertexArray(array);
      gl.GenBuffers(3, buffers.data());
      gl.BindBuffer(GL_ARRAY_BUFFER, buffers[0]);
      gl.BufferData(GL_ARRAY_BUFFER, GLsizeiptr(arrays_.places.size() * sizeof(GLfloat)), arrays_.places.data(),
                    GL_STATIC_DRAW);
      gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffers[1]);
      gl.BufferData(GL_ELEMENT_ARRAY_BUFFER, GLsizeiptr(arrays_.indices.size() * sizeof(GLushort)),
                    arrays_.indices.data(), GL_STATIC_DRAW);
      gl.BindBuffer(GL_DRAW_INDIRECT_BUFFER, buffers[2]);
      gl.BufferData(GL_DRAW_INDIRECT_BUFFER, GLsizeiptr(arrays_.commands.size() * sizeof(GLuint)),
                    arrays_.commands.data(), GL_STATIC_DRAW);
    }
    gl.EnableVertexAttribArray(0);
    arrays_.indirect_elements = reinterpret_cast<const void*>(4 * slices * sizeof(GLuint));
    gl.VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, in_memory ? arrays_.places.data() : nullptr);
  }

  std::vector<float> frame(const Way& way, bool under, double angle, bool multiply_alpha = true) {
    app->use_chain(under);
    app->gl().Viewport(0, 0, GlApplication::size, GlApplication::size);
    app->gl().ClearColor(0.1F, 0.2F, 0.3F, 0);
    app->gl().Clear(GL_COLOR_BUFFER_BIT);
    app->gl().Enable(GL_BLEND);
    app->gl().BlendFunc(multiply_alpha ? GL_SRC_ALPHA : GL_DST_COLOR, GL_ONE_MINUS_SRC_ALPHA);
    app->gl().UseProgram(program_);
    app->gl().Uniform2f(app->gl().GetUniformLocation(program_, "turn"), GLfloat(std::cos(angle)),
                        GLfloat(std::sin(angle)));
    way.draw(*app, arrays_);
    app->gl().Disable(GL_BLEND);
    app->end_frame();
    return app->read_pixels();
  }

  const SliceArrays& arrays() const { return arrays_; }

  std::unique_ptr<GlApplication> app;

 private:
  SliceArrays arrays_;
  GLuint program_ = 0;
};

TEST(MultiDraw, OfSlicesGivesTheApplicationsImage) {
  for (const bool in_memory : {false, true}) {
    for (const Way& way : ways()) {
      if (in_memory && way.only_buffers) continue;
      Slices slices(in_memory);
      if (!slices.app) GTEST_SKIP() << "no EGL context here; install libegl1 and libgl1-mesa-dri";
      const char* const where = in_memory ? "memory" : "buffers";
      for (const double angle : {0.2, -0.6}) {
        const auto before = slices.app->substituted();
        const auto under = slices.frame(way, true, angle);
        EXPECT_EQ(slices.app->substituted(), before + 1)
            << way.name << ", " << where << ": " << slices.app->last_reason();
        const auto bare = slices.frame(way, false, angle);
        EXPECT_GE(psnr(under, bare), 40) << way.name << ", " << where;
        EXPECT_EQ(slices.app->error(), GLenum(GL_NO_ERROR)) << way.name << ", " << where;
      }
      EXPECT_LT(psnr(slices.frame(way, false, 0.2), slices.frame(way, false, -0.6)), 35)
          << "the angle changes nothing: the test tests nothing";
    }
  }
}

TEST(MultiDraw, WithABlendingThatIsNotTakenOverIsLeftBitIdentical) {
  for (const bool in_memory : {false, true}) {
    for (const Way& way : ways()) {
      if (in_memory && way.only_buffers) continue;
      Slices slices(in_memory);
      if (!slices.app) GTEST_SKIP() << "no EGL context here";
      EXPECT_EQ(slices.frame(way, true, 0.3, false), slices.frame(way, false, 0.3, false)) << way.name;
      EXPECT_EQ(slices.app->substituted(), 0U) << way.name;
    }
  }
}

TEST(MultiDraw, RaisesTheApplicationsOwnErrors) {
  Slices slices(false);
  if (!slices.app) GTEST_SKIP() << "no EGL context here";
  const SliceArrays& a = slices.arrays();
  const Way good = ways().front();
  slices.frame(good, true, 0.3);
  for (const bool under : {true, false}) {
    const Way negative{"a negative number of draws", [&](GlApplication& app, const SliceArrays&) {
                         app.gl().MultiDrawArrays(GL_TRIANGLE_FAN, a.first.data(), a.count.data(), -1);
                       }};
    slices.frame(negative, under, 0.3);
    EXPECT_EQ(slices.app->error(), GLenum(GL_INVALID_VALUE)) << (under ? "under Understudy" : "bare");
    const Way no_indices{"indices of no type", [&](GlApplication& app, const SliceArrays&) {
                           app.gl().MultiDrawElements(GL_TRIANGLE_FAN, a.count.data(), GL_FLOAT, a.own.data(),
                                                      40);
                         }};
    slices.frame(no_indices, under, 0.3);
    EXPECT_EQ(slices.app->error(), GLenum(GL_INVALID_ENUM)) << (under ? "under Understudy" : "bare");
  }
}

}  // namespace
}  // namespace understudy::spu::testing
