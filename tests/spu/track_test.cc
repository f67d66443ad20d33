// SPDX-License-Identifier: Apache-2.0
// The track unit above a driver that records its calls.
#include "spu/track/track.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "dispatch/call_id.h"
#include "dispatch/pass_through.h"
#include "spu/track/call_names.h"

namespace understudy::spu {
namespace {

using testing::ElementsAre;

const DispatchTable* installed = nullptr;
void install(const DispatchTable* table) {
  installed = table;
}

std::vector<std::string> calls;

template <auto Slot>
struct Nothing;
template <class Result, class... A, Result (APIENTRY* DispatchTable::*Slot)(A...)>
struct Nothing<Slot> {
  static Result APIENTRY call(A...) {
    if constexpr (!std::is_void_v<Result>) return Result(5);
  }
};

/// Commands that the tests use do nothing; all others are missing.
const DispatchTable& nothing() {
  static const DispatchTable table = [] {
    using Table = DispatchTable;
    DispatchTable filled{};
    filled.AttachShader = Nothing<&Table::AttachShader>::call;
    filled.BindTexture = Nothing<&Table::BindTexture>::call;
    filled.CallList = Nothing<&Table::CallList>::call;
    filled.CallLists = Nothing<&Table::CallLists>::call;
    filled.CompileShader = Nothing<&Table::CompileShader>::call;
    filled.CreateProgram = Nothing<&Table::CreateProgram>::call;
    filled.CreateShader = Nothing<&Table::CreateShader>::call;
    filled.DeleteTextures = Nothing<&Table::DeleteTextures>::call;
    filled.EndList = Nothing<&Table::EndList>::call;
    filled.FramebufferTexture2D = Nothing<&Table::FramebufferTexture2D>::call;
    filled.FramebufferTexture3DEXT = Nothing<&Table::FramebufferTexture3DEXT>::call;
    filled.LinkProgram = Nothing<&Table::LinkProgram>::call;
    filled.NamedFramebufferTextureLayer = Nothing<&Table::NamedFramebufferTextureLayer>::call;
    filled.NewList = Nothing<&Table::NewList>::call;
    filled.ShaderSource = Nothing<&Table::ShaderSource>::call;
    filled.TexImage3D = Nothing<&Table::TexImage3D>::call;
    filled.TexSubImage3D = Nothing<&Table::TexSubImage3D>::call;
    filled.Vertex2i = Nothing<&Table::Vertex2i>::call;
    return filled;
  }();
  return table;
}

struct WriteDown {
  static const DispatchTable& before(CallId call) {
    calls.emplace_back(call_name(call));
    return nothing();
  }
};

class TrackAlone : public testing::Test {
 protected:
  TrackAlone() : chain((PassThrough<WriteDown>::fill(driver), driver), group, install) {
    chain.add<Track>();
    chain.make_current();
    calls.clear();
  }

  static const DispatchTable& gl() { return *installed; }
  static void upload() {
    gl().TexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, 0, 1, 1, 1, GL_RED, GL_UNSIGNED_BYTE, "x");
  }
  static void define(GLenum target) {
    gl().TexImage3D(target, 0, GL_R8, 1, 1, 1, 0, GL_RED, GL_UNSIGNED_BYTE, "x");
  }

  DispatchTable driver{};
  std::shared_ptr<ShareGroup> group = std::make_shared<ShareGroup>();
  Chain chain;
};

TEST_F(TrackAlone, AsksTheDriverNothing) {
  const char* text = "void main() {}";
  const GLuint texture = 3;
  gl().BindTexture(GL_TEXTURE_3D, texture);
  define(GL_TEXTURE_3D);
  upload();
  gl().FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, 8, 0);
  const GLuint shader = gl().CreateShader(GL_FRAGMENT_SHADER);
  gl().ShaderSource(shader, 1, &text, nullptr);
  gl().CompileShader(shader);
  const GLuint program = gl().CreateProgram();
  gl().AttachShader(program, shader);
  gl().LinkProgram(program);
  gl().NewList(1, GL_COMPILE);
  gl().Vertex2i(1, 2);
  gl().EndList();
  gl().CallList(1);
  gl().DeleteTextures(1, &texture);
  EXPECT_THAT(calls, ElementsAre("glBindTexture", "glTexImage3D", "glTexSubImage3D", "glFramebufferTexture2D",
                                 "glCreateShader", "glShaderSource", "glCompileShader", "glCreateProgram",
                                 "glAttachShader", "glLinkProgram", "glNewList", "glVertex2i", "glEndList",
                                 "glCallList", "glDeleteTextures"));
}

