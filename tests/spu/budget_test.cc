// SPDX-License-Identifier: Apache-2.0
// Error and time budgets with a real render service, without OpenGL: the image keeps the requested error at a
// cost that decreases with the error; a budget that cannot be kept is reported.
#include "spu/volume/budget/budget.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <string>
#include <thread>

#include "compositor/rendered.h"
#include "compositor/service.h"
#include "spu/report/counters.h"
#include "tests/volume/fields.h"
#include "tests/volume/scenes.h"
#include "volume/footprint.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/reference/pixel_integral.h"
#include "volume/request.h"

namespace understudy::spu {
namespace {

using namespace volume::testing;
using volume::Image;
using volume::Method;
using volume::RenderRequest;

/// Simulates nodes on a busy machine: each image is late.
class LateService final : public compositor::RenderService {
 public:
  explicit LateService(compositor::RenderService& service) : service_(service) {}

  void begin_volume(const volume::VolumeDescription& volume) override { service_.begin_volume(volume); }
  void begin_change(volume::VolumeId id, std::uint64_t version) override { service_.begin_change(id, version); }
  void add_texels(volume::VolumeId id, std::span<const volume::TexelBox> boxes,
                  std::span<const std::byte> texels) override {
    service_.add_texels(id, boxes, texels);
  }
  void end_volume(volume::VolumeId id) override { service_.end_volume(id); }
  void forget_volume(volume::VolumeId id) override { service_.forget_volume(id); }
  compositor::Rendered render(const RenderRequest& request) override {
    std::this_thread::sleep_for(std::chrono::milliseconds(80));
    return service_.render(request);
  }
  std::vector<volume::PixelIntegral> integrals(const RenderRequest& request,
                                               std::span<const volume::Pixel> pixels, double most_ms) override {
    return service_.integrals(request, pixels, most_ms);
  }
  int nodes() const override { return service_.nodes(); }

 private:
  compositor::RenderService& service_;
};

class BudgetTest : public testing::Test {
 protected:
  /// About 40 slices of a viewer, through a field whose transfer function shows shells.
  void SetUp() override {
    texture = sampled(describe({40, 40, 40}, volume::TexelType::u8), sphere_field(0.35, 0.25));
    texture.description.version = 3;
    texture.description.ghost_layer = budget_ghost_layer;
    service->begin_volume(texture.description);
    const std::vector<volume::TexelBox> all{texture.description.stored};
    service->add_texels(texture.description.id, all, texture.texels);
    service->end_volume(texture.description.id);
    own = request_for(texture, usual_camera(90, 80), 90, 80, 40);
    own.version = 3;
    volume::TransferFunction table = smooth_table(65, 0.25F);
    for (std::size_t i = 0; i < 65; ++i)
      if (i < 10 || i % 9 > 4) table.entries[i] = {};
    own.classification = table;
    own.termination = 5e-6F;
  }

  std::optional<RenderRequest> ask(Budget& budget) {
    return budget.request(*service, own, "", texture.description, 1, counters);
  }

  /// Greatest error of any pixel, against the integral over the texture itself.
  double error_of(const RenderRequest& request) {
    const auto meaning = std::get<Meaning>(meaning_of(own, texture.description.size));
    const auto medium =
        volume::Medium::of_samples(std::get<volume::TransferFunction>(meaning.request.classification), 1);
    const auto field = volume::texture_field(texture.description, volume::Filter::linear, texture.texels);
    const Image shown = copy_of(service->render(request).image);
    double worst = 0;
    for (int y = 0; y < 80; ++y)
      for (int x = 0; x < 90; ++x) {
        const auto exact =
            volume::pixel_integral(field, texture.description.size, meaning.request, medium, x, y);
        const bool inside = x >= shown.rect.x && y >= shown.rect.y && x < shown.rect.x + shown.rect.width &&
                            y < shown.rect.y + shown.rect.height;
        for (std::size_t k = 0; k < 4; ++k)
          worst = std::max(worst, std::abs(exact[k] - (inside ? double(shown.at(x, y)[k]) : 0.0)));
      }
    return worst;
  }

