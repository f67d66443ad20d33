// SPDX-License-Identifier: Apache-2.0
#include "interceptor/gl_names.h"

#include <gtest/gtest.h>

namespace {

using namespace understudy::interceptor;

const char* stub(const char* requested) {
  const int found = stub_for(requested);
  return found < 0 ? "" : stub_names[found];
}

TEST(GlNames, EverySpellingOfALibraryHasItsStub) {
  EXPECT_STREQ(stub("libGL.so.1"), "libGL.so.1");
  EXPECT_STREQ(stub("libGL.so"), "libGL.so.1");
  EXPECT_STREQ(stub("libGL.so.1.7.0"), "libGL.so.1");
  EXPECT_STREQ(stub("/usr/lib/x86_64-linux-gnu/libGL.so.1"), "libGL.so.1");
  EXPECT_STREQ(stub("./libGLX.so.0"), "libGLX.so.0");
  EXPECT_STREQ(stub("libGLX.so"), "libGLX.so.0");
  EXPECT_STREQ(stub("libOpenGL.so.0"), "libOpenGL.so.0");
  EXPECT_STREQ(stub("libEGL.so.1.1.0"), "libEGL.so.1");
}

TEST(GlNames, OtherLibrariesHaveNone) {
  for (const char* other : {"libGLU.so.1", "libGLEW.so.2.2", "libGLX_mesa.so.0", "libEGL_mesa.so.0",
                            "libGLESv2.so.2", "libGL.so.2", "libGL.so.10", "libGL.so.1x", "libOpenGL.so.1",
                            "libGLdispatch.so.0", "libGL", "mylibGL.so.1", "/libGL.so.1/libm.so.6", ""}) {
    EXPECT_STREQ(stub(other), "") << other;
  }
}

TEST(GlNames, DriversAndOurselvesMayHaveTheRealOne) {
  EXPECT_TRUE(may_have_the_real_one("/usr/lib/x86_64-linux-gnu/libGL.so.1", nullptr));
  EXPECT_TRUE(may_have_the_real_one("/usr/lib/x86_64-linux-gnu/libGLX_mesa.so.0", nullptr));
  EXPECT_TRUE(may_have_the_real_one("/usr/lib/x86_64-linux-gnu/libEGL_nvidia.so.0", nullptr));
  EXPECT_TRUE(may_have_the_real_one("/opt/understudy/lib/libunderstudy.so", nullptr));
  EXPECT_FALSE(may_have_the_real_one("", nullptr)) << "the program itself";
  EXPECT_FALSE(may_have_the_real_one("/usr/lib/x86_64-linux-gnu/libGLEW.so.2.2", nullptr));
  EXPECT_FALSE(may_have_the_real_one("/usr/lib/x86_64-linux-gnu/libGLU.so.1", ""));
  EXPECT_TRUE(may_have_the_real_one("/opt/tracer/glxtrace.so", "/opt/tracer"));
  EXPECT_FALSE(may_have_the_real_one("/opt/tracers/glxtrace.so", "/opt/tracer"));
}

}  // namespace
