// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/session/frame_latency.h"

#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <future>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "compositor/rendered.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/request.h"

namespace understudy::spu {
namespace {

/// Returns images of one pixel that encode the request's camera and the volume's version; waits on demand.
class Cameras final : public compositor::RenderService {
 public:
  void begin_volume(const volume::VolumeDescription&) override {}
  void begin_change(volume::VolumeId, std::uint64_t) override {}
  void add_texels(volume::VolumeId, std::span<const volume::TexelBox>, std::span<const std::byte>) override {}
  void end_volume(volume::VolumeId) override {}
  void forget_volume(volume::VolumeId id) override { forgotten.push_back(id); }
  compositor::Rendered render(const volume::RenderRequest& request) override {
    if (wait_for.valid()) wait_for.wait();
    if (is_lost) throw compositor::ServiceLost("the nodes are gone");
    if (request.volume == refused) throw compositor::RequestRefused("too large");
    sigset_t blocked;
    pthread_sigmask(SIG_BLOCK, nullptr, &blocked);
    blocks_signals = sigismember(&blocked, SIGUSR1) != 0;
    ++images;
    image_ = volume::Image({0, 0, 1, 1});
    image_.rgba = {float(request.texture_to_clip[3]), float(request.version), 0, 0};
    volume::FrameCounts counts;
    counts.rays = 1;
    return {image_.view(), counts, false, is_lossy && !request.exact};
  }
  std::vector<volume::PixelIntegral> integrals(const volume::RenderRequest&, std::span<const volume::Pixel>,
                                               double) override {
    return {};
  }
  int nodes() const override { return 2; }

  std::shared_future<void> wait_for;
  std::atomic<bool> is_lost = false;
  std::atomic<volume::VolumeId> refused = 99;
  std::atomic<bool> is_lossy = false;  ///< images are sent as JPEG unless they must be exact
  std::atomic<int> images = 0;
  std::atomic<bool> blocks_signals = false;  ///< the thread of the last image
  std::vector<volume::VolumeId> forgotten;

 private:
  volume::Image image_;
};

class FrameLatencyTest : public ::testing::Test {
 protected:
  FrameLatencyTest() {
    auto cameras = std::make_unique<Cameras>();
    cameras_ = cameras.get();
    service_ = std::make_unique<FrameLatency>(std::move(cameras));
  }

  volume::RenderRequest request_from(double camera) const {
    volume::RenderRequest request;
    request.version = version_;
    request.texture_to_clip[3] = camera;
    return request;
  }

  /// The camera of the image that is shown in this frame of the view.
  float seen_in(const View& view, const volume::RenderRequest& request) {
    const compositor::Rendered rendered = service_->render_view({view, frame_}, request, may_be_late_);
    rays_ += rendered.counts.rays;
    EXPECT_EQ(rendered.image.rgba[1], float(request.version));
    return rendered.image.rgba[0];
  }
  /// The same in the next frame.
  float seen_next(const volume::RenderRequest& request, const View& view = {}) {
    ++frame_;
    return seen_in(view, request);
  }
  float seen_from(double camera) { return seen_next(request_from(camera)); }

