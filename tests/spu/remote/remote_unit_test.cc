// SPDX-License-Identifier: Apache-2.0
// A chain whose calls are executed by a GL server in a separate process: the application must see what OpenGL
// answers there.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <numeric>
#include <set>
#include <string>

#include "spu/remote/remote.h"
#include "spu/report/counters.h"
#include "tests/spu/remote/remote_application.h"

namespace understudy::spu {
namespace {

class RemoteUnitTest : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_GE(application_.window.version, 210); }
  void TearDown() override {
    if (application_.installed() != nullptr && !link_->lost()) {
      EXPECT_EQ(gl().GetError(), GLenum(GL_NO_ERROR));
    }
  }

  Chain& make_context(bool core = false, std::uint64_t shares_with = 0) {
    return application_.make_context(core, shares_with);
  }
  static void swap() { staged::RemoteApplication::swap(); }
  static const DispatchTable& gl() { return *staged::RemoteApplication::installed(); }

  staged::RemoteApplication application_{"driver"};
  staged::OneWindow& window_ = application_.window;
  std::unique_ptr<launcher::ChildProcess>& server_ = application_.server;
  std::unique_ptr<ServerConnection>& link_ = application_.link;
};

TEST_F(RemoteUnitTest, TellsWhatTheGlServersOpenGLIs) {
  make_context();
  const auto* version = reinterpret_cast<const char*>(gl().GetString(GL_VERSION));
  ASSERT_NE(version, nullptr);
  EXPECT_GE(std::atof(version), 2.1) << version;
  EXPECT_EQ(gl().GetString(GL_VERSION), reinterpret_cast<const GLubyte*>(version));
  GLint size = 0;
  gl().GetIntegerv(GL_MAX_TEXTURE_SIZE, &size);
  EXPECT_GE(size, 1024);
  std::array<GLint, 4> viewport{};
  gl().GetIntegerv(GL_VIEWPORT, viewport.data());
  EXPECT_EQ(viewport, (std::array<GLint, 4>{0, 0, 64, 48}));
  std::array<GLfloat, 16> matrix{};
  gl().GetFloatv(GL_MODELVIEW_MATRIX, matrix.data());
  EXPECT_EQ(matrix[15], 1.F);
}

TEST_F(RemoteUnitTest, WhatIsAskedAgainDoesNotTravel) {
  make_context();
  GLint value = 0;
  gl().GetString(GL_RENDERER);
  gl().GetIntegerv(GL_MAX_TEXTURE_SIZE, &value);
  gl().GetError();
  const std::uint64_t before = process_counters().remote.round_trips;
  GLint again = 0;
  gl().GetString(GL_RENDERER);
  gl().GetIntegerv(GL_MAX_TEXTURE_SIZE, &again);
  gl().GetError();
  gl().GetIntegerv(GL_ARRAY_BUFFER_BINDING, &value);
  EXPECT_EQ(again > 0, true);
  EXPECT_EQ(process_counters().remote.round_trips, before);
}

TEST_F(RemoteUnitTest, ExtensionsComeAtOnce) {
  make_context();
  GLint count = 0;
  gl().GetIntegerv(GL_NUM_EXTENSIONS, &count);
  ASSERT_GT(count, 20);
  const std::uint64_t before = process_counters().remote.round_trips;
  std::set<std::string> extensions;
  for (GLint i = 0; i < count; ++i) {
    const GLubyte* name = gl().GetStringi(GL_EXTENSIONS, GLuint(i));
    ASSERT_NE(name, nullptr) << i;
    extensions.insert(reinterpret_cast<const char*>(name));
  }
  EXPECT_EQ(process_counters().remote.round_trips, before + 1);
  EXPECT_EQ(extensions.size(), std::size_t(count));
  EXPECT_TRUE(extensions.contains("GL_ARB_vertex_buffer_object"));
  EXPECT_EQ(gl().GetError(), GLenum(GL_NO_ERROR));
  EXPECT_EQ(gl().GetStringi(GL_EXTENSIONS, GLuint(count)), nullptr);
  EXPECT_EQ(gl().GetError(), GLenum(GL_INVALID_VALUE));
}