  std::unique_ptr<compositor::RenderService> service = compositor::embedded_service();
  Texture texture;
  RenderRequest own;
  BudgetCounters counters{};
};

TEST_F(BudgetTest, SamplesOfTheirOwnTendToTheIntegral) {
  const auto meaning = meaning_of(own, texture.description.size);
  ASSERT_TRUE(std::holds_alternative<Meaning>(meaning)) << std::get<std::string>(meaning);
  for (const Method method : {Method::post_classified, Method::pre_integrated}) {
    double last = 1;
    for (const double step : {1.0, 0.25, 0.0625}) {
      const double error = error_of(sampled_as(std::get<Meaning>(meaning), {method, step, 5e-6F}));
      fmt::print("method {}, steps of {}: at most {:.2e}\n", int(method), step, error);
      EXPECT_LT(error, last);
      last = error;
    }
    EXPECT_LT(last, 4e-3);
  }
}

class EveryBudget : public BudgetTest, public testing::WithParamInterface<double> {};

TEST_P(EveryBudget, KeepsTheErrorInEveryPixel) {
  Budget budget({.error = GetParam()});
  const auto request = ask(budget);
  ASSERT_TRUE(request) << counters.note;
  const double error = error_of(*request);
  fmt::print("asked {:.4f}, measured {:.4f}, of all pixels {:.4f}: {}\n", GetParam(), counters.measured, error,
             counters.setting);
  EXPECT_LE(error, GetParam());
  EXPECT_LE(counters.measured, GetParam());
  EXPECT_GT(counters.measured, 0);
  EXPECT_STREQ(counters.note, "");
  EXPECT_EQ(counters.calibrations, 1U);
}

INSTANTIATE_TEST_SUITE_P(Errors, EveryBudget, testing::Values(0.5, 8 / 255.0, 2 / 255.0, 0.5 / 255));

TEST_F(BudgetTest, ABusyMachineKeepsTheErrorToo) {
  LateService late(*service);
  Budget budget({.error = 0.5 / 255});
  const auto request = budget.request(late, own, "", texture.description, 1, counters);
  ASSERT_TRUE(request) << counters.note;
  EXPECT_STREQ(counters.note, "");
  EXPECT_LE(error_of(*request), 0.5 / 255) << counters.setting;
}

TEST_F(BudgetTest, FewerSamplesAreTakenForALargerError) {
  // The errors are far apart: of the settings that keep an error, the one measured as fastest is taken, and
  // another load may reverse neighbours.
  std::uint64_t last = ~std::uint64_t(0);
  for (const double error : {0.5 / 255, 0.2}) {
    Budget budget({.error = error});
    const auto request = ask(budget);
    ASSERT_TRUE(request);
    volume::FrameCounts counts = service->render(*request).counts;
    EXPECT_LT(counts.samples, last) << error;
    last = counts.samples;
  }
}

TEST_F(BudgetTest, WhatCannotBeKeptIsSaidWithTheBestThereIs) {
  Budget budget({.error = 1e-12});
  ASSERT_TRUE(ask(budget));
  EXPECT_NE(std::string(counters.note).find("cannot be kept"), std::string::npos) << counters.note;
  EXPECT_NE(std::string(counters.note).find("is the best there is here, at"), std::string::npos);
  EXPECT_GT(counters.measured, 1e-12);
}

TEST_F(BudgetTest, TheSameSceneIsCalibratedOnceAndAnotherTableAgain) {
  Budget budget({.error = 0.01});
  ASSERT_TRUE(ask(budget));
  own.texture_to_clip = usual_camera(80, 90);
  ASSERT_TRUE(ask(budget));
  EXPECT_EQ(counters.calibrations, 1U) << "another camera";
  own.classification = smooth_table(65, 0.1F);
  ASSERT_TRUE(ask(budget));
  EXPECT_EQ(counters.calibrations, 2U) << "another table";
}

TEST_F(BudgetTest, AnImageThatIsWrongByMoreMakesTheNextFiner) {
  Budget budget({.error = 0.02});
  const auto first = ask(budget);
  ASSERT_TRUE(first);
  const std::string before = counters.setting;
  Image wrong = copy_of(service->render(*first).image);
  for (float& value : wrong.rgba) value += 0.1F;
  // Error checks take a fiftieth of the elapsed time, so some rays are checked sooner or later.
  const auto start = std::chrono::steady_clock::now();
  while (counters.images_over == 0 && std::chrono::steady_clock::now() - start < std::chrono::seconds(60))
    budget.look_at(*service, wrong.view(), 1, counters);
  EXPECT_GT(counters.images_over, 0U);
  EXPECT_GT(counters.rays, 0U);
  const auto next = ask(budget);
  ASSERT_TRUE(next);
  EXPECT_NE(before, counters.setting);
  EXPECT_LT(error_of(*next), error_of(*first));
}

TEST_F(BudgetTest, ATimeIsMetWithTheMostExactThatFits) {
  // The service reports how long images take, so the result does not depend on a clock.
  Budget budget({.ms = 20});
  ASSERT_TRUE(ask(budget));
  const Image image = copy_of(service->render(*ask(budget)).image);
  for (int frame = 0; frame < 200; ++frame) budget.look_at(*service, image.view(), 100, counters);
  ASSERT_TRUE(ask(budget));
  EXPECT_NE(std::string(counters.note).find("the time that is asked for cannot be kept"), std::string::npos)
      << "images take 100 ms whatever is done: " << counters.note;
  const std::string cheapest = counters.setting;
  for (int frame = 0; frame < 200; ++frame) budget.look_at(*service, image.view(), 1e-3, counters);
  ASSERT_TRUE(ask(budget));
  EXPECT_NE(cheapest, counters.setting) << "there is time for more";
  EXPECT_STREQ(counters.note, "");
}

TEST_F(BudgetTest, RequestsThatMeanTheirOwnSamplesKeepThem) {
  const auto reason = [&](auto change) {
    RenderRequest changed = own;
    change(changed);
    Budget budget({.error = 0.01});
    EXPECT_FALSE(budget.request(*service, changed, "", texture.description, 1, counters));
    return std::string(counters.note);
  };
  EXPECT_NE(reason([](RenderRequest& r) { r.op = volume::Operator::max; }).find("not composed by over"),
            std::string::npos);
  EXPECT_NE(reason([](RenderRequest& r) { r.classification = volume::LinearMap{}; }).find("colours already"),
            std::string::npos);
  EXPECT_NE(reason([](RenderRequest& r) { r.filter = volume::Filter::nearest; }).find("nearest"),
            std::string::npos);
  EXPECT_NE(reason([](RenderRequest& r) { r.planes.spacing = -r.planes.spacing; }).find("from the far end"),
            std::string::npos);
}

}  // namespace
}  // namespace understudy::spu