  Cameras* cameras_ = nullptr;
  std::unique_ptr<FrameLatency> service_;
  bool may_be_late_ = true;
  std::uint64_t frame_ = 1;
  std::uint64_t version_ = 1;
  std::uint64_t rays_ = 0;
};

TEST_F(FrameLatencyTest, IsNotLateUnlessAllowed) {
  may_be_late_ = false;
  for (int camera = 0; camera < 5; ++camera) {
    EXPECT_EQ(seen_from(camera), camera);
    EXPECT_FALSE(service_->is_late());
  }
}

TEST_F(FrameLatencyTest, IsLateWhileTheCameraMovesAndRightWhenItRests) {
  EXPECT_EQ(seen_from(1), 1) << "there is no other yet";
  for (int camera = 2; camera < 7; ++camera) {
    EXPECT_EQ(seen_from(camera), camera - 1);
    EXPECT_TRUE(service_->is_late());
  }
  EXPECT_EQ(seen_from(6), 6);
  EXPECT_FALSE(service_->is_late());
  EXPECT_EQ(seen_from(6), 6);
  EXPECT_EQ(cameras_->images, 6) << "each camera once";
  EXPECT_EQ(rays_, 6U);
  EXPECT_EQ(seen_from(9), 6) << "and it moves on";
}

TEST_F(FrameLatencyTest, AsksAgainForALossyImageWhenTheCameraRests) {
  cameras_->is_lossy = true;
  seen_from(1);
  EXPECT_EQ(seen_from(2), 1);
  volume::RenderRequest request = request_from(2);
  for (int frame = 0; frame < 3; ++frame) {
    const compositor::Rendered rendered = service_->render_view({{}, ++frame_}, request, true);
    EXPECT_EQ(rendered.image.rgba[0], 2);
    EXPECT_FALSE(rendered.lossy);
    EXPECT_FALSE(service_->is_late());
  }
  EXPECT_EQ(cameras_->images, 3) << "of camera 2 a lossy one and an exact one";
  request.exact = true;
  seen_next(request);
  EXPECT_EQ(cameras_->images, 3);
}

TEST_F(FrameLatencyTest, DoesNotWaitForTheNodesBetweenFrames) {
  seen_from(1);
  std::promise<void> nodes_are_done;
  cameras_->wait_for = nodes_are_done.get_future().share();
  EXPECT_EQ(seen_from(2), 1) << "while the nodes still draw";
  nodes_are_done.set_value();
  EXPECT_EQ(seen_from(3), 2);
}

TEST_F(FrameLatencyTest, ShowsOnlyImagesOfTheSameVolumeColoursAndSize) {
  seen_from(1);
  EXPECT_EQ(seen_from(2), 1);
  ++version_;
  EXPECT_EQ(seen_from(3), 3) << "an image of the old texels is no image of the new ones";
  volume::RenderRequest request = request_from(3);
  double camera = 3;
  const auto expect_own_image = [&](const char* changed) {
    request.texture_to_clip[3] = ++camera;
    EXPECT_EQ(seen_next(request), camera) << changed;
    request.texture_to_clip[3] = ++camera;
    EXPECT_EQ(seen_next(request), camera - 1) << "from the next frame on it may be late";
  };
  request.window = {0, 0, 7, 7};
  expect_own_image("window");
  request.viewport = {0, 0, 7, 7};
  expect_own_image("viewport");
  request.classification = volume::TransferFunction{.entries = {{0, 0, 0, 0}, {1, 1, 1, 1}}};
  expect_own_image("colours");
  request.op = volume::Operator::max;
  expect_own_image("operator");
  request.filter = volume::Filter::nearest;
  expect_own_image("filter");
  request.clip_planes.emplace_back();
  expect_own_image("clip planes");
  request.volume = 7;
  expect_own_image("volume");
}

TEST_F(FrameLatencyTest, ShowsNoViewTheImageOfAnother) {
  const View one{.texture = 1, .window = 5, .written = {1, 1, 1, 1}, .viewport = {0, 0, 9, 9}};
  const std::vector<std::pair<std::string, std::function<void(View&)>>> others{
      {"context", [](View& view) { view.context = &view; }},
      {"volume", [](View& view) { view.texture = 2; }},
      {"window", [](View& view) { view.window = 6; }},
      {"framebuffer", [](View& view) { view.framebuffer = 1; }},
      {"eye of a stereo window", [](View& view) { view.buffer = GL_BACK_RIGHT; }},
      {"eye of an anaglyph",
       [](View& view) {
         view.written = {0, 1, 1, 1};
       }},
      {"viewport",
       [](View& view) {
         view.viewport = {9, 0, 9, 9};
       }},
      {"scissor", [](View& view) {
         view.scissor = {0, 0, 3, 3};
       }}};
  for (const auto& [name, change] : others) {
    View other = one;
    change(other);
    frame_ += 2;
    const std::uint64_t first = frame_ + 1;
    for (int camera = 1; camera < 6; ++camera) {
      ++frame_;
      EXPECT_EQ(seen_in(one, request_from(camera)), frame_ == first ? 1 : camera - 1) << name;
      EXPECT_EQ(seen_in(other, request_from(100 + camera)), frame_ == first ? 101 : 99 + camera) << name;
    }
  }
}

TEST_F(FrameLatencyTest, IsLateByNoMoreThanOneFrame) {
  seen_from(1);
  EXPECT_EQ(seen_from(2), 1);
  ++frame_;
  EXPECT_EQ(seen_from(3), 3) << "in one frame the view was not drawn";
  EXPECT_EQ(seen_from(4), 3);
  EXPECT_EQ(seen_in({}, request_from(5)), 5) << "the image of camera 4 is of this frame";
}

TEST_F(FrameLatencyTest, AnswersRequestsOutsideOfViewsWithTheirOwnImages) {
  seen_from(1);
  EXPECT_EQ(seen_from(2), 1);
  EXPECT_EQ(service_->render(request_from(3)).image.rgba[0], 3);
  EXPECT_EQ(seen_from(4), 2) << "it was none of the view";
}

TEST_F(FrameLatencyTest, AnswersExactRequestsWithTheirOwnImages) {
  for (int camera = 1; camera < 4; ++camera)
    EXPECT_EQ(seen_next(volume::exactly(request_from(camera))), camera);
  EXPECT_EQ(seen_from(4), 3);
  EXPECT_EQ(seen_next(volume::exactly(request_from(5))), 5) << "although another is being cast";
  EXPECT_EQ(seen_from(6), 5);
}

TEST_F(FrameLatencyTest, ShowsNoLateImageBehindGeometry) {
  const auto hidden = [&](double camera, float depth) {
    volume::RenderRequest request = request_from(camera);
    request.depth = volume::DepthImage{.rect = {0, 0, 1, 1}, .depth = {depth}};
    return request;
  };
  seen_from(1);
  EXPECT_EQ(seen_next(hidden(2, 0.5F)), 2) << "geometry has come in front";
  EXPECT_EQ(seen_next(hidden(3, 0.6F)), 3) << "it moves";
  EXPECT_EQ(seen_next(hidden(4, 0.6F)), 4);
  EXPECT_EQ(seen_from(5), 5) << "it is gone";
  EXPECT_EQ(seen_from(6), 5);
}

TEST_F(FrameLatencyTest, ShowsNoLateImagesToEyesInTurn) {
  const double apart = 50;
  float late = 0;
  for (int frame = 0; frame < 10; ++frame) {
    const double camera = frame + (frame % 2 == 0 ? 0 : apart);
    const float seen = seen_from(camera);
    if (frame > 1) late += std::abs(seen - float(camera));
  }
  EXPECT_EQ(late, 0);
}

TEST_F(FrameLatencyTest, KeepsSeveralVolumesApart) {
  for (int frame = 0; frame < 4; ++frame, ++frame_)
    for (const volume::VolumeId id : {1, 2}) {
      volume::RenderRequest request = request_from(double(10 * frame) + double(id));
      request.volume = id;
      EXPECT_EQ(seen_in({.texture = GLuint(id)}, request), float(10 * std::max(0, frame - 1)) + float(id));
    }
}

TEST_F(FrameLatencyTest, ForgetsTheImagesOfAVolumeThatIsForgottenOrChanged) {
  const std::vector<std::function<void()>> changes{
      [&] { service_->forget_volume(0); }, [&] { service_->begin_change(0, 1); },
      [&] { service_->add_texels(0, {}, {}); }, [&] { service_->end_volume(0); }};
  double camera = 0;
  for (const auto& change : changes) {
    seen_from(++camera);
    seen_from(++camera);
    change();
    ++camera;
    EXPECT_EQ(seen_from(camera), camera);
  }
  service_->forget_volume(3);
  ++camera;
  EXPECT_EQ(seen_from(camera), camera - 1) << "another volume is not concerned";
}

TEST_F(FrameLatencyTest, CastsOnThreadsThatLeaveTheViewersSignalsAlone) {
  seen_from(1);
  EXPECT_FALSE(cameras_->blocks_signals) << "the viewer's own thread";
  seen_from(2);
  seen_from(3);
  EXPECT_TRUE(cameras_->blocks_signals);
}

TEST_F(FrameLatencyTest, TellsOfLostNodesWithTheNextImage) {
  seen_from(1);
  cameras_->is_lost = true;
  EXPECT_EQ(seen_from(2), 1);
  EXPECT_THROW(seen_from(3), compositor::ServiceLost);
  cameras_->is_lost = false;
  EXPECT_EQ(seen_from(4), 4);
}

TEST_F(FrameLatencyTest, RefusesNothingElseForAnImageThatWasRefused) {
  seen_from(1);
  cameras_->refused = 0;
  EXPECT_EQ(seen_from(2), 1);
  service_->forget_volume(3);
  EXPECT_EQ(cameras_->forgotten, std::vector<volume::VolumeId>{3});
  EXPECT_THROW(seen_from(3), compositor::RequestRefused) << "the view's own request";
  cameras_->refused = 99;
  EXPECT_EQ(seen_from(4), 4);
  cameras_->refused = 0;
  EXPECT_EQ(seen_from(5), 4);
  volume::RenderRequest other = request_from(6);
  other.volume = 8;
  EXPECT_EQ(seen_next(other, {.texture = 8}), 6);
}

}  // namespace
}  // namespace understudy::spu
