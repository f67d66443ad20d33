// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/session/frame_latency.h"

#include <gtest/gtest.h>
#include <signal.h>

#include <atomic>
#include <future>
#include <memory>
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
  void forget_volume(volume::VolumeId) override {}
  compositor::Rendered render(const volume::RenderRequest& request) override {
    if (wait_for.valid()) wait_for.wait();
    if (is_lost) throw compositor::ServiceLost("the nodes are gone");
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
  std::atomic<bool> is_lossy = false;  ///< images are sent as JPEG unless they must be exact
  std::atomic<int> images = 0;
  std::atomic<bool> blocks_signals = false;  ///< the thread of the last image

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

  /// The camera of the image that is returned for `camera`.
  float seen_from(double camera) {
    volume::RenderRequest request;
    request.version = version_;
    request.texture_to_clip[3] = camera;
    const compositor::Rendered rendered = service_->render(request);
    rays_ += rendered.counts.rays;
    EXPECT_EQ(rendered.image.rgba[1], float(version_));
    return rendered.image.rgba[0];
  }

  Cameras* cameras_ = nullptr;
  std::unique_ptr<FrameLatency> service_;
  std::uint64_t version_ = 1;
  std::uint64_t rays_ = 0;
};

TEST_F(FrameLatencyTest, IsNotBehindUnlessAllowed) {
  for (int camera = 0; camera < 5; ++camera) {
    EXPECT_EQ(seen_from(camera), camera);
    EXPECT_FALSE(service_->is_behind());
  }
}

TEST_F(FrameLatencyTest, IsBehindWhileTheCameraMovesAndRightWhenItRests) {
  service_->allow(true);
  EXPECT_EQ(seen_from(1), 1) << "there is no other yet";
  for (int camera = 2; camera < 7; ++camera) {
    EXPECT_EQ(seen_from(camera), camera - 1);
    EXPECT_TRUE(service_->is_behind());
  }
  EXPECT_EQ(seen_from(6), 6);
  EXPECT_FALSE(service_->is_behind());
  EXPECT_EQ(seen_from(6), 6);
  EXPECT_EQ(cameras_->images, 6) << "each camera once";
  EXPECT_EQ(rays_, 6U);
  EXPECT_EQ(seen_from(9), 6) << "and it moves on";
}

TEST_F(FrameLatencyTest, AsksAgainForALossyImageWhenTheCameraRests) {
  cameras_->is_lossy = true;
  service_->allow(true);
  seen_from(1);
  EXPECT_EQ(seen_from(2), 1);
  volume::RenderRequest request;
  request.version = version_;
  request.texture_to_clip[3] = 2;
  for (int frame = 0; frame < 3; ++frame) {
    const compositor::Rendered rendered = service_->render(request);
    EXPECT_EQ(rendered.image.rgba[0], 2);
    EXPECT_FALSE(rendered.lossy);
    EXPECT_FALSE(service_->is_behind());
  }
  EXPECT_EQ(cameras_->images, 3) << "of camera 2 a lossy one and an exact one";
  request.exact = true;
  service_->render(request);
  EXPECT_EQ(cameras_->images, 3);
}

TEST_F(FrameLatencyTest, DoesNotWaitForTheNodesBetweenFrames) {
  service_->allow(true);
  seen_from(1);
  std::promise<void> nodes_are_done;
  cameras_->wait_for = nodes_are_done.get_future().share();
  EXPECT_EQ(seen_from(2), 1) << "while the nodes still draw";
  nodes_are_done.set_value();
  EXPECT_EQ(seen_from(3), 2);
}

TEST_F(FrameLatencyTest, ShowsOnlyImagesOfTheSameVolumeColoursAndWindow) {
  service_->allow(true);
  seen_from(1);
  EXPECT_EQ(seen_from(2), 1);
  ++version_;
  EXPECT_EQ(seen_from(3), 3) << "an image of the old texels is no image of the new ones";
  volume::RenderRequest request;
  request.version = version_;
  request.texture_to_clip[3] = 4;
  request.window = {0, 0, 7, 7};
  EXPECT_EQ(service_->render(request).image.rgba[0], 4);
  request.texture_to_clip[3] = 5;
  request.classification = volume::TransferFunction{.entries = {{0, 0, 0, 0}, {1, 1, 1, 1}}};
  EXPECT_EQ(service_->render(request).image.rgba[0], 5);
}

TEST_F(FrameLatencyTest, KeepsSeveralVolumesApart) {
  service_->allow(true);
  for (int frame = 0; frame < 4; ++frame)
    for (const volume::VolumeId id : {1, 2}) {
      volume::RenderRequest request;
      request.volume = id;
      request.texture_to_clip[3] = double(10 * frame) + double(id);
      EXPECT_EQ(service_->render(request).image.rgba[0], float(10 * std::max(0, frame - 1)) + float(id));
    }
}

TEST_F(FrameLatencyTest, CastsOnThreadsThatLeaveTheViewersSignalsAlone) {
  service_->allow(true);
  seen_from(1);
  EXPECT_FALSE(cameras_->blocks_signals) << "the viewer's own thread";
  seen_from(2);
  seen_from(3);
  EXPECT_TRUE(cameras_->blocks_signals);
}

TEST_F(FrameLatencyTest, TellsOfLostNodesWithTheNextImage) {
  service_->allow(true);
  seen_from(1);
  cameras_->is_lost = true;
  EXPECT_EQ(seen_from(2), 1);
  EXPECT_THROW(seen_from(3), compositor::ServiceLost);
  cameras_->is_lost = false;
  EXPECT_EQ(seen_from(4), 4);
}

}  // namespace
}  // namespace understudy::spu