TEST_F(TrackAlone, StartsTheWatchAtTheFirstVolume) {
  define(GL_PROXY_TEXTURE_3D);
  define(GL_TEXTURE_2D_ARRAY);
  EXPECT_EQ(chain.phase(), Phase::plain);
  EXPECT_FALSE(group->has_volumes());
  define(GL_TEXTURE_3D);
  EXPECT_EQ(chain.phase(), Phase::watching);
  EXPECT_TRUE(group->has_volumes());
}

TEST_F(TrackAlone, WatchesOnceAnotherContextHasAVolume) {
  const auto before = group->texture_version(3);
  upload();
  EXPECT_EQ(group->texture_version(3), before) << "nobody asks for it";
  EXPECT_EQ(chain.phase(), Phase::plain);
  group->volume_defined();
  upload();
  EXPECT_EQ(chain.phase(), Phase::watching) << "which texture it is can be asked below";
}

TEST_F(TrackAlone, KeepsProgramsThatAreLinkedWhileAListIsOpen) {
  const char* text = "text";
  gl().NewList(1, GL_COMPILE);
  const GLuint shader = gl().CreateShader(GL_FRAGMENT_SHADER);
  gl().ShaderSource(shader, 1, &text, nullptr);
  gl().CompileShader(shader);
  const GLuint program = gl().CreateProgram();
  gl().AttachShader(program, shader);
  gl().LinkProgram(program);
  gl().EndList();
  const auto record = group->programs().program(program);
  ASSERT_NE(record, nullptr);
  EXPECT_THAT(record->fragment_sources, ElementsAre("text"));
  EXPECT_TRUE(group->list(1)->only_geometry) << "nothing of that is in the list";
}

TEST_F(TrackAlone, SeesTexturesChangeByLists) {
  group->volume_defined();
  auto version = group->texture_version(3);
  const auto grows = [&](const char* what) {
    EXPECT_GT(group->texture_version(3), version) << what;
    version = group->texture_version(3);
  };
  gl().NewList(1, GL_COMPILE);
  upload();
  gl().EndList();
  EXPECT_EQ(group->texture_version(3), version) << "compiled, not executed";
  gl().CallList(1);
  grows("called");
  gl().CallLists(1, GL_UNSIGNED_BYTE, "\1");
  grows("called by its offset");
  gl().NewList(2, GL_COMPILE_AND_EXECUTE);
  upload();
  gl().EndList();
  grows("executed while it was compiled");
  gl().NewList(4, GL_COMPILE);
  gl().CallLists(1, GL_UNSIGNED_BYTE, "\1");
  gl().EndList();
  EXPECT_FALSE(group->list(4)->only_geometry);
  gl().CallList(4);
  grows("called by a list");
}

TEST_F(TrackAlone, OpensNoListThatTheDriverRefuses) {
  gl().NewList(0, GL_COMPILE);
  EXPECT_EQ(chain.phase(), Phase::plain);
  gl().NewList(1, GL_TRIANGLES);
  EXPECT_EQ(chain.phase(), Phase::plain);
}

TEST_F(TrackAlone, SeesTexturesAttachedInEveryWay) {
  gl().FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, 8, 0);
  gl().FramebufferTexture3DEXT(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_3D, 9, 0, 4);
  gl().NamedFramebufferTextureLayer(1, GL_COLOR_ATTACHMENT0, 10, 0, 4);
  for (const GLuint texture : {8U, 9U, 10U}) {
    EXPECT_TRUE(group->is_rendered_to(texture)) << texture;
    gl().DeleteTextures(1, &texture);
    EXPECT_FALSE(group->is_rendered_to(texture)) << texture;
  }
  gl().FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, 8, 0);
  EXPECT_TRUE(group->is_rendered_to(8)) << "the name has come again";
  gl().FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, 0, 0);
  EXPECT_FALSE(group->is_rendered_to(0));
}

TEST(CallNames, ChooseTheCallsOfTheirKinds) {
  for (std::size_t number = 0; number < call_count; ++number) {
    const auto call = CallId(number);
    const CallKind kind = kind_of(call);
    EXPECT_EQ(changes_texture(call_name(call)),
              kind == CallKind::bound_texture || kind == CallKind::unknown_texture)
        << call_name(call);
    EXPECT_EQ(is_draw(call_name(call)), kind == CallKind::draw) << call_name(call);
  }
}

}  // namespace
}  // namespace understudy::spu
