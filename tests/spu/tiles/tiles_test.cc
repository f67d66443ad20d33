// SPDX-License-Identifier: Apache-2.0
// With tile workers that draw tiles of its window, an application shows and reads exactly the same bytes as
// with one process that draws the whole window.
#include "spu/tiles/tiles.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "spu/report/counters.h"
#include "spu/report/report.h"
#include "tests/spu/remote/remote_application.h"

namespace understudy::spu {
namespace {

using staged::RemoteApplication;

constexpr int width = 96;
constexpr int height = 80;

/// What a run of an application shows and reads back.
struct Seen {
  std::vector<std::vector<std::uint8_t>> images;
  std::vector<std::vector<std::uint8_t>> read;
  std::vector<GLenum> errors;
  bool operator==(const Seen&) const = default;
};

/// An application that records what it sees.
class Application {
 public:
  Application(const std::string& chain, const std::filesystem::path& counters_folder,
              const std::function<void(staged::OneWindow&)>& before_context)
      : on_gl_server(chain, counters_folder) {
    on_gl_server.window.extent = {width, height};
    if (before_context) before_context(on_gl_server.window);
    on_gl_server.make_context();
  }

  const DispatchTable& gl() const { return *RemoteApplication::installed(); }
  void swap() {
    RemoteApplication::swap();
    gl().Finish();
    seen.images.push_back(on_gl_server.window.image);
  }
  void read(int x, int y, int columns, int rows, GLenum format, GLenum type, std::size_t pixel_bytes) {
    // Bytes that are not written must keep their value in both runs.
    std::vector<std::uint8_t> pixels(std::size_t(columns + 8) * std::size_t(rows + 8) * pixel_bytes, 77);
    gl().ReadPixels(x, y, columns, rows, format, type, pixels.data());
    seen.read.push_back(std::move(pixels));
  }
  void read_all() { read(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, 4); }
  void note_error() { seen.errors.push_back(gl().GetError()); }

  /// A fan of triangles of many colours, at crossing depths.
  void draw_fan(double turn) const {
    const DispatchTable& g = gl();
    g.Begin(GL_TRIANGLES);
    for (int i = 0; i < 12; ++i) {
      const double angle = turn + i * 0.55;
      g.Color3f(float(i % 3) / 2, float(i % 5) / 4, float(i % 7) / 6);
      g.Vertex3d(0.1, -0.05, std::sin(angle) * 0.5);
      g.Vertex3d(std::cos(angle), std::sin(angle), 0.4);
      g.Vertex3d(std::cos(angle + 0.9), std::sin(angle + 0.9), -0.4);
    }
    g.End();
  }
  void clear(float red, float green, float blue) const {
    gl().ClearColor(red, green, blue, 1);
    gl().Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT | GL_STENCIL_BUFFER_BIT);
  }
  /// Draws the bound texture over the window from -1 to `right`.
  void draw_textured(double right) const {
    const DispatchTable& g = gl();
    g.Enable(GL_TEXTURE_2D);
    g.Begin(GL_QUADS);
    for (const auto& [x, y] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
      g.TexCoord2d(x, y);
      g.Vertex2d(x == 0 ? -1 : right, y * 2 - 1);
    }
    g.End();
    g.Disable(GL_TEXTURE_2D);
  }
  void bind_texture(GLuint name) const {
    gl().BindTexture(GL_TEXTURE_2D, name);
    gl().TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl().TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  }
  /// Makes a framebuffer that draws into the texture, redefined as 64 x 64; both stay bound.
  GLuint bind_framebuffer_of(GLuint texture) const {
    const DispatchTable& g = gl();
    bind_texture(texture);
    g.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, 64, 64, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
    GLuint framebuffer = 0;
    g.GenFramebuffers(1, &framebuffer);
    g.BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    g.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture, 0);
    return framebuffer;
  }

  RemoteApplication on_gl_server;
  Seen seen;
  std::vector<std::vector<float>> depths;  ///< a copy may change them by one step of 2^-24
};

/// Frames drawn in tiles, and why the GL server under `run` gave tiles up, from its counters.
struct Counted {
  std::uint64_t frames = 0;
  std::string given_up;
};

