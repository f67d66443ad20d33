// SPDX-License-Identifier: Apache-2.0
// Hard cases and random scenes in OpenGL, against the same samples in double precision.
#include <gtest/gtest.h>

#include <memory>

#include "tests/volume/properties.h"
#include "tests/volume/stiff_cases.h"
#include "volume/frame_counts.h"
#include "volume/glsl/glsl_ray_caster.h"
#include "volume/image.h"
#include "volume/request.h"

namespace understudy::volume::glsl {
namespace {

using namespace volume::testing;

class HardCasesOnGl : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const Platform platform : {Platform::egl, Platform::osmesa}) try {
        device_ = std::make_unique<Device>(platform);
        std::printf("%s\n", device_->description().c_str());
        return;
      } catch (const ContextUnavailable& absent) {
        std::printf("%s\n", absent.what());
      }
    GTEST_SKIP() << "no OpenGL without a window here; install libegl1 and libgl1-mesa-dri, or libosmesa6";
  }

  DrawBricks draw() {
    return [this](const BrickStore& store, const RenderRequest& request, Image& image, FrameCounts& counts) {
      GlslRayCaster(store, *device_).render(request, image, counts);
    };
  }

  void expect_all_within_bounds(const std::vector<StiffCase>& cases) {
    for (StiffCase one : cases) {
      if (one.bound > 0) one.bound = widened(one.bound), one.apart = widened(one.apart);
      expect_within_bounds(one, "GL", draw());
    }
  }

  /// Graphics cards filter with 8-bit weights.
  double widened(double bound) const {
    constexpr double of_eight_bits = 2e-2;
    const bool exact = device_->description().find("llvmpipe") != std::string::npos;
    return exact ? bound : std::max(bound, of_eight_bits);
  }

 private:
  std::unique_ptr<Device> device_;
};

TEST_F(HardCasesOnGl, StiffTablesStayWithinTheirBounds) {
  expect_all_within_bounds(stiff_tables());
}

TEST_F(HardCasesOnGl, OddFieldsStayWithinTheirBounds) {
  expect_all_within_bounds(stiff_fields());
}

TEST_F(HardCasesOnGl, HardViewsStayWithinTheirBounds) {
  expect_all_within_bounds(stiff_views());
}

TEST_F(HardCasesOnGl, PropertiesHoldOnRandomScenes) {
  expect_properties({.renderer = "GL", .trials = 60, .may_refuse = true, .apart = widened(1e-5)}, draw());
}

}  // namespace
}  // namespace understudy::volume::glsl
