// SPDX-License-Identifier: Apache-2.0
// Scenes that are exported of an application above a real driver: rendered from their files alone, they show
// what the application drew; what a scene cannot hold is not exported, with the reason.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <span>
#include <string>

#include "apps/understudy/file_scene/scene_file.h"
#include "box_ray_caster.h"
#include "bricked_cube.h"
#include "compositor/rendered.h"
#include "compositor/service.h"
#include "slice_scenes.h"
#include "spu/options.h"
#include "spu/report/counters.h"
#include "spu/volume/scene_export/scene_files.h"
#include "tests/apps/viewer/temporary_folder.h"
#include "volume/file/file_error.h"

namespace understudy::spu::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class ExportedScenes : public ::testing::Test {
 protected:
  /// Null without EGL.
  std::unique_ptr<GlApplication> start(Profile profile, int verify = 0) {
    Options options;
    options.export_folder = folder_.file("scenes");
    options.speed_guard = false;
    options.verify = verify;
    return GlApplication::start(profile, options);
  }

  fs::path file(const std::string& name) const { return fs::path(folder_.file("scenes")) / name; }
  std::size_t files() const {
    return fs::exists(file("")) ? std::size_t(std::distance(fs::directory_iterator(file("")), {})) : 0;
  }

  /// The scene over a background that is cleared to `background`, as GlApplication::read_pixels() returns it.
  std::vector<float> rendered(const std::string& name, const std::array<float, 4>& background) const {
    const launcher::SceneFile scene = launcher::read_scene_file(file(name));
    const auto service = compositor::embedded_service();
    launcher::send_scene(scene, *service);
    const compositor::Rendered image = service->render(scene.scene.request);
    constexpr int size = GlApplication::size;
    std::vector<float> pixels;
    for (int i = 0; i < size * size; ++i) pixels.insert(pixels.end(), background.begin(), background.end());
    const volume::Rect& rect = image.image.rect;
    for (int y = 0; y < rect.height; ++y)
      for (int x = 0; x < rect.width; ++x) {
        const float* const from =
            &image.image.rgba[4 * (std::size_t(y) * std::size_t(rect.width) + std::size_t(x))];
        float* const to = &pixels[4 * (std::size_t(rect.y + y) * size + std::size_t(rect.x + x))];
        for (std::size_t k = 0; k < 4; ++k) to[k] = from[k] + (1 - from[3]) * to[k];
      }
    return pixels;
  }

  viewer_test::TemporaryFolder folder_;
};

/// PSNR of the colours alone: an application's alpha may mean something else.
double psnr_of_colours(std::vector<float> a, std::vector<float> b) {
  for (std::size_t i = 3; i < a.size(); i += 4) a[i] = b[i] = 0;
  return psnr(a, b);
}

std::vector<float> ray_caster_frame(GlApplication& app, BoxRayCaster& caster, bool under, double angle) {
  app.use_chain(under);
  caster.draw(app, angle);
  app.end_frame();
  return app.read_pixels();
}

struct Kind {
  const char* name;
  MarchStyle style;
};

class ExportedRayCaster : public ExportedScenes, public ::testing::WithParamInterface<Kind> {};

TEST_P(ExportedRayCaster, ShowsWhatTheApplicationDrew) {
  const auto app = start(Profile::core);
  if (!app) GTEST_SKIP() << "no core profile context here; install libegl1 and libgl1-mesa-dri";
  BoxRayCaster caster(GetParam().style);
  caster.set_up(*app);
  const auto own = ray_caster_frame(*app, caster, false, 20);
  const std::array<float, 4> background{own[0], own[1], own[2], own[3]};
  EXPECT_EQ(files(), 0U);
  ray_caster_frame(*app, caster, true, 20);
  ASSERT_EQ(app->substituted(), 1U) << app->last_reason();
  EXPECT_EQ(app->error(), GLenum(GL_NO_ERROR));
  ASSERT_TRUE(fs::exists(file("scene.json"))) << GlApplication::last_volume().not_exported;
  EXPECT_EQ(std::string(GlApplication::last_volume().scene), "scene.json");
  const double likeness = psnr_of_colours(rendered("scene.json", background), own);
  std::printf("%s: %.1f dB\n", GetParam().name, likeness);
  EXPECT_GE(likeness, 45);
  // Once is enough.
  const auto written = fs::last_write_time(file("scene.json"));
  ray_caster_frame(*app, caster, true, 60);
  EXPECT_EQ(fs::last_write_time(file("scene.json")), written);
  EXPECT_FALSE(fs::exists(file("scene_2.json")));
}

