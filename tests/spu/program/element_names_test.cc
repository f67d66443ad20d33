// SPDX-License-Identifier: Apache-2.0
// Names of variables, as spelled by the analysis and by OpenGL queries.
#include "spu/volume/program/element_names.h"

#include <gtest/gtest.h>

namespace understudy::spu::program {
namespace {

TEST(ElementNames, AreTheSameWithAndWithoutTheFirstElement) {
  EXPECT_TRUE(may_be_same_element("planes", "planes[0]"));
  EXPECT_TRUE(may_be_same_element("planes[3]", "planes"));
  EXPECT_TRUE(may_be_same_element("lights[2].place", "lights[2].place[0]"));
}

TEST(ElementNames, DifferByElement) {
  EXPECT_FALSE(may_be_same_element("planes[1]", "planes[0]"));
  EXPECT_FALSE(may_be_same_element("lights[1].place", "lights[2].place"));
  EXPECT_FALSE(may_be_same_element("lights[1].place", "lights[1].colour"));
  EXPECT_FALSE(may_be_same_element("plane", "planes"));
  EXPECT_FALSE(may_be_same_element("Clip[0].plane", "Clip.plane")) << "of an array of blocks";
  EXPECT_FALSE(may_be_same_element("", "planes"));
}

TEST(ElementNames, ThatAreKeptTogetherMayBeAny) {
  EXPECT_TRUE(may_be_same_element("Scene.planes[*]", "Scene.planes[5]"));
  EXPECT_TRUE(may_be_same_element("lights[*].place", "lights[7].place"));
  EXPECT_FALSE(may_be_same_element("lights[*].place", "lights[7].colour"));
}

TEST(ElementNames, ThatAreBrokenEndAllTheSame) {
  EXPECT_FALSE(may_be_same_element("planes[", "planes[0]"));
  EXPECT_TRUE(may_be_same_element("[", "["));
}

}  // namespace
}  // namespace understudy::spu::program
