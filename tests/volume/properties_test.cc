// SPDX-License-Identifier: Apache-2.0
// Properties of every image, drawn on the CPU.
#include "tests/volume/properties.h"

#include <gtest/gtest.h>

namespace understudy::volume::testing {
namespace {

TEST(Properties, HoldOnRandomScenes) {
  expect_properties({.renderer = "CPU", .trials = 300}, raycast);
}

}  // namespace
}  // namespace understudy::volume::testing