TEST_F(RemoteUnitTest, ErrorsComeWhenTheyAreAskedFor) {
  make_context();
  gl().Enable(GL_TEXTURE_MIN_FILTER);
  gl().Viewport(0, 0, 64, 48);
  EXPECT_EQ(gl().GetError(), GLenum(GL_INVALID_ENUM));
  EXPECT_EQ(gl().GetError(), GLenum(GL_NO_ERROR));
  EXPECT_EQ(gl().GetError(), GLenum(GL_NO_ERROR));
  gl().LineWidth(-1);
  EXPECT_EQ(gl().GetError(), GLenum(GL_INVALID_VALUE));
}

TEST_F(RemoteUnitTest, FramesComeBack) {
  make_context();
  gl().ClearColor(1, 0, 0, 1);
  gl().Clear(GL_COLOR_BUFFER_BIT);
  gl().Enable(GL_SCISSOR_TEST);
  gl().Scissor(0, 0, 10, 5);
  gl().ClearColor(0, 0, 1, 1);
  gl().Clear(GL_COLOR_BUFFER_BIT);
  swap();
  gl().Finish();
  ASSERT_EQ(window_.shown, 1);
  EXPECT_EQ(window_.image_extent, (Extent2D{64, 48}));
  EXPECT_EQ(window_.at(20, 2), (std::array<int, 3>{0, 0, 255}));
  EXPECT_EQ(window_.at(2, 45), (std::array<int, 3>{255, 0, 0}));
  EXPECT_EQ(window_.at(2, 2), (std::array<int, 3>{0, 0, 255}));
}

TEST_F(RemoteUnitTest, AWindowMayChangeItsSize) {
  make_context();
  gl().Clear(GL_COLOR_BUFFER_BIT);
  swap();
  window_.extent = {100, 30};
  gl().Viewport(0, 0, 100, 30);
  gl().ClearColor(0, 1, 0, 1);
  gl().Clear(GL_COLOR_BUFFER_BIT);
  swap();
  gl().Finish();
  EXPECT_EQ(window_.image_extent, (Extent2D{100, 30}));
  EXPECT_EQ(window_.at(99, 29), (std::array<int, 3>{0, 255, 0}));
}

TEST_F(RemoteUnitTest, AWindowWithoutPixelsKeepsWhatItShowed) {
  make_context();
  gl().ClearColor(0, 1, 0, 1);
  gl().Clear(GL_COLOR_BUFFER_BIT);
  swap();
  gl().Finish();
  const Extent2D shown = window_.image_extent;
  window_.extent = {0, 0};
  gl().Viewport(0, 0, 64, 48);
  swap();
  gl().Finish();
  EXPECT_FALSE(link_->lost());
  EXPECT_EQ(window_.image_extent, shown);
  EXPECT_EQ(window_.at(5, 5), (std::array<int, 3>{0, 255, 0}));
  window_.extent = {100, 30};
  gl().Viewport(0, 0, 100, 30);
  gl().ClearColor(1, 0, 0, 1);
  gl().Clear(GL_COLOR_BUFFER_BIT);
  swap();
  gl().Finish();
  EXPECT_EQ(window_.at(99, 29), (std::array<int, 3>{0, 0, 255}));
}

TEST_F(RemoteUnitTest, PixelsLieWhereThePixelStoreSays) {
  make_context();
  GLuint texture = 0;
  gl().GenTextures(1, &texture);
  ASSERT_NE(texture, 0U);
  gl().BindTexture(GL_TEXTURE_2D, texture);
  EXPECT_TRUE(gl().IsTexture(texture));
  std::vector<std::uint8_t> texels(7 * 5 * 3);
  std::iota(texels.begin(), texels.end(), std::uint8_t(0));
  gl().PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  gl().TexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, 7, 5, 0, GL_RGB, GL_UNSIGNED_BYTE, texels.data());
  gl().PixelStorei(GL_PACK_ALIGNMENT, 8);
  gl().PixelStorei(GL_PACK_ROW_LENGTH, 9);
  gl().PixelStorei(GL_PACK_SKIP_PIXELS, 1);
  gl().PixelStorei(GL_PACK_SKIP_ROWS, 2);
  const std::size_t step = 32;
  std::vector<std::uint8_t> read(step * 7, 0xee);
  gl().GetTexImage(GL_TEXTURE_2D, 0, GL_RGB, GL_UNSIGNED_BYTE, read.data());
  for (std::size_t y = 0; y < 5; ++y) {
    EXPECT_EQ(std::memcmp(read.data() + (y + 2) * step + 3, texels.data() + y * 21, 21), 0) << "row " << y;
    EXPECT_EQ(read[(y + 2) * step + 2], 0xee);
  }
  gl().ClearColor(0, 1, 0, 1);
  gl().Clear(GL_COLOR_BUFFER_BIT);
  std::vector<std::uint8_t> seen(step * 7, 0xee);
  gl().ReadPixels(3, 3, 2, 1, GL_RGB, GL_UNSIGNED_BYTE, seen.data());
  EXPECT_EQ(seen[2 * step + 4], 255);
  EXPECT_EQ(seen[2 * step + 3 + 6], 0xee);
}