class TilesTest : public ::testing::Test {
 protected:
  /// Plays `scene` without and with tile workers.
  Counted expect_same(const std::function<void(Application&)>& scene, int parts = 3) {
    Seen alone;
    std::vector<std::vector<float>> depths;
    {
      Application application("driver", {}, before_context_);
      scene(application);
      application.note_error();
      alone = application.seen;
      depths = application.depths;
    }
    EXPECT_FALSE(alone.images.empty() && alone.read.empty()) << "nothing is compared";
    for (const auto& image : alone.images)
      EXPECT_GT(std::set<std::uint8_t>(image.begin(), image.end()).size(), 1U) << "an empty image";
    Application application("tiles(of=" + std::to_string(parts) + ") driver", folder_.file(""),
                            before_context_);
    scene(application);
    application.note_error();
    EXPECT_EQ(application.seen.errors, alone.errors);
    EXPECT_EQ(application.seen.read.size(), alone.read.size());
    for (std::size_t i = 0; i < alone.read.size(); ++i)
      EXPECT_EQ(different(application.seen.read[i], alone.read[i]), 0U) << "bytes of what was read, " << i;
    for (std::size_t i = 0; i < depths.size(); ++i)
      EXPECT_THAT(application.depths[i],
                  ::testing::Pointwise(::testing::FloatNear(1.01F / 16777215), depths[i]));
    EXPECT_EQ(application.seen.images.size(), alone.images.size());
    for (std::size_t i = 0; i < alone.images.size(); ++i)
      EXPECT_EQ(different(application.seen.images[i], alone.images[i]), 0U) << "bytes of image " << i;
    return counted();
  }

  /// Expects all frames to be drawn in tiles.
  void expect_all_in_tiles(const std::function<void(Application&)>& scene, int parts = 3) {
    const Counted figures = expect_same(scene, parts);
    EXPECT_GT(figures.frames, 0U);
    EXPECT_EQ(figures.given_up, "");
  }

  static std::size_t different(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
    if (a.size() != b.size()) return std::max(a.size(), b.size());
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) count += a[i] != b[i] ? 1 : 0;
    return count;
  }

  /// Counters of the GL server's process for the application.
  Counted counted() const {
    for (const MappedCounters& counters : read_counters(folder_.file(""))) {
      if (counters->tiles.count == 0 && counters->tiles.given_up[0] == 0) continue;
      return {counters->tiles.frames.load(), std::string(counters->tiles.given_up)};
    }
    return {};
  }

  viewer_test::TemporaryFolder folder_;
  std::function<void(staged::OneWindow&)> before_context_;
};

TEST_F(TilesTest, PolygonsAtCrossingDepths) {
  expect_all_in_tiles([](Application& a) {
    a.gl().Enable(GL_DEPTH_TEST);
    for (int frame = 0; frame < 3; ++frame) {
      a.clear(0.1F, 0.2F, 0.3F);
      a.draw_fan(frame * 0.3);
      a.swap();
    }
  });
}

TEST_F(TilesTest, AsManyTilesAsThereMayBe) {
  expect_all_in_tiles(
      [](Application& a) {
        a.clear(0, 0, 1);
        a.draw_fan(0.2);
        a.swap();
      },
      most_tiles);
}

TEST_F(TilesTest, TheApplicationsScissorTest) {
  expect_all_in_tiles([](Application& a) {
    const DispatchTable& gl = a.gl();
    a.clear(0, 0, 1);
    gl.Enable(GL_SCISSOR_TEST);
    gl.Scissor(10, 20, 50, 35);
    a.clear(1, 0, 0);
    a.draw_fan(1);
    GLint box[4] = {};
    gl.GetIntegerv(GL_SCISSOR_BOX, box);
    a.seen.read.push_back({std::uint8_t(box[0]), std::uint8_t(box[1]), std::uint8_t(box[2]),
                           std::uint8_t(box[3]), gl.IsEnabled(GL_SCISSOR_TEST)});
    gl.PushAttrib(GL_SCISSOR_BIT);
    gl.Disable(GL_SCISSOR_TEST);
    a.draw_fan(2);
    gl.PopAttrib();
    gl.Scissor(0, 60, 96, 5);
    a.clear(1, 1, 0);
    a.swap();
  });
}

