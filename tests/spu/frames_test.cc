// SPDX-License-Identifier: Apache-2.0
// Accounting of frames, whichever context draws or swaps, and however often the same is drawn.
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "compositor/rendered.h"
#include "slice_scenes.h"
#include "spu/chain.h"
#include "spu/report/counters.h"
#include "spu/volume/session/last_image.h"
#include "spu/volume/timing/frame_ledger.h"
#include "volume/image.h"
#include "volume/request.h"

namespace understudy::spu::testing {
namespace {

const int one = 1;
const int two = 2;

TEST(FrameLedger, GivesWhatAContextWithoutFramesDrewToWhoeverEndsOne) {
  FrameLedger ledger;
  ledger.note(&one, false, [](FrameRecord& frame) { ++frame.substituted; });
  EXPECT_EQ(ledger.close(&two).substituted, 1U);
  EXPECT_EQ(ledger.close(&two).substituted, 0U);
  EXPECT_EQ(ledger.frames(), 2U);
}

TEST(FrameLedger, KeepsContextsApartThatDrawIntoTheirWindows) {
  FrameLedger ledger;
  ledger.note(&one, true, [](FrameRecord& frame) { ++frame.substituted; });
  EXPECT_EQ(ledger.close(&two).substituted, 0U);
  EXPECT_EQ(ledger.close(&one).substituted, 1U);
}

TEST(FrameLedger, KeepsContextsApartThatEndFramesThemselves) {
  FrameLedger ledger;
  ledger.close(&one);
  ledger.close(&two);
  ledger.note(&one, false, [](FrameRecord& frame) { ++frame.left; });
  EXPECT_EQ(ledger.close(&two).left, 0U);
  EXPECT_EQ(ledger.close(&one).left, 1U);
}

TEST(FrameLedger, KeepsWhatAContextDrewThatIsGone) {
  FrameLedger ledger;
  ledger.close(&one);
  ledger.note(&one, false, [](FrameRecord& frame) { frame.error_rms = 0.5; });
  ledger.forget(&one);
  EXPECT_EQ(ledger.close(&two).error_rms, 0.5);
  EXPECT_LT(ledger.close(&two).error_rms, 0) << "not measured";
}

/// As in Qt: slices into a framebuffer object in one context, the swap in another.
TEST(Frames, AreCountedAsSubstitutedWhereAnotherContextEndsThem) {
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here; install libegl1 and libgl1-mesa-dri";
  const SliceScene scene = immediate_rgba();
  scene.set_up(*app);
  GLuint framebuffer = 0;
  GLuint colour = 0;
  app->gl().GenRenderbuffers(1, &colour);
  app->gl().BindRenderbuffer(GL_RENDERBUFFER, colour);
  app->gl().RenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, GlApplication::size, GlApplication::size);
  app->gl().GenFramebuffers(1, &framebuffer);
  app->gl().BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  app->gl().FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colour);
  const ProcessCounters& counters = process_counters();
  const auto frames = counters.frames.load();
  const auto substituted = counters.frames_substituted.load();
  for (int i = 0; i < 3; ++i) {
    scene.draw(*app, 10 * i);
    Chain::current()->settle();
    std::thread([&] {
      const auto shower = app->start_companion();
      ASSERT_TRUE(shower);
      shower->end_frame();
    }).join();
  }
  EXPECT_EQ(app->substituted(), 3U) << app->last_reason();
  EXPECT_EQ(counters.frames - frames, 3U);
  EXPECT_EQ(counters.frames_substituted - substituted, 3U);
}

class CountingService final : public compositor::RenderService {
 public:
  explicit CountingService(int& images) : images_(images) {}
  void begin_volume(const volume::VolumeDescription&) override {}
  void begin_change(volume::VolumeId, std::uint64_t) override {}
  void add_texels(volume::VolumeId, std::span<const volume::TexelBox>, std::span<const std::byte>) override {}
  void end_volume(volume::VolumeId) override {}
  void forget_volume(volume::VolumeId) override {}
  compositor::Rendered render(const volume::RenderRequest& request) override {
    ++images_;
    image_ = volume::Image({0, 0, 1, 1});
    image_.rgba[0] = float(request.volume);
    return {image_.view(), {}};
  }
  std::vector<volume::PixelIntegral> integrals(const volume::RenderRequest&, std::span<const volume::Pixel>,
                                               double) override {
    return {};
  }
  int nodes() const override { return 0; }

 private:
  int& images_;
  volume::Image image_;
};