TEST_F(RemoteUnitTest, MemoryOfMappedBuffersIsTheApplications) {
  make_context();
  GLuint buffer = 0;
  gl().GenBuffers(1, &buffer);
  gl().BindBuffer(GL_ARRAY_BUFFER, buffer);
  std::vector<std::uint8_t> data(1000);
  std::iota(data.begin(), data.end(), std::uint8_t(0));
  gl().BufferData(GL_ARRAY_BUFFER, 1000, data.data(), GL_STATIC_DRAW);
  auto* mapped = static_cast<std::uint8_t*>(gl().MapBuffer(GL_ARRAY_BUFFER, GL_READ_WRITE));
  ASSERT_NE(mapped, nullptr);
  EXPECT_EQ(std::memcmp(mapped, data.data(), data.size()), 0);
  void* asked = nullptr;
  gl().GetBufferPointerv(GL_ARRAY_BUFFER, GL_BUFFER_MAP_POINTER, &asked);
  EXPECT_EQ(asked, mapped);
  mapped[17] = 99;
  EXPECT_TRUE(gl().UnmapBuffer(GL_ARRAY_BUFFER));
  data[17] = 99;
  auto* part = static_cast<std::uint8_t*>(
      gl().MapBufferRange(GL_ARRAY_BUFFER, 100, 50, GL_MAP_WRITE_BIT | GL_MAP_FLUSH_EXPLICIT_BIT));
  ASSERT_NE(part, nullptr);
  part[10] = 77;
  part[30] = 78;
  gl().FlushMappedBufferRange(GL_ARRAY_BUFFER, 8, 8);
  EXPECT_TRUE(gl().UnmapBuffer(GL_ARRAY_BUFFER));
  data[110] = 77;
  std::vector<std::uint8_t> read(1000);
  gl().GetBufferSubData(GL_ARRAY_BUFFER, 0, 1000, read.data());
  EXPECT_EQ(read[110], 77);
  EXPECT_EQ(read[130], data[130]) << "not flushed, so it may stay away";
  EXPECT_EQ(read, data);
  EXPECT_EQ(gl().MapBuffer(GL_ARRAY_BUFFER, GL_TEXTURE_2D), nullptr);
  EXPECT_EQ(gl().GetError(), GLenum(GL_INVALID_ENUM));
}

/// Mapped persistently, as far as the GL server's OpenGL supports that.
std::uint8_t* map_persistently(const DispatchTable& gl, GLenum target, GLsizeiptr bytes, GLbitfield access) {
  access |= GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
  gl.BufferStorage(target, bytes, nullptr, access);
  return static_cast<std::uint8_t*>(gl.MapBufferRange(target, 0, bytes, access));
}