TEST_F(TilesTest, DisplayListsThatChangeTheScissorTest) {
  expect_all_in_tiles([](Application& a) {
    const DispatchTable& gl = a.gl();
    a.clear(0, 0, 1);
    gl.NewList(1, GL_COMPILE);
    a.draw_fan(0.7);
    gl.EndList();
    gl.CallList(1);
    a.swap();
    gl.NewList(2, GL_COMPILE);
    gl.Enable(GL_SCISSOR_TEST);
    gl.Scissor(30, 30, 20, 20);
    gl.CallList(1);
    gl.EndList();
    gl.CallList(2);
    a.clear(0, 1, 0);
    gl.CallList(1);
    a.swap();
    gl.NewList(3, GL_COMPILE_AND_EXECUTE);
    a.draw_fan(1.7);
    gl.EndList();
    a.swap();
  });
}

TEST_F(TilesTest, WhatIsReadIsOfAllTiles) {
  expect_all_in_tiles([](Application& a) {
    const DispatchTable& gl = a.gl();
    gl.Enable(GL_DEPTH_TEST);
    a.clear(0.1F, 0.2F, 0.3F);
    a.draw_fan(0.4);
    a.read_all();
    a.read(7, 11, 50, 43, GL_RGB, GL_UNSIGNED_BYTE, 3);
    a.read(0, 0, width, height, GL_DEPTH_COMPONENT, GL_FLOAT, 4);
    a.read(3, 60, 20, 20, GL_BGRA, GL_FLOAT, 16);
    // Partly outside the window, and in a corner of the application's memory.
    gl.PixelStorei(GL_PACK_ROW_LENGTH, width + 3);
    gl.PixelStorei(GL_PACK_SKIP_ROWS, 2);
    gl.PixelStorei(GL_PACK_SKIP_PIXELS, 1);
    a.read(10, 20, 40, 40, GL_RGBA, GL_UNSIGNED_BYTE, 4 * 4);
    // Nothing is written in this case.
    a.read(0, 0, 10, 10, GL_COLOR_INDEX, GL_UNSIGNED_BYTE, 4);
    a.note_error();
    a.swap();
  });
}

TEST_F(TilesTest, PixelsOfTheWindowInTextures) {
  expect_all_in_tiles([](Application& a) {
    const DispatchTable& gl = a.gl();
    a.clear(0.1F, 0.2F, 0.3F);
    a.draw_fan(0.4);
    a.bind_texture(5);
    gl.CopyTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA, 0, 0, 64, 64, 0);
    a.clear(0, 0, 0);
    a.draw_textured(0.5);
    gl.CopyTexSubImage2D(GL_TEXTURE_2D, 0, 8, 8, 20, 20, 40, 40);
    a.draw_textured(1);
    a.swap();
    a.read_all();
  });
}

