// SPDX-License-Identifier: Apache-2.0
// Our own errors stay apart from the application's.
#include "spu/volume/context/kept_errors.h"

#include <gtest/gtest.h>

#include <vector>

namespace understudy::spu::testing {
namespace {

std::vector<GLenum> queue;

GLenum APIENTRY next_error() {
  if (queue.empty()) return GL_NO_ERROR;
  const GLenum error = queue.front();
  queue.erase(queue.begin());
  return error;
}

class KeptErrorsTest : public ::testing::Test {
 protected:
  KeptErrorsTest() {
    queue.clear();
    gl_.GetError = next_error;
  }

  DispatchTable gl_{};
  KeptErrors kept_;
};

TEST_F(KeptErrorsTest, ReturnWhatTheApplicationHadRaised) {
  queue = {GL_INVALID_ENUM, GL_INVALID_VALUE};
  {
    const OwnErrors own(gl_, kept_);
    EXPECT_TRUE(queue.empty());
    queue = {GL_INVALID_OPERATION};
  }
  EXPECT_TRUE(queue.empty());
  EXPECT_EQ(kept_.take(), GLenum(GL_INVALID_ENUM));
  EXPECT_EQ(kept_.take(), GLenum(GL_INVALID_VALUE));
  EXPECT_EQ(kept_.take(), GLenum(GL_NO_ERROR));
}

TEST_F(KeptErrorsTest, AreNotOursIfNested) {
  {
    const OwnErrors outer(gl_, kept_);
    queue = {GL_INVALID_OPERATION};
    const OwnErrors inner(gl_, kept_);
  }
  EXPECT_EQ(kept_.take(), GLenum(GL_NO_ERROR));
}

TEST_F(KeptErrorsTest, AreKeptOnceEach) {
  for (int i = 0; i < 2; ++i) {
    queue = {GL_INVALID_ENUM};
    const OwnErrors own(gl_, kept_);
  }
  EXPECT_EQ(kept_.take(), GLenum(GL_INVALID_ENUM));
  EXPECT_EQ(kept_.take(), GLenum(GL_NO_ERROR));
}

TEST_F(KeptErrorsTest, EndForALostContext) {
  gl_.GetError = []() -> GLenum { return GL_CONTEXT_LOST; };
  EXPECT_EQ(take_error(gl_), GLenum(GL_CONTEXT_LOST));
}

}  // namespace
}  // namespace understudy::spu::testing
