// SPDX-License-Identifier: Apache-2.0
// The track unit answers queries itself, and must return exactly what the driver would have returned. Tested
// above a real driver, after calls with arbitrary arguments.
#include "spu/track/answers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "dispatch/call_shape.h"
#include "dispatch/call_words.h"
#include "gl_application.h"
#include "spu/track/calls.h"
#include "spu/track/share_group.h"
#include "spu/track/state_topics.h"
#include "spu/track/track.h"
#include "tests/all_cases.h"

namespace understudy::spu::testing {
namespace {

using Random = std::mt19937;

const DispatchTable* installed = nullptr;
std::uint64_t asked = 0;
DispatchTable real{};

/// A chain with a context of its own: `gl()` is the track unit that answers queries, `real` the driver. Two
/// queries are counted when they reach the driver.
class AnswersAbove : public ::testing::TestWithParam<Profile> {
 protected:
  void SetUp() override {
    application_ = GlApplication::start(GetParam());
    if (!application_) GTEST_SKIP() << "no EGL context here";
    application_->use_chain(false);
    real = application_->driver();
    driver_ = real;
    driver_.GetIntegerv = [](GLenum name, GLint* to) {
      ++asked;
      real.GetIntegerv(name, to);
    };
    driver_.IsEnabled = [](GLenum name) {
      ++asked;
      return real.IsEnabled(name);
    };
    chain_ = std::make_unique<Chain>(driver_, std::make_shared<ShareGroup>(),
                                     [](const DispatchTable* table) { installed = table; });
    chain_->add<Track>(true);
    chain_->make_current();
    asked = 0;
  }
  void TearDown() override {
    if (!chain_) return;
    Chain::release_current();
    chain_.reset();
  }

  static const DispatchTable& gl() { return *installed; }
  static GLint integer(GLenum name, GLint before = -77) {
    GLint value = before;
    gl().GetIntegerv(name, &value);
    return value;
  }
  bool compatibility() const { return GetParam() == Profile::compatibility; }