TEST_F(TilesTest, PixelsThatAreCopiedWithinTheWindow) {
  expect_all_in_tiles([](Application& a) {
    const DispatchTable& gl = a.gl();
    a.clear(0.1F, 0.2F, 0.3F);
    a.draw_fan(0.4);
    gl.WindowPos2i(0, 40);
    gl.CopyPixels(0, 0, width, 35, GL_COLOR);
    a.swap();
    gl.BlitFramebuffer(0, 0, 30, 30, 40, 40, 90, 75, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    a.swap();
  });
}

TEST_F(TilesTest, PixelsOfTheWindowInABufferAndBack) {
  expect_all_in_tiles([](Application& a) {
    const DispatchTable& gl = a.gl();
    a.clear(0.1F, 0.2F, 0.3F);
    a.draw_fan(0.4);
    GLuint buffer = 0;
    gl.GenBuffers(1, &buffer);
    gl.BindBuffer(GL_PIXEL_PACK_BUFFER, buffer);
    gl.BufferData(GL_PIXEL_PACK_BUFFER, width * height * 4, nullptr, GL_STREAM_READ);
    gl.ReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
    gl.BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    a.clear(1, 1, 1);
    gl.BindBuffer(GL_PIXEL_UNPACK_BUFFER, buffer);
    gl.WindowPos2i(0, 0);
    gl.PixelZoom(0.5F, 1);
    gl.DrawPixels(width, height, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
    gl.BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    a.swap();
  });
}

TEST_F(TilesTest, DepthOfTheWindowInATexture) {
  expect_all_in_tiles([](Application& a) {
    const DispatchTable& gl = a.gl();
    gl.Enable(GL_DEPTH_TEST);
    a.clear(0.1F, 0.2F, 0.3F);
    a.draw_fan(0.4);
    a.bind_texture(5);
    gl.CopyTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT, 0, 0, 64, 64, 0);
    gl.Disable(GL_DEPTH_TEST);
    a.draw_textured(0.8);
    a.swap();
  });
}

TEST_F(TilesTest, FramebufferObjectsAndStencils) {
  expect_all_in_tiles([](Application& a) {
    const DispatchTable& gl = a.gl();
    const GLuint framebuffer = a.bind_framebuffer_of(9);
    a.clear(1, 0, 1);
    a.draw_fan(0.3);
    a.read(0, 0, 64, 64, GL_RGBA, GL_UNSIGNED_BYTE, 4);
    gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
    a.clear(0, 0, 0);
    gl.Enable(GL_STENCIL_TEST);
    gl.StencilFunc(GL_ALWAYS, 1, 1);
    gl.StencilOp(GL_REPLACE, GL_REPLACE, GL_REPLACE);
    a.draw_fan(0.9);
    gl.StencilFunc(GL_NOTEQUAL, 1, 1);
    a.draw_textured(0.9);
    gl.BindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer);
    gl.Disable(GL_STENCIL_TEST);
    gl.BlitFramebuffer(0, 0, 64, 64, 5, 5, 30, 70, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    gl.BindFramebuffer(GL_READ_FRAMEBUFFER, 0);
    a.swap();
  });
}

TEST_F(TilesTest, FramebufferObjectsThatAreClearedByName) {
  expect_all_in_tiles([](Application& a) {
    const DispatchTable& gl = a.gl();
    const GLuint framebuffer = a.bind_framebuffer_of(9);
    gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
    const std::array<float, 4> yellow = {1, 1, 0, 1};
    gl.ClearNamedFramebufferfv(framebuffer, GL_COLOR, 0, yellow.data());
    a.clear(0, 0, 0);
    a.draw_textured(0.9);
    a.swap();
  });
}

TEST_F(TilesTest, CopiesUnderTheScissorTest) {
  expect_all_in_tiles([](Application& a) {
    const DispatchTable& gl = a.gl();
    a.clear(0.1F, 0.2F, 0.3F);
    a.draw_fan(0.4);
    gl.Enable(GL_SCISSOR_TEST);
    gl.Scissor(5, 5, 60, 70);
    a.bind_texture(5);
    gl.CopyTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA, 0, 0, 64, 64, 0);
    a.seen.read.push_back({gl.IsEnabled(GL_SCISSOR_TEST), gl.IsEnabledi(GL_SCISSOR_TEST, 1)});
    a.clear(0, 0, 0);
    a.draw_textured(0.5);
    a.swap();
  });
}

TEST_F(TilesTest, ReadsThatAreLargerThanOneAnswer) {
  expect_all_in_tiles(
      [](Application& a) {
        a.on_gl_server.window.extent = {4096, 1200};
        a.gl().Viewport(0, 0, 4096, 1200);
        a.clear(0.1F, 0.2F, 0.3F);
        a.draw_fan(0.4);
        a.read(0, 0, 4096, 1200, GL_RGBA, GL_FLOAT, 16);
        a.swap();
      },
      2);
}

TEST_F(TilesTest, AWindowThatChangesItsSizeAndContextsThatShareLists) {
  expect_all_in_tiles([](Application& a) {
    a.clear(0, 0, 1);
    a.draw_fan(0.4);
    a.swap();
    a.on_gl_server.window.extent = {50, 33};
    a.gl().Viewport(0, 0, 50, 33);
    a.clear(0, 1, 1);
    a.draw_fan(0.4);
    a.swap();
    a.gl().NewList(7, GL_COMPILE);
    a.draw_fan(1.4);
    a.gl().EndList();
    a.on_gl_server.make_context(false, 1);
    a.clear(1, 1, 0);
    a.gl().CallList(7);
    a.swap();
  });
}

