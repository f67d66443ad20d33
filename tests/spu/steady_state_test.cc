// SPDX-License-Identifier: Apache-2.0
// In steady state the chain and its units allocate no memory in a call. This program's malloc is the one below,
// which counts.
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "spu/registry/assemble.h"
#include "spu/stream/plain_calls.h"
#include "spu/track/share_group.h"
#include "tests/spu/mock_driver.h"

namespace {

constinit thread_local bool counting = false;
constinit thread_local std::size_t allocations = 0;

void note() {
  if (counting) ++allocations;
}

}  // namespace

// glibc's own names for its functions, intended for programs that replace malloc.
// NOLINTBEGIN(bugprone-reserved-identifier)
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);

[[gnu::visibility("default")]] void* malloc(std::size_t size) {
  note();
  return __libc_malloc(size);
}
[[gnu::visibility("default")]] void* calloc(std::size_t count, std::size_t size) {
  note();
  return __libc_calloc(count, size);
}
[[gnu::visibility("default")]] void* realloc(void* memory, std::size_t size) {
  note();
  return __libc_realloc(memory, size);
}
}
// NOLINTEND(bugprone-reserved-identifier)

namespace understudy::spu {
namespace {

using testing::install;
using testing::installed;

template <class Action>
std::size_t allocations_of(Action action) {
  allocations = 0;
  counting = true;
  action();
  counting = false;
  return allocations;
}

/// Calls that applications make in every frame, including calls that `track` overrides.
void draw_frame(const DispatchTable& gl) {
  static constexpr std::array<GLfloat, 16> matrix{};
  static constexpr std::array<GLubyte, 64> texels{};
  gl.Clear(GL_COLOR_BUFFER_BIT);
  gl.LoadMatrixf(matrix.data());
  gl.BindTexture(GL_TEXTURE_2D, 3);
  gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 4, 4, GL_RGBA, GL_UNSIGNED_BYTE, texels.data());
  gl.Uniform1f(2, 0.5F);
  gl.Begin(GL_TRIANGLES);
  for (int i = 0; i < 300; ++i) {
    gl.Normal3f(0, 0, 1);
    gl.Vertex3f(float(i), 0, 0);
  }
  gl.End();
  gl.DrawArrays(GL_TRIANGLES, 0, 3);
  gl.CallList(1);
}

void end_frame(Chain& chain) {
  chain.settle();
  chain.frame_ended(FrameEnd::swap);
}

class SteadyState : public ::testing::TestWithParam<const char*> {};

TEST_P(SteadyState, AllocatesNothing) {
  testing::MockDriver mock;
  mock.only_count();
  // track queries which texture is bound.
  mock.slots().GetIntegerv = [](GLenum, GLint* value) { *value = 3; };
  Chain chain(mock.table(), std::make_shared<ShareGroup>(), install);
  ASSERT_EQ(assemble(chain, GetParam(), nullptr).value_or(""), "");
  chain.make_current();
  for (int frame = 0; frame < 2; ++frame) {
    draw_frame(installed());
    end_frame(chain);
  }
  const std::uint64_t before = mock.counted();
  EXPECT_EQ(allocations_of([&] {
              for (int frame = 0; frame < 10; ++frame) {
                draw_frame(installed());
                end_frame(chain);
              }
            }),
            0U);
  EXPECT_GE(mock.counted() - before, 6000U) << "the calls arrive";
}

INSTANTIATE_TEST_SUITE_P(Chain, SteadyState,
                         ::testing::Values("driver", "track driver", "pass pass pass track driver",
                                           "perf track driver", "track perf driver"));

// The volume unit keeps every frame's slices as records.
TEST(Records, AllocateNothingOnceTheyHaveRoom) {
  testing::MockDriver mock;
  mock.only_count();
  Records records;
  const auto frame = [&] {
    records.clear();
    constexpr std::array<GLfloat, 3> coordinate{0.5F, 0.25F, 0.125F};
    for (int i = 0; i < 3000; ++i) {
      append_call(records, &DispatchTable::TexCoord3fv, coordinate.data());
      append_call(records, &DispatchTable::Vertex3f, float(i), 0.0F, 0.0F);
    }
    make_plain_calls(records.words(), mock.table());
  };
  frame();
  const std::uint64_t before = mock.counted();
  EXPECT_EQ(allocations_of([&] {
              for (int i = 0; i < 10; ++i) frame();
            }),
            0U);
  EXPECT_EQ(mock.counted() - before, 60000U) << "the calls arrive";
}

// Checks the counting: an allocation is noticed.
TEST(Allocations, AreSeen) {
  std::unique_ptr<std::vector<int>> kept;
  EXPECT_GE(allocations_of([&] { kept = std::make_unique<std::vector<int>>(1000); }), 2U);
}

}  // namespace
}  // namespace understudy::spu