  std::unique_ptr<GlApplication> application_;
  DispatchTable driver_{};
  std::unique_ptr<Chain> chain_;
};

TEST_P(AnswersAbove, AsksOnceUntilACallMayHaveChangedTheValue) {
  gl().Viewport(1, 2, 30, 40);
  std::array<GLint, 4> viewport{};
  for (int i = 0; i < 3; ++i) gl().GetIntegerv(GL_VIEWPORT, viewport.data());
  EXPECT_EQ(viewport, (std::array<GLint, 4>{1, 2, 30, 40}));
  EXPECT_EQ(asked, 1U);
  gl().BlendFunc(GL_ONE, GL_ONE);
  gl().GetIntegerv(GL_VIEWPORT, viewport.data());
  EXPECT_EQ(asked, 1U) << "glBlendFunc has nothing to do with the viewport";
  gl().Viewport(0, 0, 5, 6);
  gl().GetIntegerv(GL_VIEWPORT, viewport.data());
  EXPECT_EQ(viewport[2], 5);
  EXPECT_EQ(asked, 2U);
}

TEST_P(AnswersAbove, LimitsAreAskedOnce) {
  const GLint limit = integer(GL_MAX_TEXTURE_SIZE);
  EXPECT_GT(limit, 0);
  for (const GLenum target : {GL_TEXTURE_2D, GL_TEXTURE_3D}) gl().BindTexture(target, 0);
  GLuint texture = 0;
  gl().GenTextures(1, &texture);
  gl().DeleteTextures(1, &texture);
  EXPECT_EQ(integer(GL_MAX_TEXTURE_SIZE), limit);
  EXPECT_EQ(asked, 1U);
}

TEST_P(AnswersAbove, CapabilitiesThatAreOffAreKeptToo) {
  EXPECT_EQ(gl().IsEnabled(GL_DEPTH_TEST), GL_FALSE);
  EXPECT_EQ(gl().IsEnabled(GL_DEPTH_TEST), GL_FALSE);
  EXPECT_EQ(asked, 1U);
  gl().Enable(GL_DEPTH_TEST);
  EXPECT_EQ(gl().IsEnabled(GL_DEPTH_TEST), GL_TRUE);
  EXPECT_EQ(asked, 2U);
}

TEST_P(AnswersAbove, WhatTheDriverRefusesIsRefusedAgain) {
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(integer(GL_TRIANGLE_STRIP, 123), 123);
    EXPECT_EQ(gl().GetError(), GLenum(GL_INVALID_ENUM));
    EXPECT_EQ(gl().IsEnabled(GL_TRIANGLE_STRIP), GL_FALSE);
    EXPECT_EQ(gl().GetError(), GLenum(GL_INVALID_ENUM));
  }
}

TEST_P(AnswersAbove, BetweenBeginAndEndThereIsNoAnswer) {
  if (!compatibility()) GTEST_SKIP() << "a core profile has no glBegin";
  EXPECT_EQ(integer(GL_DEPTH_FUNC), GL_LESS);
  gl().NewList(1, GL_COMPILE);
  gl().Begin(GL_TRIANGLES);
  gl().EndList();
  for (const bool by_list : {false, true}) {
    EXPECT_EQ(integer(GL_DEPTH_FUNC), GL_LESS);
    if (by_list) {
      gl().CallList(1);
    } else {
      gl().Begin(GL_TRIANGLES);
    }
    EXPECT_EQ(integer(GL_DEPTH_FUNC, 5), 5) << by_list;
    EXPECT_EQ(gl().IsEnabled(GL_DITHER), GL_FALSE) << by_list;
    gl().End();
    EXPECT_EQ(gl().GetError(), GLenum(GL_INVALID_OPERATION)) << by_list;
    EXPECT_EQ(integer(GL_DEPTH_FUNC), GL_LESS);
    EXPECT_EQ(gl().IsEnabled(GL_DITHER), GL_TRUE);
    EXPECT_EQ(gl().GetError(), GLenum(GL_NO_ERROR));
  }
}

TEST_P(AnswersAbove, ListsAndPoppedAttributesChangeAnything) {
  if (!compatibility()) GTEST_SKIP() << "a core profile has neither";
  gl().NewList(1, GL_COMPILE);
  gl().DepthFunc(GL_GEQUAL);
  gl().EndList();
  EXPECT_EQ(integer(GL_DEPTH_FUNC), GL_LESS);
  gl().PushAttrib(GL_ALL_ATTRIB_BITS);
  gl().CallList(1);
  EXPECT_EQ(integer(GL_DEPTH_FUNC), GL_GEQUAL);
  gl().PopAttrib();
  EXPECT_EQ(integer(GL_DEPTH_FUNC), GL_LESS);
}

TEST(Answers, AreAskedForOnRequestOnly) {
  DispatchTable driver{};
  driver.GetIntegerv = [](GLenum, GLint*) {};
  Chain chain(driver, std::make_shared<ShareGroup>(), [](const DispatchTable*) {});
  chain.add<Track>();
  EXPECT_EQ(chain.head(Phase::plain).GetIntegerv, driver.GetIntegerv);
}

/// Every name in the rows of the state table, and some limits.
std::vector<GLenum> all_names() {
  std::vector<GLenum> names = {GL_MAX_TEXTURE_SIZE, GL_MAX_VIEWPORT_DIMS, GL_SUBPIXEL_BITS, GL_MAJOR_VERSION};
  for (const StateRow& row : state_rows()) {
    for (const StateQuery& query : row.queries) {
      if (query.count > 0) names.push_back(query.name);
    }
  }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

template <class T, class Ask>
std::array<std::byte, 32 * sizeof(T)> answer_of(Ask ask) {
  std::array<std::byte, 32 * sizeof(T)> bytes{};
  bytes.fill(std::byte{0x42});
  ask(reinterpret_cast<T*>(bytes.data()));
  return bytes;
}

/// Queries every name on both sides, with the function that `way` selects, and compares all bytes that could be
/// written. Returns the first name that differs, or "".
std::string first_difference(const DispatchTable& gl, const DispatchTable& driver, unsigned way) {
  static const std::vector<GLenum> names = all_names();
  const auto same = [](auto ask_both) { return ask_both(0) == ask_both(1); };
  for (const GLenum name : names) {
    const auto tables = [&](int side) -> const DispatchTable& { return side == 0 ? gl : driver; };
    bool equal = tables(0).IsEnabled(name) == tables(1).IsEnabled(name);
    switch (way % 8) {
      case 0:
        equal &=
            same([&](int s) { return answer_of<GLint>([&](auto* v) { tables(s).GetIntegerv(name, v); }); });
        break;
      case 1:
        equal &=
            same([&](int s) { return answer_of<GLfloat>([&](auto* v) { tables(s).GetFloatv(name, v); }); });
        break;
      case 2:
        equal &=
            same([&](int s) { return answer_of<GLdouble>([&](auto* v) { tables(s).GetDoublev(name, v); }); });
        break;
      case 3:
        equal &=
            same([&](int s) { return answer_of<GLboolean>([&](auto* v) { tables(s).GetBooleanv(name, v); }); });
        break;
      case 4:
        equal &=
            same([&](int s) { return answer_of<GLint64>([&](auto* v) { tables(s).GetInteger64v(name, v); }); });
        break;
      default:
        for (GLuint i = 0; i < 2; ++i) {
          equal &= tables(0).IsEnabledi(name, i) == tables(1).IsEnabledi(name, i);
          equal &= same(
              [&](int s) { return answer_of<GLint>([&](auto* v) { tables(s).GetIntegeri_v(name, i, v); }); });
          equal &= same(
              [&](int s) { return answer_of<GLdouble>([&](auto* v) { tables(s).GetDoublei_v(name, i, v); }); });
        }
    }
    if (equal) continue;
    const char* text = enum_name(name, 0);
    return text != nullptr ? text : std::to_string(name);
  }
  return {};
}

/// False for calls that have effects outside OpenGL's state, that wait, or that need particular arguments.
bool can_be_made(CallId call) {
  const std::string_view name = call_name(call);
  constexpr std::array<std::string_view, 20> never = {
      "glBegin",    "Callback",    "Import",         "Semaphore",       "MemoryObject",
      "Win32",      "glDrawTex",   "glDrawElements", "glDrawRange",     "glDispatch",
      "glGet",      "PerfMonitor", "EGLImage",       "glDrawTransform", "glDrawMesh",
      "BindlessNV", "glDebug",     "glPushDebug",    "glObjectLabel",   "glArrayElement"};
  if (std::any_of(never.begin(), never.end(), [&](auto text) { return name.find(text) != name.npos; }))
    return false;
  if (kind_of(call) == CallKind::draw && !name.starts_with("glRect") && name != "glEnd") return false;
  const auto parameters = call_shape(call).parameters();
  return std::all_of(parameters.begin(), parameters.end(), [](const ParameterShape& parameter) {
    return parameter.pointer < 2 && parameter.type != ValueType::address &&
           parameter.rule != ExtentRule::text_or_counted && parameter.object != ObjectKind::sync;
  });
}

const std::vector<std::vector<GLenum>>& enumerants() {
  static const std::vector<std::vector<GLenum>> groups = [] {
    const auto range = [](GLenum first, GLenum last) {
      std::vector<GLenum> values;
      for (GLenum value = first; value <= last; ++value) values.push_back(value);
      return values;
    };
    return std::vector<std::vector<GLenum>>{
        all_names(),
        range(0, 10),
        range(GL_NEVER, GL_ALWAYS),
        range(GL_SRC_COLOR, GL_SRC_ALPHA_SATURATE),
        range(GL_FRONT_LEFT, GL_FRONT_AND_BACK),
        range(GL_CW, GL_CCW),
        range(GL_CLEAR, GL_SET),
        {GL_KEEP, GL_REPLACE, GL_INCR, GL_DECR},
        range(GL_MODELVIEW, GL_TEXTURE),
        range(GL_POINT, GL_FILL),
        range(GL_FLAT, GL_SMOOTH),
        range(GL_DONT_CARE, GL_NICEST),
        range(GL_TEXTURE0, GL_TEXTURE3),
        range(GL_FUNC_ADD, GL_FUNC_REVERSE_SUBTRACT),
        {GL_DRAW_FRAMEBUFFER, GL_READ_FRAMEBUFFER, GL_FRAMEBUFFER, GL_RENDERBUFFER, GL_COLOR_ATTACHMENT0,
         GL_DEPTH_ATTACHMENT},
        {GL_TEXTURE_1D, GL_TEXTURE_2D, GL_TEXTURE_3D, GL_TEXTURE_CUBE_MAP, GL_TEXTURE_RECTANGLE,
         GL_TEXTURE_2D_ARRAY},
        {GL_ARRAY_BUFFER, GL_ELEMENT_ARRAY_BUFFER, GL_PIXEL_PACK_BUFFER, GL_PIXEL_UNPACK_BUFFER,
         GL_UNIFORM_BUFFER, GL_COPY_READ_BUFFER},
        {GL_RGBA, GL_RED, GL_RGBA8, GL_DEPTH_COMPONENT, GL_UNSIGNED_BYTE, GL_FLOAT, GL_STATIC_DRAW},
        {GL_LOWER_LEFT, GL_UPPER_LEFT, GL_NEGATIVE_ONE_TO_ONE, GL_ZERO_TO_ONE, GL_FIRST_VERTEX_CONVENTION,
         GL_LAST_VERTEX_CONVENTION},
        {GL_LINEAR, GL_EXP, GL_EXP2, GL_FOG_COORD, GL_FRAGMENT_DEPTH, GL_AMBIENT, GL_DIFFUSE},
        {GL_VERTEX_ARRAY, GL_NORMAL_ARRAY, GL_COLOR_ARRAY, GL_TEXTURE_COORD_ARRAY},
    };
  }();
  return groups;
}

class AnyArguments {
 public:
  explicit AnyArguments(unsigned seed) : random_(seed), memory_(1U << 16U) {}

  const std::uint64_t* make(CallId call) {
    const std::string_view name = call_name(call);
    const bool takes_enumerants_as_integers =
        std::any_of(parameter_texts.begin(), parameter_texts.end(),
                    [&](std::string_view text) { return name.find(text) != name.npos; });
    words_.fill(0);
    std::size_t at = 0;
    for (const ParameterShape& parameter : call_shape(call).parameters()) {
      words_[at++] = parameter.pointer != 0 ? memory() : value(parameter.type, takes_enumerants_as_integers);
    }
    return words_.data();
  }

 private:
  static constexpr std::array<std::string_view, 6> parameter_texts = {"Parameter", "glTexEnv", "glFog",
                                                                      "glLightM",  "glTexGen", "glPixelT"};

  std::uint64_t memory() {
    // Floats, integers and names in turn; the last byte terminates any text.
    const bool floats = random_() % 2 == 0;
    for (std::size_t i = 0; i + 1 < memory_.size() / 4 && i < 64; ++i) {
      const float number = float(random_() % 9) / 4;
      const std::uint32_t small = random_() % 4;
      std::memcpy(&memory_[4 * i], floats ? static_cast<const void*>(&number) : &small, 4);
    }
    memory_.back() = std::byte{0};
    return word(memory_.data());
  }

  std::uint64_t value(ValueType type, bool enumerants_as_integers) {
    switch (type) {
      case ValueType::float32:
        return word(float(random_() % 33) / 8);
      case ValueType::float64:
        return word(double(random_() % 33) / 8);
      case ValueType::enumeration: {
        const auto& group = enumerants()[random_() % enumerants().size()];
        return group[random_() % group.size()];
      }
      case ValueType::bitfield:
        return random_() % 3 == 0 ? GL_ALL_ATTRIB_BITS : random_() % 64;
      case ValueType::boolean:
        return random_() % 2;
      case ValueType::int32:
        if (enumerants_as_integers && random_() % 2 == 0) return value(ValueType::enumeration, false);
        return random_() % 8;
      default:
        return random_() % 6;
    }
  }

  Random random_;
  std::vector<std::byte> memory_;
  std::array<std::uint64_t, max_parameters> words_{};
};

TEST_P(AnswersAbove, AreTheDriversAfterAnyCall) {
  std::vector<CallId> setters;
  std::vector<CallId> others;
  for (std::size_t i = 0; i < call_count; ++i) {
    const auto call = CallId(i);
    if (slot(real, call) == nullptr || !can_be_made(call)) continue;
    // Calls that invalidate everything cannot leave a wrong answer; others do not affect any value.
    const StateTopics topics = topics_changed_by(call);
    if (topics == topic::nothing) others.push_back(call);
    if (topics != topic::nothing && topics != topic::everything) setters.push_back(call);
  }
  for (const CallId call : {CallId::PopAttrib, CallId::PopClientAttrib, CallId::DeleteTextures,
                            CallId::DeleteBuffers, CallId::CallList}) {
    if (slot(real, call) != nullptr) setters.push_back(call);
  }
  ASSERT_GT(setters.size(), 200U);
  ASSERT_GT(others.size(), 200U);
  Random random(7);
  AnyArguments arguments(11);
  // Objects to bind: names 1 to 3 of every kind.
  std::array<GLuint, 3> names{};
  gl().GenTextures(3, names.data());
  gl().GenBuffers(3, names.data());
  gl().GenFramebuffers(3, names.data());
  gl().GenVertexArrays(3, names.data());
  const unsigned steps = takes_all_cases() ? 12000 : 3000;
  for (unsigned step = 0; step < steps; ++step) {
    const auto& calls = step % 3 == 0 ? others : setters;
    const CallId call = calls[random() % calls.size()];
    ASSERT_EQ(first_difference(gl(), real, step), "") << "before step " << step;
    invoke(gl(), call, arguments.make(call));
    ASSERT_EQ(first_difference(gl(), real, step), "") << "after " << call_name(call) << ", step " << step;
    // Leaves modes in which most commands are refused, and display lists in which they are not executed.
    if (step % 64 == 63) {
      if (compatibility()) {
        gl().End();
        gl().EndList();
        gl().RenderMode(GL_RENDER);
      }
      while (gl().GetError() != GL_NO_ERROR) {
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(, AnswersAbove, ::testing::Values(Profile::compatibility, Profile::core),
                         [](const auto& info) {
                           return info.param == Profile::core ? std::string("Core")
                                                              : std::string("Compatibility");
                         });

}  // namespace
}  // namespace understudy::spu::testing