INSTANTIATE_TEST_SUITE_P(
    , ExportedRayCaster,
    ::testing::Values(Kind{"Over", {.extent = {1.0F, 1.3F, 0.7F}}}, Kind{"Divided", {.divided = true}},
                      Kind{"Noise", {.noisy = true}}, Kind{"Lit", {.lit_from_eye = true}},
                      Kind{"Clipped", {.clipping_planes = {{0.1F, 0.05F, 0, 0.8F, 0.6F, 0}}}}),
    [](const auto& info) { return std::string(info.param.name); });

TEST_F(ExportedScenes, OfSlicesShowsWhatTheApplicationDrew) {
  for (const SliceScene& scene : {immediate_rgba(), display_list_texgen(), client_arrays_table(),
                                  core_batched(), pre_integrated_slices(true)}) {
    fs::remove_all(file(""));
    const auto app = start(scene.profile);
    if (!app) GTEST_SKIP() << "no EGL context here; install libegl1 and libgl1-mesa-dri";
    scene.set_up(*app);
    const auto frame = [&](bool under) {
      app->use_chain(under);
      scene.draw(*app, 15);
      app->end_frame();
      return app->read_pixels();
    };
    const auto own = frame(false);
    const std::array<float, 4> background{own[0], own[1], own[2], own[3]};
    frame(true);
    ASSERT_EQ(app->substituted(), 1U) << scene.name << ": " << app->last_reason();
    ASSERT_TRUE(fs::exists(file("scene.json")))
        << scene.name << ": " << GlApplication::last_volume().not_exported;
    const double likeness = psnr_of_colours(rendered("scene.json", background), own);
    std::printf("%s: %.1f dB\n", scene.name.c_str(), likeness);
    EXPECT_GE(likeness, 45) << scene.name;
  }
}

TEST_F(ExportedScenes, WithoutComparisonsIsOfTheFirstImageThatShowsSomething) {
  const auto app = start(Profile::core, -1);
  if (!app) GTEST_SKIP() << "no core profile context here";
  BoxRayCaster caster{MarchStyle{}};
  caster.set_up(*app);
  caster.set_table(*app, 0);
  ray_caster_frame(*app, caster, true, 20);
  EXPECT_EQ(files(), 0U);
  caster.set_table(*app, 0.5F);
  ray_caster_frame(*app, caster, true, 20);
  ASSERT_EQ(app->substituted(), 2U) << app->last_reason();
  EXPECT_TRUE(fs::exists(file("scene.json"))) << GlApplication::last_volume().not_exported;
}

TEST_F(ExportedScenes, ChangesNoImage) {
  const SliceScene scene = client_arrays_table();
  std::vector<std::vector<float>> images;
  for (const bool exports : {false, true}) {
    Options options;
    options.speed_guard = false;
    if (exports) options.export_folder = folder_.file("scenes");
    const auto app = GlApplication::start(scene.profile, options);
    if (!app) GTEST_SKIP() << "no EGL context here";
    scene.set_up(*app);
    for (const double angle : {15.0, 15.0, 40.0}) {
      scene.draw(*app, angle);
      app->end_frame();
      images.push_back(app->read_pixels());
      EXPECT_EQ(app->error(), GLenum(GL_NO_ERROR));
    }
    EXPECT_EQ(app->substituted(), 3U);
    EXPECT_EQ(fs::exists(file("scene.json")), exports);
  }
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(images[i], images[i + 3]) << i;
}