TEST_F(TilesTest, WhatStaysInTheWindowFromFrameToFrame) {
  expect_all_in_tiles([](Application& a) {
    a.clear(0, 0, 0);
    for (int frame = 0; frame < 4; ++frame) {
      a.draw_fan(frame * 0.6);
      a.swap();
    }
  });
}

TEST_F(TilesTest, VertexArraysInTheApplicationsMemoryAndMappedBuffers) {
  expect_all_in_tiles([](Application& a) {
    const DispatchTable& gl = a.gl();
    std::vector<float> corners = {-0.9F, -0.9F, 0.9F, -0.8F, 0.1F, 0.9F};
    a.clear(0, 0, 1);
    gl.EnableClientState(GL_VERTEX_ARRAY);
    gl.VertexPointer(2, GL_FLOAT, 0, corners.data());
    gl.Color3f(1, 1, 0);
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
    a.swap();
    GLuint buffer = 0;
    gl.GenBuffers(1, &buffer);
    gl.BindBuffer(GL_ARRAY_BUFFER, buffer);
    gl.BufferData(GL_ARRAY_BUFFER, GLsizeiptr(corners.size() * sizeof(float)), nullptr, GL_STATIC_DRAW);
    auto* mapped = static_cast<float*>(gl.MapBuffer(GL_ARRAY_BUFFER, GL_WRITE_ONLY));
    ASSERT_NE(mapped, nullptr);
    for (std::size_t i = 0; i < corners.size(); ++i) mapped[i] = -corners[i];
    gl.UnmapBuffer(GL_ARRAY_BUFFER);
    gl.VertexPointer(2, GL_FLOAT, 0, nullptr);
    gl.Color3f(0, 1, 0);
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
    a.swap();
  });
}

TEST_F(TilesTest, ProgramsWhoseLocationsAreAsked) {
  expect_all_in_tiles([](Application& a) {
    const DispatchTable& gl = a.gl();
    const char* text = "uniform vec4 colour; uniform float gain; void main() { gl_FragColor = colour * gain; }";
    const GLuint shader = gl.CreateShader(GL_FRAGMENT_SHADER);
    gl.ShaderSource(shader, 1, &text, nullptr);
    gl.CompileShader(shader);
    const GLuint program = gl.CreateProgram();
    gl.AttachShader(program, shader);
    gl.LinkProgram(program);
    gl.UseProgram(program);
    gl.Uniform1f(gl.GetUniformLocation(program, "gain"), 0.5F);
    gl.Uniform4f(gl.GetUniformLocation(program, "colour"), 1, 0.5F, 0.2F, 1);
    a.clear(0, 0, 1);
    a.draw_fan(0.2);
    gl.UseProgram(0);
    a.swap();
  });
}

TEST_F(TilesTest, AreGivenUpWhereFragmentsAreCounted) {
  const Counted figures = expect_same([](Application& a) {
    const DispatchTable& gl = a.gl();
    gl.Enable(GL_DEPTH_TEST);
    a.clear(0, 0, 1);
    a.draw_fan(0.3);
    a.swap();
    a.draw_fan(0.4);
    GLuint query = 0;
    gl.GenQueries(1, &query);
    gl.BeginQuery(GL_SAMPLES_PASSED, query);
    a.draw_fan(0.7);
    gl.EndQuery(GL_SAMPLES_PASSED);
    GLuint samples = 0;
    gl.GetQueryObjectuiv(query, GL_QUERY_RESULT, &samples);
    EXPECT_GT(samples, 100U);
    a.seen.read.push_back({std::uint8_t(samples), std::uint8_t(samples >> 8)});
    a.swap();
    // Drivers copy depth through floats, which may change its last bit.
    std::vector<float> depth(width * height);
    gl.ReadPixels(0, 0, width, height, GL_DEPTH_COMPONENT, GL_FLOAT, depth.data());
    a.depths.push_back(depth);
    a.draw_fan(0.9);
    a.swap();
  });
  EXPECT_EQ(figures.frames, 1U);
  EXPECT_THAT(figures.given_up, ::testing::HasSubstr("occlusion queries"));
}