TEST_F(RemoteUnitTest, MappingsEndWithTheStorageOfTheirBuffer) {
  make_context();
  std::array<GLuint, 2> buffers{};
  gl().GenBuffers(2, buffers.data());
  // Freed at once if it were the application's, so that a read crashes.
  constexpr GLsizeiptr much = GLsizeiptr(4) << 20;
  for (const GLuint buffer : buffers) {
    gl().BindBuffer(GL_ARRAY_BUFFER, buffer);
    std::uint8_t* const mapped = map_persistently(gl(), GL_ARRAY_BUFFER, much, GL_MAP_WRITE_BIT);
    if (mapped == nullptr) GTEST_SKIP() << "no persistent mappings";
    mapped[5] = 1;
  }
  gl().DeleteBuffers(1, buffers.data());
  gl().DrawArrays(GL_POINTS, 0, 0);
  void* mapped = nullptr;
  gl().GetBufferPointerv(GL_ARRAY_BUFFER, GL_BUFFER_MAP_POINTER, &mapped);
  static_cast<std::uint8_t*>(mapped)[6] = 2;
  gl().DrawArrays(GL_POINTS, 0, 0);
  std::array<std::uint8_t, 2> read{};
  gl().GetBufferSubData(GL_ARRAY_BUFFER, 5, 2, read.data());
  EXPECT_EQ(read, (std::array<std::uint8_t, 2>{1, 2})) << "the other buffer is still mapped";

  GLuint orphan = 0;
  gl().GenBuffers(1, &orphan);
  gl().BindBuffer(GL_ARRAY_BUFFER, orphan);
  gl().BufferData(GL_ARRAY_BUFFER, much, nullptr, GL_STREAM_DRAW);
  EXPECT_NE(gl().MapBuffer(GL_ARRAY_BUFFER, GL_WRITE_ONLY), nullptr);
  gl().BufferData(GL_ARRAY_BUFFER, 16, nullptr, GL_STREAM_DRAW);
  auto* few = static_cast<std::uint8_t*>(gl().MapBuffer(GL_ARRAY_BUFFER, GL_WRITE_ONLY));
  ASSERT_NE(few, nullptr);
  std::fill_n(few, 16, std::uint8_t(7));
  EXPECT_TRUE(gl().UnmapBuffer(GL_ARRAY_BUFFER));
  gl().GetBufferSubData(GL_ARRAY_BUFFER, 14, 2, read.data());
  EXPECT_EQ(read, (std::array<std::uint8_t, 2>{7, 7}));
}

