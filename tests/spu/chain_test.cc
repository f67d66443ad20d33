// SPDX-License-Identifier: Apache-2.0
#include "spu/chain.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <new>
#include <stdexcept>

#include "dispatch/call_id.h"
#include "spu/lost_context.h"
#include "spu/pass/pass.h"
#include "spu/registry/assemble.h"
#include "spu/track/calls.h"
#include "spu/track/share_group.h"
#include "tests/spu/mock_driver.h"

namespace understudy::spu {
namespace {

using ::testing::ElementsAre;
using testing::install;
using testing::installed;
using testing::MockDriver;

constexpr std::array phases = {Phase::plain, Phase::watching, Phase::deferring, Phase::depth_deferred,
                               Phase::compiling};

int unit_clears = 0;

class CountsClears final : public Unit {
 public:
  static constexpr char tag = 'c';
  const char* tag_address() const override { return &tag; }
  void fill(Phase phase, DispatchTable& table) override {
    if (phase == Phase::watching) table.Clear = clear;
  }
  static void APIENTRY clear(GLbitfield mask) {
    ++unit_clears;
    Chain* chain = Chain::current();
    chain->below(*chain->find<CountsClears>()).Clear(mask);
  }
};

/// Overrides glFinish in all phases.
class OverridesFinish final : public Unit {
 public:
  static constexpr char tag = 'f';
  const char* tag_address() const override { return &tag; }
  void fill(Phase, DispatchTable& table) override { table.Finish = finish; }
  static void APIENTRY finish() {}
};

/// Makes a call in its destructor.
class CallsWhenItGoes final : public Unit {
 public:
  explicit CallsWhenItGoes(Chain& chain) : chain_(chain) {}
  ~CallsWhenItGoes() override { below_->Clear(GL_DEPTH_BUFFER_BIT); }
  static constexpr char tag = 'g';
  const char* tag_address() const override { return &tag; }
  void fill(Phase, DispatchTable&) override {}
  void made_current() override { below_ = &chain_.below(*this, Phase::watching); }