TEST_F(ExportedScenes, OfAnUnwritableFolderChangesNothingElse) {
  std::ofstream(folder_.file("scenes")) << "a file";
  const auto app = start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here";
  const SliceScene scene = client_arrays_table();
  scene.set_up(*app);
  scene.draw(*app, 15);
  app->end_frame();
  EXPECT_EQ(app->substituted(), 1U);
  EXPECT_NE(std::string(GlApplication::last_volume().not_exported), "");
  EXPECT_EQ(std::string(GlApplication::last_volume().scene), "");
}

TEST_F(ExportedScenes, HaveNumbersThatProcessesOfARunDoNotShare) {
  fs::create_directories(file(""));
  const std::string folder = file("").string(), run = "/run/understudy-1", other = "/run/understudy-2";
  EXPECT_TRUE(claim_scene(folder, run, 1));
  EXPECT_FALSE(claim_scene(folder, run, 1)) << "another process of this run has it";
  EXPECT_TRUE(claim_scene(folder, run, 2));
  EXPECT_TRUE(claim_scene(folder, other, 1));
  EXPECT_TRUE(claim_scene(folder, "", 1)) << "without a launcher";
  EXPECT_TRUE(withdraw_claim(folder, run, 1));
  EXPECT_FALSE(withdraw_claim(folder, run, 1));
  EXPECT_TRUE(claim_scene(folder, run, 1));
}

TEST_F(ExportedScenes, OfAnEarlierRunAreRemovedWhenTheirNumberIsTaken) {
  fs::create_directories(file(""));
  const std::string folder = file("").string(), run = "/run/understudy-1";
  const SceneFiles files = scene_files(1);
  const auto leave_files = [&] {
    std::ofstream(file(files.scene)) << "{}";
    std::ofstream(file(files.colour_map)) << "[]";
  };
  leave_files();
  ASSERT_TRUE(claim_scene(folder, run, 1));
  EXPECT_FALSE(fs::exists(file(files.scene)));
  EXPECT_FALSE(fs::exists(file(files.colour_map)));
  leave_files();
  ASSERT_FALSE(claim_scene(folder, run, 1));
  EXPECT_TRUE(fs::exists(file(files.scene))) << "it is another process's";
}

class Zeros : public TexelSource {
 public:
  void read(const volume::TexelBox&, std::span<std::byte> texels) override {
    std::ranges::fill(texels, std::byte{0});
  }
};

TEST_F(ExportedScenes, BeyondTheLimitOfFilesAreNotWritten) {
  compositor::ExportedScene scene;
  scene.volume.size = {64, 64, 64};
  Zeros zeros;
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  rlimit low = before;
  low.rlim_cur = 64 * 64 * 64 - 1;
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &low), 0);
  std::string message;
  try {
    write_scene(file("").string(), scene_files(1), scene, zeros, {});
  } catch (const volume::FileError& error) {
    message = error.what();
  }
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  EXPECT_THAT(message, HasSubstr("ulimit -f"));
  EXPECT_EQ(files(), 0U);
}

TEST_F(ExportedScenes, OfAStackOfTexturesIsRefused) {
  const auto app = start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here";
  const SliceScene scene = texture_stack();
  scene.set_up(*app);
  scene.draw(*app, 10);
  app->end_frame();
  ASSERT_EQ(app->substituted(), 1U) << app->last_reason();
  EXPECT_THAT(std::string(GlApplication::last_volume().not_exported), HasSubstr("a stack of 2-D textures"));
  EXPECT_EQ(files(), 0U);
}