TEST_F(TilesTest, AreGivenUpWhereTheWindowIsCopiedAllTheTime) {
  const Counted figures = expect_same([](Application& a) {
    a.bind_texture(5);
    for (int frame = 0; frame < 20; ++frame) {
      a.clear(0.1F, 0.2F, 0.3F);
      a.draw_fan(0.1 * frame);
      a.gl().CopyTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA, 0, 0, 64, 64, 0);
      a.draw_textured(-0.2);
      a.swap();
    }
  });
  EXPECT_EQ(figures.frames, 16U);
  EXPECT_THAT(figures.given_up, ::testing::HasSubstr("copies pixels"));
}

TEST_F(TilesTest, AreGivenUpWhereTheWindowIsReadIntoBuffersAllTheTime) {
  const Counted figures = expect_same([](Application& a) {
    const DispatchTable& gl = a.gl();
    GLuint buffer = 0;
    gl.GenBuffers(1, &buffer);
    gl.BindBuffer(GL_PIXEL_PACK_BUFFER, buffer);
    gl.BufferData(GL_PIXEL_PACK_BUFFER, width * height * 4, nullptr, GL_STREAM_READ);
    for (int frame = 0; frame < 18; ++frame) {
      a.clear(0.1F, 0.2F, 0.3F);
      a.draw_fan(0.1 * frame);
      gl.ReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
      a.swap();
    }
    std::vector<std::uint8_t> pixels(width * height * 4);
    gl.GetBufferSubData(GL_PIXEL_PACK_BUFFER, 0, GLsizeiptr(pixels.size()), pixels.data());
    a.seen.read.push_back(pixels);
  });
  EXPECT_EQ(figures.frames, 16U);
  EXPECT_THAT(figures.given_up, ::testing::HasSubstr("copies pixels"));
}

TEST_F(TilesTest, AWindowWithoutDepth) {
  before_context_ = [](staged::OneWindow& window) { window.depth = 0; };
  expect_all_in_tiles([](Application& a) {
    a.note_error();
    a.clear(0, 0, 1);
    a.draw_fan(0.3);
    a.bind_texture(5);
    a.gl().CopyTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA, 0, 0, 64, 64, 0);
    a.draw_textured(0);
    a.swap();
  });
}

TEST_F(TilesTest, AreGivenUpForTheAccumulationBuffer) {
  const Counted figures = expect_same([](Application& a) {
    const DispatchTable& gl = a.gl();
    a.clear(0, 0, 1);
    a.draw_fan(0.3);
    gl.Accum(GL_LOAD, 0.5F);
    a.draw_fan(0.9);
    gl.Accum(GL_ACCUM, 0.5F);
    gl.Accum(GL_RETURN, 1);
    a.swap();
  });
  EXPECT_THAT(figures.given_up, ::testing::HasSubstr("accumulation"));
}

TEST_F(TilesTest, ATileWorkerThatIsGoneIsDoneWithout) {
  Application a("tiles(of=2) driver", folder_.file(""), {});
  a.clear(0, 0, 1);
  a.draw_fan(0.3);
  a.swap();
  // The GL server's children are the process that plays for the application, and its tile worker.
  std::vector<pid_t> children;
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    std::ifstream status(entry.path() / "status");
    for (std::string line; std::getline(status, line);) {
      if (line == "PPid:\t" + std::to_string(a.on_gl_server.server->pid()))
        children.push_back(std::stoi(entry.path().filename()));
    }
  }
  ASSERT_EQ(children.size(), 2U);
  ::kill(std::max(children[0], children[1]), SIGKILL);
  for (int frame = 0; frame < 3; ++frame) {
    a.clear(1, 0, 0);
    a.swap();
  }
  EXPECT_FALSE(a.on_gl_server.link->lost());
  const std::vector<std::uint8_t>& last = a.seen.images.back();
  for (std::size_t i = 0; i < last.size(); i += 4) ASSERT_EQ(last[i + 2], 255) << "pixel " << i / 4;
  EXPECT_THAT(counted().given_up, ::testing::HasSubstr("lost"));
}

}  // namespace
}  // namespace understudy::spu