TEST_F(RemoteUnitTest, PersistentMappingsShowWhatOpenGLHasWritten) {
  make_context();
  GLuint buffer = 0;
  gl().GenBuffers(1, &buffer);
  gl().BindBuffer(GL_PIXEL_PACK_BUFFER, buffer);
  const std::uint8_t* const mapped =
      map_persistently(gl(), GL_PIXEL_PACK_BUFFER, 64, GL_MAP_READ_BIT | GL_MAP_WRITE_BIT);
  if (mapped == nullptr) GTEST_SKIP() << "no persistent mappings";
  const auto read_green = [&](GLfloat green) {
    gl().ClearColor(0, green, 0, 1);
    gl().Clear(GL_COLOR_BUFFER_BIT);
    gl().ReadPixels(0, 0, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
  };
  read_green(1);
  gl().Finish();
  EXPECT_EQ(mapped[1], 255);
  read_green(0);
  const GLsync fence = gl().FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
  EXPECT_NE(gl().ClientWaitSync(fence, GL_SYNC_FLUSH_COMMANDS_BIT, 1'000'000'000), GLenum(GL_TIMEOUT_EXPIRED));
  EXPECT_EQ(mapped[1], 0);
  read_green(1);
  const GLsync polled = gl().FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
  GLint status = GL_UNSIGNALED;
  while (status != GL_SIGNALED) gl().GetSynciv(polled, GL_SYNC_STATUS, 1, nullptr, &status);
  EXPECT_EQ(mapped[1], 255);
  gl().DeleteSync(fence);
  gl().DeleteSync(polled);
}

TEST_F(RemoteUnitTest, WritesIntoAPersistentMappingOutlastItsRefreshing) {
  make_context();
  GLuint buffer = 0;
  gl().GenBuffers(1, &buffer);
  gl().BindBuffer(GL_PIXEL_PACK_BUFFER, buffer);
  std::uint8_t* const mapped =
      map_persistently(gl(), GL_PIXEL_PACK_BUFFER, 64, GL_MAP_READ_BIT | GL_MAP_WRITE_BIT);
  if (mapped == nullptr) GTEST_SKIP() << "no persistent mappings";
  const GLsync fence = gl().FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
  mapped[20] = 9;
  gl().ClientWaitSync(fence, GL_SYNC_FLUSH_COMMANDS_BIT, 1'000'000'000);
  EXPECT_EQ(mapped[20], 9);
  std::uint8_t read = 0;
  gl().GetBufferSubData(GL_PIXEL_PACK_BUFFER, 20, 1, &read);
  EXPECT_EQ(read, 9);
  gl().DeleteSync(fence);
}

TEST_F(RemoteUnitTest, ArraysOfEveryCommandTravelWithTheDraw) {
  make_context();
  const std::array<float, 8> corners = {-1, -1, 1, -1, 1, 1, -1, 1};
  const std::array<float, 20> interleaved = {0, 0, 1, -1, -1, 0, 0, 1, 1, -1, 0, 0, 1, 1, 1, 0, 0, 1, -1, 1};
  const std::array<float, 12> green = {0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0};
  const auto pixel_after_draw = [&] {
    gl().Clear(GL_COLOR_BUFFER_BIT);
    gl().DrawArrays(GL_QUADS, 0, 4);
    std::array<std::uint8_t, 3> pixel{};
    gl().PixelStorei(GL_PACK_ALIGNMENT, 1);
    gl().ReadPixels(30, 20, 1, 1, GL_RGB, GL_UNSIGNED_BYTE, pixel.data());
    return pixel;
  };
  gl().Color3f(1, 0, 0);
  gl().InterleavedArrays(GL_V2F, 0, corners.data());
  EXPECT_EQ(pixel_after_draw(), (std::array<std::uint8_t, 3>{255, 0, 0}));
  gl().InterleavedArrays(GL_C3F_V3F, 0, interleaved.data());
  gl().VertexPointerEXT(2, GL_FLOAT, 20, 4, &interleaved[3]);
  gl().ColorPointerEXT(3, GL_FLOAT, 20, 4, interleaved.data());
  EXPECT_EQ(pixel_after_draw(), (std::array<std::uint8_t, 3>{0, 0, 255}));
  gl().PushClientAttribDefaultEXT(GL_CLIENT_VERTEX_ARRAY_BIT);
  gl().EnableClientState(GL_VERTEX_ARRAY);
  gl().VertexPointer(2, GL_FLOAT, 0, corners.data());
  gl().Color3f(1, 1, 0);
  EXPECT_EQ(pixel_after_draw(), (std::array<std::uint8_t, 3>{255, 255, 0}));
  gl().PopClientAttrib();
  gl().ColorPointerEXT(3, GL_FLOAT, 0, 4, green.data());
  EXPECT_EQ(pixel_after_draw(), (std::array<std::uint8_t, 3>{0, 255, 0}));
}

TEST_F(RemoteUnitTest, ArraysInTheApplicationsMemoryTravelWithTheDraw) {
  make_context();
  gl().ClearColor(0, 0, 0, 1);
  gl().Clear(GL_COLOR_BUFFER_BIT);
  std::vector<float> corners = {-1, -1, 1, -1, 1, 1, -1, 1};
  const std::array<std::uint16_t, 6> indices = {0, 1, 2, 0, 2, 3};
  gl().EnableClientState(GL_VERTEX_ARRAY);
  gl().VertexPointer(2, GL_FLOAT, 0, corners.data());
  gl().Color3f(1, 1, 0);
  gl().DrawElements(GL_TRIANGLES, 6, GL_UNSIGNED_SHORT, indices.data());
  std::fill(corners.begin(), corners.end(), 0.F);
  std::array<std::uint8_t, 4> pixel{};
  gl().ReadPixels(30, 20, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, pixel.data());
  EXPECT_EQ(pixel, (std::array<std::uint8_t, 4>{255, 255, 0, 255}));
}

TEST_F(RemoteUnitTest, ShadersTellAboutThemselves) {
  make_context(/*core=*/true);
  const GLuint vertex = gl().CreateShader(GL_VERTEX_SHADER);
  const GLuint fragment = gl().CreateShader(GL_FRAGMENT_SHADER);
  const char* vertex_text = "#version 150\nin vec4 place; void main() { gl_Position = place; }";
  const char* fragment_text =
      "#version 150\nuniform vec4 tint; uniform float more[3]; out vec4 c; void main() { c = tint * more[1]; }";
  gl().ShaderSource(vertex, 1, &vertex_text, nullptr);
  gl().ShaderSource(fragment, 1, &fragment_text, nullptr);
  const GLuint program = gl().CreateProgram();
  for (const GLuint shader : {vertex, fragment}) {
    gl().CompileShader(shader);
    GLint compiled = 0;
    gl().GetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
    EXPECT_EQ(compiled, GL_TRUE);
    gl().AttachShader(program, shader);
  }
  gl().LinkProgram(program);
  GLint linked = 0;
  gl().GetProgramiv(program, GL_LINK_STATUS, &linked);
  EXPECT_EQ(linked, GL_TRUE);
  gl().UseProgram(program);
  const GLint tint = gl().GetUniformLocation(program, "tint");
  ASSERT_GE(tint, 0);
  EXPECT_EQ(gl().GetUniformLocation(program, "nothing"), -1);
  gl().Uniform4f(tint, 1, 2, 3, 4);
  std::array<GLfloat, 4> values{};
  gl().GetUniformfv(program, tint, values.data());
  EXPECT_EQ(values, (std::array<GLfloat, 4>{1, 2, 3, 4}));
  GLint uniforms = 0;
  gl().GetProgramiv(program, GL_ACTIVE_UNIFORMS, &uniforms);
  ASSERT_EQ(uniforms, 2);
  std::array<char, 20> name{};
  GLsizei length = 0;
  GLint size = 0;
  GLenum type = 0;
  gl().GetActiveUniform(program, GLuint(gl().GetUniformLocation(program, "tint") == 0 ? 1 : 0), 20, &length,
                        &size, &type, name.data());
  EXPECT_GT(length, 0);
  EXPECT_EQ(std::strlen(name.data()), std::size_t(length));
  std::array<char, 200> source{};
  gl().GetShaderSource(vertex, 200, &length, source.data());
  EXPECT_STREQ(source.data(), vertex_text);
}

TEST_F(RemoteUnitTest, SyncObjectsAreNamesHere) {
  make_context();
  const GLsync fence = gl().FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
  ASSERT_NE(fence, nullptr);
  EXPECT_TRUE(gl().IsSync(fence));
  const GLenum reached = gl().ClientWaitSync(fence, GL_SYNC_FLUSH_COMMANDS_BIT, 1'000'000'000);
  EXPECT_TRUE(reached == GL_ALREADY_SIGNALED || reached == GL_CONDITION_SATISFIED) << reached;
  gl().DeleteSync(fence);
}

TEST_F(RemoteUnitTest, FeedbackComesBack) {
  make_context();
  std::array<GLfloat, 64> feedback{};
  gl().FeedbackBuffer(64, GL_2D, feedback.data());
  gl().RenderMode(GL_FEEDBACK);
  gl().Begin(GL_POINTS);
  gl().Vertex2f(0, 0);
  gl().End();
  EXPECT_EQ(gl().RenderMode(GL_RENDER), 3);
  EXPECT_EQ(feedback[0], GLfloat(GL_POINT_TOKEN));
  EXPECT_EQ(feedback[1], 32.F);
  EXPECT_EQ(feedback[2], 24.F);
}

TEST_F(RemoteUnitTest, ContextsShareWhatTheyShare) {
  Chain& first = make_context();
  GLuint texture = 0;
  gl().GenTextures(1, &texture);
  gl().BindTexture(GL_TEXTURE_2D, texture);
  gl().TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, 2, 2, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
  first.settle();
  Chain::release_current();
  make_context(false, 1);
  EXPECT_TRUE(gl().IsTexture(texture));
  Chain::current()->settle();
  Chain::release_current();
  make_context();
  EXPECT_FALSE(gl().IsTexture(texture));
}

TEST_F(RemoteUnitTest, AGlServerThatEndsIsNoticed) {
  make_context();
  GLint value = 0;
  gl().GetIntegerv(GL_MAX_TEXTURE_SIZE, &value);
  testing::internal::CaptureStderr();
  server_->signal(SIGTERM);
  server_->end(5000);
  // Whatever was in transit, the second reply cannot arrive.
  for (int i = 0; i < 2; ++i) {
    gl().Clear(GL_COLOR_BUFFER_BIT);
    gl().Finish();
    swap();
  }
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_TRUE(link_->lost());
  EXPECT_EQ(gl().GetString(GL_VENDOR), nullptr);
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
  EXPECT_NE(said.find("the GL server, which draws for this program"), std::string::npos) << said;
  GLuint available = GL_FALSE;
  gl().GetQueryObjectuiv(1, GL_QUERY_RESULT_AVAILABLE, &available);
  EXPECT_EQ(available, GLuint(GL_TRUE)) << "or the application polls forever";
  EXPECT_EQ(gl().ClientWaitSync(nullptr, 0, 0), GLenum(GL_ALREADY_SIGNALED));
  EXPECT_EQ(gl().GetGraphicsResetStatusARB(), GLenum(GL_UNKNOWN_CONTEXT_RESET));
  EXPECT_EQ(gl().GetError(), GLenum(GL_NO_ERROR));
}

}  // namespace
}  // namespace understudy::spu