TEST_F(ExportedScenes, OfBricksIsRefused) {
  const auto app = start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here";
  const BrickedCube cube(*app, 12);
  for (int frame = 0; frame < 3; ++frame) {
    app->gl().Clear(GL_COLOR_BUFFER_BIT);
    cube.draw(*app, 15);
    app->end_frame();
  }
  ASSERT_GT(app->substituted(), cube.bricks()) << app->last_reason();
  EXPECT_TRUE(std::ranges::any_of(process_counters().volume, [](const VolumeCounters& volume) {
    return std::string(volume.not_exported).find("a brick of a volume") != std::string::npos;
  }));
  EXPECT_EQ(files(), 0U);
}

TEST_F(ExportedScenes, OfAMaximumIsRefused) {
  const auto app = start(Profile::core);
  if (!app) GTEST_SKIP() << "no core profile context here";
  BoxRayCaster caster{MarchStyle{.composition = MarchStyle::Composition::maximum}};
  caster.set_up(*app);
  ray_caster_frame(*app, caster, true, 20);
  ASSERT_EQ(app->substituted(), 1U) << app->last_reason();
  EXPECT_THAT(std::string(GlApplication::last_volume().not_exported), HasSubstr("a maximum"));
  EXPECT_EQ(files(), 0U);
}

TEST_F(ExportedScenes, OfTexelsThatChangeBeforeTheFrameEndsWaitsForAnotherFrame) {
  const auto app = start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here";
  const SliceScene scene = client_arrays_table();
  scene.set_up(*app);
  scene.draw(*app, 15);
  // The scene leaves its volume bound.
  const std::uint8_t texel = 77;
  app->gl().TexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, 0, 1, 1, 1, GL_LUMINANCE, GL_UNSIGNED_BYTE, &texel);
  app->end_frame();
  ASSERT_EQ(app->substituted(), 1U) << app->last_reason();
  EXPECT_THAT(std::string(GlApplication::last_volume().not_exported),
              HasSubstr("changed before the frame ended"));
  EXPECT_EQ(files(), 0U);
  scene.draw(*app, 15);
  app->end_frame();
  EXPECT_TRUE(fs::exists(file("scene.json"))) << GlApplication::last_volume().not_exported;
}

TEST_F(ExportedScenes, OfTexelsThatChangeInEveryFrameAreGivenUp) {
  const auto app = start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here";
  const SliceScene scene = client_arrays_table();
  scene.set_up(*app);
  for (std::uint8_t frame = 1; frame <= 4; ++frame) {
    scene.draw(*app, 15);
    app->gl().TexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, 0, 1, 1, 1, GL_LUMINANCE, GL_UNSIGNED_BYTE, &frame);
    app->end_frame();
    if (frame == 4) break;
    EXPECT_THAT(std::string(GlApplication::last_volume().not_exported),
                HasSubstr("changed before the frame ended"));
  }
  ASSERT_EQ(app->substituted(), 4U) << app->last_reason();
  EXPECT_THAT(std::string(GlApplication::last_volume().not_exported), HasSubstr("change in every frame"));
  scene.draw(*app, 15);
  app->end_frame();
  EXPECT_EQ(files(), 0U);
}

TEST_F(ExportedScenes, UnderPixelTransferWaitsForAnotherFrame) {
  const auto app = start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here";
  const SliceScene scene = client_arrays_table();
  scene.set_up(*app);
  scene.draw(*app, 15);
  // Ends the run, which is not recognised with such a state.
  std::array<std::uint8_t, 4> pixel{};
  app->gl().ReadPixels(0, 0, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, pixel.data());
  app->gl().PixelTransferf(GL_RED_SCALE, 0.5F);
  app->end_frame();
  app->gl().PixelTransferf(GL_RED_SCALE, 1);
  ASSERT_EQ(app->substituted(), 1U) << app->last_reason();
  EXPECT_THAT(std::string(GlApplication::last_volume().not_exported), HasSubstr("pixel transfer"));
  EXPECT_EQ(files(), 0U);
  scene.draw(*app, 15);
  app->end_frame();
  EXPECT_TRUE(fs::exists(file("scene.json"))) << GlApplication::last_volume().not_exported;
}

}  // namespace
}  // namespace understudy::spu::testing