TEST(LastImage, AnswersARequestThatCameBefore) {
  int images = 0;
  std::vector<std::string> news;
  const auto service = with_last_image(std::make_unique<CountingService>(images), true,
                                       [&](std::string_view why) { news.emplace_back(why); });
  volume::RenderRequest request;
  EXPECT_FALSE(service->render(request).repeated);
  EXPECT_TRUE(service->render(request).repeated);
  EXPECT_EQ(images, 1);
  request.texture_to_clip[3] = 0.25;
  service->render(request);
  EXPECT_EQ(images, 2) << "another request";
  service->forget_volume(7);
  service->render(request);
  EXPECT_EQ(images, 3) << "the image may have gone with the service's next answer";
  ++request.version;
  service->render(request);
  EXPECT_EQ(news, (std::vector<std::string>{"the first of its volume", "", "the camera moved",
                                            "others were asked for since", "texels changed"}));
}

/// Sends images as JPEG unless they must be exact; an image shows whether it is.
class LossyService final : public compositor::RenderService {
 public:
  explicit LossyService(int& images) : images_(images) {}
  void begin_volume(const volume::VolumeDescription&) override {}
  void begin_change(volume::VolumeId, std::uint64_t) override {}
  void add_texels(volume::VolumeId, std::span<const volume::TexelBox>, std::span<const std::byte>) override {}
  void end_volume(volume::VolumeId) override {}
  void forget_volume(volume::VolumeId) override {}
  compositor::Rendered render(const volume::RenderRequest& request) override {
    ++images_;
    image_ = volume::Image({0, 0, 1, 1});
    image_.rgba[0] = request.exact ? 1.0F : 0.5F;
    return {image_.view(), {}, false, !request.exact};
  }
  std::vector<volume::PixelIntegral> integrals(const volume::RenderRequest&, std::span<const volume::Pixel>,
                                               double) override {
    return {};
  }
  int nodes() const override { return 1; }

 private:
  int& images_;
  volume::Image image_;
};

TEST(LastImage, OfAViewAtRestIsExact) {
  int images = 0;
  const auto service = with_last_image(std::make_unique<LossyService>(images), true, [](std::string_view) {});
  volume::RenderRequest request;
  EXPECT_TRUE(service->render(request).lossy);
  for (int frame = 0; frame < 3; ++frame) {
    const compositor::Rendered rendered = service->render(request);
    EXPECT_FALSE(rendered.lossy);
    EXPECT_EQ(rendered.image.rgba[0], 1.0F);
    EXPECT_EQ(rendered.repeated, frame > 0);
  }
  EXPECT_EQ(images, 2);
  request.exact = true;
  EXPECT_TRUE(service->render(request).repeated) << "the image that is there is exact";
  request.texture_to_clip[3] = 0.25;
  EXPECT_FALSE(service->render(request).lossy);
  request.exact = false;
  EXPECT_TRUE(service->render(request).repeated) << "likewise";
  EXPECT_EQ(images, 3);
}

TEST(LastImage, OfSeveralViewsAtRestAreExact) {
  int images = 0;
  const auto service = with_last_image(std::make_unique<LossyService>(images), true, [](std::string_view) {});
  std::array<volume::RenderRequest, 2> requests;
  requests[1].volume = 1;
  for (int frame = 0; frame < 4; ++frame)
    for (const volume::RenderRequest& request : requests)
      EXPECT_EQ(service->render(request).image.rgba[0], frame == 0 ? 0.5F : 1.0F);
  EXPECT_EQ(images, 4);
}

TEST(LastImage, OfSeveralInTurnIsKept) {
  int images = 0;
  const auto service =
      with_last_image(std::make_unique<CountingService>(images), true, [](std::string_view) {});
  std::array<volume::RenderRequest, 2> requests;
  requests[1].volume = 1;
  for (int frame = 0; frame < 5; ++frame)
    for (const volume::RenderRequest& request : requests) {
      const compositor::Rendered rendered = service->render(request);
      ASSERT_EQ(rendered.image.rgba.size(), 4U);
      EXPECT_EQ(rendered.image.rgba[0], float(request.volume));
      EXPECT_EQ(rendered.repeated, frame >= 2) << "the second time they are asked for, images are kept";
    }
  EXPECT_EQ(images, 4);
}

TEST(Frames, ThatDrawTheSameTwiceAskForOneImage) {
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here; install libegl1 and libgl1-mesa-dri";
  const SliceScene scene = fogged_polygons();
  scene.set_up(*app);
  const auto rays = [] { return process_counters().total.rays; };
  scene.draw(*app, 10);
  app->end_frame();
  const auto after_one = rays();
  scene.draw(*app, 20);
  scene.draw(*app, 20);
  app->end_frame();
  const auto under = app->read_pixels();
  const auto of_both = rays() - after_one;
  scene.draw(*app, 20);
  app->end_frame();
  EXPECT_GT(of_both, 0U);
  EXPECT_EQ(rays() - after_one, of_both) << "the third is the same again";
  EXPECT_EQ(app->substituted(), 4U) << app->last_reason();
  app->use_chain(false);
  scene.draw(*app, 20);
  EXPECT_GE(psnr(under, app->read_pixels()), 40);
}

}  // namespace
}  // namespace understudy::spu::testing