 private:
  Chain& chain_;
  const DispatchTable* below_ = nullptr;
};

/// glClear and glCreateShader throw; give_up() makes the call that is held back, a glFlush.
class Fails final : public Unit {
 public:
  static constexpr char tag = '!';
  const char* tag_address() const override { return &tag; }
  void fill(Phase, DispatchTable& table) override {
    table.Clear = [](GLbitfield) { throw std::bad_alloc(); };
    table.CreateShader = [](GLenum type) -> GLuint {
      Chain* chain = Chain::current();
      const GLuint shader = chain->below(*chain->find<Fails>()).CreateShader(type);
      chain->after_call([] { throw std::runtime_error("no room for a shader"); });
      return shader;
    };
  }
  void settle() override { ++told; }
  void frame_ended(FrameEnd) override { ++told; }
  void left() override { throw std::bad_alloc(); }
  void give_up() override {
    ++given_up;
    Chain* chain = Chain::current();
    chain->below(*this).Flush();
  }
  int given_up = 0;
  int told = 0;
};

void APIENTRY another_clear(GLbitfield) {}
void APIENTRY third_clear(GLbitfield) {}
void APIENTRY another_finish() {}

template <class T>
T& add(Chain& chain) {
  auto unit = std::make_unique<T>();
  T& reference = *unit;
  chain.add(std::move(unit));
  return reference;
}

class ChainTest : public ::testing::Test {
 protected:
  MockDriver mock_;
  Chain chain_{mock_.table(), std::make_shared<ShareGroup>(), install};
};

TEST_F(ChainTest, WhatTheApplicationCallsIsTheDriversPointerWhereNobodyOverridesIt) {
  add<CountsClears>(chain_);
  for (std::size_t i = 0; i < call_count; ++i) {
    const AnyFunction guarded = slot(chain_.guarded_head(Phase::watching), CallId(i));
    if (CallId(i) == CallId::Clear) {
      EXPECT_NE(guarded, slot(chain_.head(Phase::watching), CallId(i))) << "nothing stands around the unit";
    } else {
      ASSERT_EQ(guarded, slot(mock_.table(), CallId(i))) << call_name(CallId(i));
    }
  }
}

TEST_F(ChainTest, UnitsThatGoCallTheDriverAndNoOtherUnit) {
  {
    Chain chain(mock_.table(), std::make_shared<ShareGroup>(), install);
    chain.add<CallsWhenItGoes>();
    add<CountsClears>(chain);
    chain.make_current();
    Chain::release_current();
  }
  EXPECT_THAT(mock_.called(), ElementsAre(CallId::Clear));
}

TEST_F(ChainTest, IsGivenUpWhereAUnitThrowsAndTheCallIsMadeByTheDriver) {
  const Fails& unit = add<Fails>(chain_);
  chain_.make_current();
  installed().Clear(GL_COLOR_BUFFER_BIT);
  EXPECT_THAT(mock_.called(), ElementsAre(CallId::Flush, CallId::Clear)) << "what was held back, then the call";
  EXPECT_TRUE(chain_.given_up());
  EXPECT_EQ(&installed(), &mock_.table());
  chain_.settle();
  chain_.frame_ended(FrameEnd::swap);
  chain_.set_phase(Phase::watching);
  installed().Clear(GL_COLOR_BUFFER_BIT);
  EXPECT_EQ(unit.given_up, 1);
  EXPECT_EQ(unit.told, 0);
  EXPECT_EQ(&installed(), &mock_.table()) << "for good";
  Chain::release_current();
  chain_.make_current();
  EXPECT_EQ(&installed(), &mock_.table());
  Chain::release_current();
}

TEST_F(ChainTest, MakesNoCallTwiceWhereTheWorkAfterItFails) {
  add<Fails>(chain_);
  chain_.make_current();
  installed().CreateShader(GL_VERTEX_SHADER);
  EXPECT_THAT(mock_.called(), ElementsAre(CallId::CreateShader, CallId::Flush));
  EXPECT_TRUE(chain_.given_up());
  Chain::release_current();
}

TEST_F(ChainTest, ReplacedSlotsAreGuardedToo) {
  const Fails& unit = add<Fails>(chain_);
  chain_.make_current();
  chain_.replace_slot(unit, &DispatchTable::Finish, [] { throw std::bad_alloc(); });
  installed().Finish();
  EXPECT_THAT(mock_.called(), ElementsAre(CallId::Flush, CallId::Finish));
  Chain::release_current();
}

TEST_F(ChainTest, WithoutADriverTheContextIsLost) {
  // The chain only tests whether there is a GL server.
  auto* const server = reinterpret_cast<ServerConnection*>(&mock_);
  Chain chain(mock_.table(), std::make_shared<ShareGroup>(), install, {1, 0, server});
  add<Fails>(chain);
  chain.make_current();
  installed().Clear(GL_COLOR_BUFFER_BIT);
  EXPECT_EQ(installed().GetError(), GLenum(GL_OUT_OF_MEMORY));
  EXPECT_EQ(installed().GetError(), GLenum(GL_NO_ERROR));
  EXPECT_EQ(installed().GetGraphicsResetStatus(), GLenum(GL_UNKNOWN_CONTEXT_RESET));
  EXPECT_EQ(installed().CreateShader(GL_VERTEX_SHADER), 0U);
  EXPECT_THAT(mock_.called(), ElementsAre(CallId::Flush));
  Chain::release_current();
}

TEST(LostContext, AnswersWhatApplicationsPollFor) {
  const DispatchTable& gl = lost_context();
  GLuint available = 0;
  gl.GetQueryObjectuiv(1, GL_QUERY_RESULT_AVAILABLE, &available);
  EXPECT_EQ(available, GLuint(GL_TRUE));
  std::array<GLuint64, 2> available64{0, 7};
  gl.GetQueryObjectui64v(1, GL_QUERY_RESULT_AVAILABLE, available64.data());
  EXPECT_EQ(available64, (std::array<GLuint64, 2>{GL_TRUE, 7}));
  gl.GetQueryObjectuiv(1, GL_QUERY_RESULT_AVAILABLE, reinterpret_cast<GLuint*>(8));  // in a query buffer
  GLuint result = 7;
  gl.GetQueryObjectuiv(1, GL_QUERY_RESULT, &result);
  EXPECT_EQ(result, 7U) << "there is none";
  EXPECT_EQ(gl.ClientWaitSync(nullptr, 0, 0), GLenum(GL_ALREADY_SIGNALED));
  GLsizei length = 0;
  GLint status = 0;
  const auto fence = reinterpret_cast<GLsync>(1);
  gl.GetSynciv(fence, GL_SYNC_STATUS, 1, &length, &status);
  EXPECT_EQ(length, 1);
  EXPECT_EQ(status, GL_SIGNALED);
  gl.GetSynciv(fence, GL_SYNC_STATUS, 1, nullptr, &status);
  GLint complete = 0;
  gl.GetProgramiv(1, GL_COMPLETION_STATUS_KHR, &complete);
  EXPECT_EQ(complete, GL_TRUE);
  EXPECT_EQ(gl.GetGraphicsResetStatusARB(), GLenum(GL_UNKNOWN_CONTEXT_RESET));
}

TEST_F(ChainTest, ASlotThatNobodyOverridesIsTheDriversPointer) {
  add<CountsClears>(chain_);
  for (std::size_t i = 0; i < call_count; ++i) {
    ASSERT_EQ(slot(chain_.head(Phase::plain), CallId(i)), slot(mock_.table(), CallId(i)))
        << call_name(CallId(i));
    if (CallId(i) == CallId::Clear) continue;
    ASSERT_EQ(slot(chain_.head(Phase::watching), CallId(i)), slot(mock_.table(), CallId(i)))
        << call_name(CallId(i));
  }
}

// Units without overrides cost nothing in any number: the application calls the driver's own functions.
TEST_F(ChainTest, PassingUnitsLeaveTheDriversPointersToTheApplication) {
  Chain tracked(mock_.table(), std::make_shared<ShareGroup>(), install);
  ASSERT_EQ(assemble(tracked, "track driver", nullptr).value_or(""), "");
  ASSERT_EQ(assemble(chain_, "pass pass pass track driver", nullptr).value_or(""), "");
  for (const Phase phase : phases) {
    std::size_t drivers_own = 0;
    for (std::size_t i = 0; i < call_count; ++i) {
      ASSERT_EQ(slot(chain_.head(phase), CallId(i)), slot(tracked.head(phase), CallId(i)))
          << call_name(CallId(i));
      if (slot(chain_.head(phase), CallId(i)) == slot(mock_.table(), CallId(i))) ++drivers_own;
    }
    std::printf("phase %d: %zu of %zu slots are the driver's\n", int(phase), drivers_own, call_count);
    if (phase != Phase::compiling) {
      EXPECT_GT(drivers_own, call_count * 9 / 10);
    }
  }
  for (const CallId call : {CallId::Vertex3f, CallId::Uniform1f, CallId::DrawArrays, CallId::PointSize}) {
    EXPECT_EQ(slot(chain_.head(Phase::plain), call), slot(mock_.table(), call)) << call_name(call);
  }
}

TEST_F(ChainTest, APhaseChangesWhatTheApplicationCalls) {
  add<CountsClears>(chain_);
  chain_.make_current();
  unit_clears = 0;
  installed().Clear(0);
  EXPECT_EQ(mock_.count(CallId::Clear), 1U);
  EXPECT_EQ(unit_clears, 0);
  chain_.set_phase(Phase::watching);
  installed().Clear(0);
  EXPECT_EQ(mock_.count(CallId::Clear), 2U);
  EXPECT_EQ(unit_clears, 1);
}

TEST_F(ChainTest, WithoutUnitsTheDriverIsTheChain) {
  chain_.make_current();
  EXPECT_EQ(&installed(), &mock_.table());
  Chain::release_current();
  EXPECT_EQ(Chain::current(), nullptr);
}

TEST_F(ChainTest, WhatTheDriverLacksStaysLacking) {
  mock_.lacks(CallId::Clear);
  mock_.lacks(CallId::TexImage3DEXT);
  ASSERT_EQ(assemble(chain_, "print perf track null driver", nullptr).value_or(""), "");
  for (const Phase phase : phases) {
    EXPECT_EQ(chain_.head(phase).Clear, nullptr);
    EXPECT_EQ(chain_.head(phase).TexImage3DEXT, nullptr);
    EXPECT_NE(chain_.head(phase).Finish, nullptr);
  }
}

TEST_F(ChainTest, AReplacedSlotIsSeenByAllWhoInheritedIt) {
  add<Pass>(chain_);
  Unit& middle = add<Pass>(chain_);
  Unit& low = add<Pass>(chain_);
  chain_.make_current();
  const DispatchTable& head = installed();
  // Some phases are built before the change, the others after it.
  chain_.head(Phase::watching);
  chain_.replace_slot(middle, &DispatchTable::Clear, another_clear);
  EXPECT_EQ(&installed(), &head) << "the table stays where it is";
  for (const Phase phase : phases) {
    EXPECT_EQ(chain_.head(phase).Clear, another_clear) << int(phase);
    EXPECT_EQ(chain_.face(middle, phase).Clear, another_clear) << int(phase);
    EXPECT_EQ(chain_.face(low, phase).Clear, mock_.table().Clear) << "units below are not concerned";
    EXPECT_EQ(chain_.head(phase).Finish, mock_.table().Finish) << "nor are other slots";
  }
  chain_.replace_slot(middle, &DispatchTable::Clear, third_clear);
  for (const Phase phase : phases) EXPECT_EQ(chain_.head(phase).Clear, third_clear);
  chain_.restore_slot(middle, CallId::Clear);
  for (const Phase phase : phases) EXPECT_EQ(chain_.head(phase).Clear, mock_.table().Clear);
  chain_.restore_slot(middle, CallId::Clear);
  EXPECT_EQ(head.Clear, mock_.table().Clear) << "what is not replaced is not restored";
}

TEST_F(ChainTest, AnOverridingUnitHidesAReplacedSlot) {
  Unit& top = add<Pass>(chain_);
  Unit& overriding = add<OverridesFinish>(chain_);
  Unit& low = add<Pass>(chain_);
  chain_.make_current();
  chain_.replace_slot(low, &DispatchTable::Finish, another_finish);
  for (const Phase phase : phases) {
    EXPECT_EQ(chain_.face(top, phase).Finish, OverridesFinish::finish);
    EXPECT_EQ(chain_.below(overriding, phase).Finish, another_finish) << "and calls the new one itself";
  }
  chain_.replace_slot(overriding, &DispatchTable::Finish, another_finish);
  EXPECT_EQ(chain_.head(chain_.phase()).Finish, another_finish);
  chain_.restore_slot(overriding, CallId::Finish);
  for (const Phase phase : phases) EXPECT_EQ(chain_.face(top, phase).Finish, OverridesFinish::finish);
}

// Two units may replace and restore the same slot in any order.
TEST_F(ChainTest, ARestoredSlotInheritsWhatIsBelowByThen) {
  Unit& high = add<Pass>(chain_);
  Unit& low = add<Pass>(chain_);
  chain_.make_current();
  chain_.replace_slot(high, &DispatchTable::Clear, another_clear);
  chain_.replace_slot(low, &DispatchTable::Clear, third_clear);
  EXPECT_EQ(chain_.head(chain_.phase()).Clear, another_clear);
  chain_.restore_slot(high, CallId::Clear);
  for (const Phase phase : phases) EXPECT_EQ(chain_.head(phase).Clear, third_clear);
  chain_.restore_slot(low, CallId::Clear);
  for (const Phase phase : phases) EXPECT_EQ(chain_.head(phase).Clear, mock_.table().Clear);
}

/// Overrides glFlush while `wants` is set.
class FlushesAtTimes final : public Unit {
 public:
  static constexpr char tag = 'l';
  const char* tag_address() const override { return &tag; }
  void fill(Phase, DispatchTable& table) override {
    if (wants) table.Flush = another_finish;
  }
  bool wants = false;
};

TEST_F(ChainTest, UnitsMayFillTheirSlotsAnew) {
  add<Pass>(chain_);
  auto& at_times = add<FlushesAtTimes>(chain_);
  chain_.make_current();
  const DispatchTable& head = chain_.head(chain_.phase());
  chain_.replace_slot(at_times, &DispatchTable::Clear, another_clear);
  at_times.wants = true;
  chain_.refill();
  EXPECT_EQ(head.Flush, another_finish);
  EXPECT_EQ(head.Clear, another_clear) << "replaced slots stay replaced";
  at_times.wants = false;
  chain_.refill();
  EXPECT_EQ(head.Flush, mock_.table().Flush);
  chain_.restore_slot(at_times, CallId::Clear);
  EXPECT_EQ(head.Clear, mock_.table().Clear);
}

TEST_F(ChainTest, NullDiscardsEveryCall) {
  ASSERT_EQ(assemble(chain_, "null driver", nullptr).value_or(""), "");
  chain_.make_current();
  GLuint name = 77;
  installed().GenTextures(1, &name);
  EXPECT_EQ(name, 77U);
  EXPECT_EQ(installed().GetError(), 0U);
  EXPECT_EQ(installed().GetString(GL_VERSION), nullptr);
  EXPECT_EQ(installed().MapBuffer(GL_ARRAY_BUFFER, GL_READ_ONLY), nullptr);
  installed().Vertex3f(1, 2, 3);
  for (const Phase phase : phases) {
    for (std::size_t i = 0; i < call_count; ++i) {
      ASSERT_NE(slot(chain_.head(phase), CallId(i)), slot(mock_.table(), CallId(i))) << call_name(CallId(i));
    }
  }
  EXPECT_THAT(mock_.called(), ElementsAre());
}

TEST(Calls, AreToldApartByName) {
  EXPECT_EQ(kind_of(CallId::Vertex3f), CallKind::vertex);
  EXPECT_EQ(kind_of(CallId::TexCoord3fv), CallKind::vertex);
  EXPECT_EQ(kind_of(CallId::VertexAttrib4f), CallKind::vertex);
  EXPECT_EQ(kind_of(CallId::VertexPointer), CallKind::not_compiled);
  EXPECT_EQ(kind_of(CallId::Begin), CallKind::draw);
  EXPECT_EQ(kind_of(CallId::DrawArrays), CallKind::draw);
  EXPECT_EQ(kind_of(CallId::TexSubImage3D), CallKind::bound_texture);
  EXPECT_EQ(texture_dimensions(CallId::TexSubImage3D), 3);
  EXPECT_EQ(texture_dimensions(CallId::TexImage1D), 1);
  EXPECT_EQ(kind_of(CallId::TextureSubImage3D), CallKind::unknown_texture);
  EXPECT_EQ(kind_of(CallId::LoadMatrixf), CallKind::other);
  EXPECT_EQ(kind_of(CallId::BlendFunc), CallKind::other);
  EXPECT_EQ(kind_of(CallId::ColorMask), CallKind::other);
  EXPECT_EQ(kind_of(CallId::ColorPointer), CallKind::not_compiled);
  EXPECT_EQ(kind_of(CallId::Color4ubv), CallKind::vertex);
}

}  // namespace
}  // namespace understudy::spu
