// SPDX-License-Identifier: Apache-2.0
// Selection of the backend: by request, by measurement, and the fallback where OpenGL cannot draw.
#include "volume/glsl/backend.h"

#include <gmock/gmock.h>

#include <atomic>
#include <vector>

#include "tests/volume/scenes.h"
#include "volume/frame_counts.h"
#include "volume/glsl/device.h"
#include "volume/image.h"
#include "volume/occlusion.h"
#include "volume/raycast/ray_caster.h"
#include "volume/request.h"

#if defined(__SANITIZE_ADDRESS__)
/// Suppresses leak reports for memory that Mesa keeps until the process ends.
extern "C" [[gnu::visibility("default")]] const char* __lsan_default_suppressions();
const char* __lsan_default_suppressions() {
  return "leak:_dri.so\nleak:libEGL_mesa\nleak:libOSMesa\nleak:libLLVM\n";
}
#endif

namespace understudy::volume::glsl {
namespace {

using namespace volume::testing;
using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

constexpr int edge = 64;

bool has_opengl() {
  try {
    const Device device(Platform::egl);
    return true;
  } catch (const ContextUnavailable&) {
    return false;
  }
}

/// Hides nothing, and counts how often it is asked.
class Asked final : public Occlusion {
 public:
  bool hides(const Rect& /*pixels*/) override {
    ++times;
    return false;
  }
  void cover(const Rect& /*pixels*/) override {}
  bool from_the_end() const override { return false; }

  std::atomic<int> times = 0;
};

class Told : public ::testing::Test {
 protected:
  Told()
      : texture_(noise(describe({31, 33, 35}, TexelType::u8), 3)),
        store_(filled(texture_)),
        request_(request_for(texture_, usual_camera(edge, edge), edge, edge, 60)) {}

  /// Draws `frames` frames; returns the largest difference from the CPU's image.
  double draw(BackendChooser& chooser, int frames) {
    Image expected(request_.window);
    FrameCounts counts;
    raycast(store_, request_, expected, counts);
    const auto renderer = chooser.factory()(store_);
    double worst = 0;
    for (int frame = 0; frame < frames; ++frame) {
      Image image(request_.window);
      FrameCounts same;
      renderer->render(request_, image, same);
      EXPECT_EQ(same.samples, counts.samples);
      worst = std::max(worst, difference(image, expected).max);
    }
    return worst;
  }

  /// Draws an image of each of `requests`; returns by which of them the occlusion was asked.
  std::vector<bool> asked(BackendChooser& chooser, const std::vector<RenderRequest>& requests) {
    const auto renderer = chooser.factory()(store_);
    std::vector<bool> by;
    for (const RenderRequest& request : requests) {
      Image image(request.window);
      FrameCounts counts;
      Asked occlusion;
      renderer->render(request, image, counts, &occlusion);
      by.push_back(occlusion.times > 0);
    }
    return by;
  }

  BackendChooser::Tell tell() {
    return [this](const std::string& line) { told_.push_back(line); };
  }

  Texture texture_;
  BrickStore store_;
  RenderRequest request_;
  std::vector<std::string> told_;
};

TEST_F(Told, TheCpuNeedsNoReason) {
  BackendChooser chooser(Backend::cpu, tell());
  EXPECT_EQ(draw(chooser, 3), 0);
  EXPECT_THAT(told_, IsEmpty());
}

TEST_F(Told, OpenGlIsNamedOnce) {
  if (!has_opengl()) GTEST_SKIP() << "there is no OpenGL on EGL here";
  BackendChooser chooser(Backend::egl, tell());
  EXPECT_LE(draw(chooser, 3), 1e-3);
  EXPECT_THAT(told_, ElementsAre(AllOf(StartsWith("GL, as asked: "), HasSubstr("on EGL"))));
}

TEST_F(Told, AutomaticMeasuresBothAndThenStays) {
  if (!has_opengl()) GTEST_SKIP() << "there is no OpenGL on EGL here";
  BackendChooser chooser(Backend::automatic, tell());
  EXPECT_LE(draw(chooser, 4), 1e-3);
  EXPECT_THAT(told_,
              ElementsAre(AllOf(AnyOf(StartsWith("GL for u8, over, linear filter, most blocks visible"),
                                      StartsWith("CPU for u8, over, linear filter, most blocks visible")),
                                HasSubstr("ns a sample"), HasSubstr("on EGL"))));
  draw(chooser, 4);  // another volume of the same kind
  EXPECT_EQ(told_.size(), 1U);
}

TEST_F(Told, WhatOpenGlLacksTheCpuDraws) {
  if (!has_opengl()) GTEST_SKIP() << "there is no OpenGL on EGL here";
  request_.fog = Fog{{0, 0, 1}, 0, {{0, 0, 0, 1}, {1, 1, 1, 0}}};
  BackendChooser chooser(Backend::gl, tell());
  EXPECT_EQ(draw(chooser, 2), 0);
  EXPECT_THAT(told_, ElementsAre("CPU: the GL backend does not draw fog"));
}

TEST_F(Told, OcclusionIsGivenUpOnlyForImagesThatAreCompared) {
  request_.termination = RenderRequest{}.termination;
  RenderRequest small = request_, foggy = request_;
  small.planes.count = 3;
  foggy.fog = Fog{{0, 0, 1}, 0, {{0, 0, 0, 1}, {1, 1, 1, 0}}};
  BackendChooser cpu(Backend::cpu, tell());
  EXPECT_THAT(asked(cpu, {request_}), ElementsAre(true)) << "such images are occluded";
  BackendChooser few_samples(Backend::automatic, tell());
  EXPECT_THAT(asked(few_samples, {small, small, small}), ElementsAre(false, true, true));
  // Two images on the CPU; then OpenGL, which does not draw fog, or has no device.
  BackendChooser obstructed(Backend::automatic, tell());
  EXPECT_THAT(asked(obstructed, {foggy, foggy, foggy, foggy}), ElementsAre(false, false, true, true));
}

TEST_F(Told, SenselessRequestsAreRefusedAsByTheCpu) {
  BackendChooser chooser(Backend::gl, tell());
  const auto renderer = chooser.factory()(store_);
  request_.texture_to_clip = {};
  Image image(request_.window);
  FrameCounts counts;
  EXPECT_THROW(renderer->render(request_, image, counts), std::invalid_argument);
}

TEST_F(Told, SamplesBeyondABorderWithoutFilterAreRefused) {
  texture_.description.wrap.fill(Wrap::border);
  const BrickStore bordered = filled(texture_);
  request_.steps.emplace().metric = {60, 0, 0, 0, 60, 0, 0, 0, 60};
  request_.steps->first = 0.5;
  request_.steps->counted_from = 0;
  Image image(request_.window);
  FrameCounts counts;
  for (const Backend backend : {Backend::cpu, Backend::gl}) {
    BackendChooser chooser(backend, tell());
    const auto renderer = chooser.factory()(bordered);
    request_.filter = Filter::linear;
    EXPECT_NO_THROW(renderer->render(request_, image, counts));
    request_.filter = Filter::nearest;
    EXPECT_THROW(renderer->render(request_, image, counts), std::invalid_argument);
  }
}

TEST(BackendNames, AreThoseOfTheCommandLine) {
  EXPECT_EQ(backend_of("auto"), Backend::automatic);
  EXPECT_EQ(backend_of("gl:osmesa"), Backend::osmesa);
  EXPECT_FALSE(backend_of("vulkan"));
}

}  // namespace
}  // namespace understudy::volume::glsl
