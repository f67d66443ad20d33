// SPDX-License-Identifier: Apache-2.0
// Ten measured and computed volumes, drawn by every ray caster and compared with double precision: samples on
// the CPU and in OpenGL, and pre-integrated segments on the CPU.
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>

#include "tests/volume/scenes.h"
#include "volume/file/synthetic.h"
#include "volume/file/texel_stream.h"
#include "volume/frame_counts.h"
#include "volume/glsl/glsl_ray_caster.h"
#include "volume/image.h"
#include "volume/opening/open_volume.h"
#include "volume/orbit_camera.h"
#include "volume/raycast/ray_caster.h"
#include "volume/raycast/segment_scene.h"
#include "volume/reference/segment_sum.h"
#include "volume/request.h"

namespace understudy::volume::glsl {
namespace {

using namespace volume::testing;
namespace fs = std::filesystem;

constexpr int image_edge = 64;
/// Quadrature of every segment is slow, so it covers this many pixels per side in the middle of the image.
constexpr int quadrature_edge = 20;

struct Scene {
  const char* name;
  const char* volume;  ///< file in the data folder, or synthetic
  Vec3 spacing;
  double low, high;  ///< values between which colour and opacity change
  OrbitCamera camera;
};

constexpr std::array scenes{
    Scene{"head", "cthead_256x256x113_int16be.raw.gz", {1, 1, 2}, 400, 2500, {40, 15, 3}},
    Scene{"vessels", "aneurism_256x256x256_uint8.raw.gz", {1, 1, 1}, 20, 200, {30, 20, 3}},
    Scene{"tooth", "tooth_103x94x161_uint16be.raw.gz", {1, 1, 1}, 420, 1300, {-60, 10, 2.5}},
    Scene{"nucleon", "nucleon_41x41x41_uint8.raw.gz", {1, 1, 1}, 0, 250, {120, -35, 2}},
    Scene{"hurricane", "isabel/isabel_30.vti.gz", {4, 4, 4}, 5, 75, {15, 60, 2.2}},
    Scene{"shells, 8 bits", "synthetic:96x96x96:u8:shells", {1, 1, 1}, 0, 255, {30, 20, 3}},
    Scene{"shells, float, flat", "synthetic:120x100x40:f32:shells", {1, 1, 2.5}, 0, 1, {200, 40, 2.5}},
    Scene{"lobes, 16 bits", "synthetic:80x80x80:u16:lobes", {1, 1, 1}, 0, 65535, {10, 30, 2.5}},
    Scene{"lobes, from within", "synthetic:64x72x80:u8:lobes", {1, 1, 1}, 0, 255, {75, 5, 0.4}},
    Scene{"gyroid, float", "synthetic:128x128x128:f32:gyroid", {1, 1, 1}, 0.2, 0.9, {50, -20, 3}},
};

struct LoadedVolume {
  Texture texture;
  TexelMapping mapping;
  TexelFigures values;
};

LoadedVolume loaded(const std::string& name) {
  auto file = open_volume(name);
  const std::array<int, 3> size = file->description().size;
  TexelStream stream(std::move(file), {}, {{0, 0, 0}, size});
  LoadedVolume volume{{describe(size, stream.mapping().type), {}}, stream.mapping(), {}};
  while (!stream.done()) {
    const TexelStream::SliceSegment slice_segment = stream.next(1U << 24U);
    volume.texture.texels.insert(volume.texture.texels.end(), slice_segment.texels.begin(),
                                 slice_segment.texels.end());
  }
  volume.values = stream.figures();
  return volume;
}

/// Defined over all values of the volume; colour and opacity change between the scene's `low` and `high`.
TransferFunction table_of(const Scene& scene, const LoadedVolume& volume) {
  constexpr int entries = 33;
  const TexelFigures& values = volume.values;
  TransferFunction table{
      float(volume.mapping.normalised(values.low)), float(volume.mapping.normalised(values.high)), {}};
  for (int i = 0; i < entries; ++i) {
    const double value = values.low + (values.high - values.low) * i / (entries - 1);
    const auto v = float(std::clamp((value - scene.low) / (scene.high - scene.low), 0.0, 1.0));
    const float a = 0.15F * v * v;
    table.entries.push_back({a * v, a * (1 - v), a * 0.5F, a});
  }
  return table;
}

Image on_cpu(const BrickStore& store, const RenderRequest& request) {
  Image image(request.window);
  FrameCounts counts;
  raycast(store, request, image, counts);
  return image;
}

std::string figures(const Difference& d) {
  std::array<char, 40> text{};
  (void)std::snprintf(text.data(), text.size(), "max %.1e rms %.1e", d.max, d.rms);
  return text.data();
}

class TenScenes : public ::testing::TestWithParam<Scene> {};

TEST_P(TenScenes, AreWhatDoublePrecisionSays) {
  const Scene& scene = GetParam();
  std::string name = scene.volume;
  if (!is_synthetic(name)) {
    name = (fs::path(UNDERSTUDY_SOURCE_DIR) / "../shared/data" / name).lexically_normal().string();
    if (!fs::exists(name)) GTEST_SKIP() << name << " is not there";
  }
  LoadedVolume volume = loaded(name);
  Texture& texture = volume.texture;
  RenderRequest request =
      orbit_request(texture.description, scene.spacing, scene.camera, image_edge, image_edge, 1.3);
  request.classification = table_of(scene, volume);

  // Pre-integrated segments sample beyond a rank's own cells.
  RenderRequest segments = request;
  segments.method = Method::pre_integrated;
  segments.window = {(image_edge - quadrature_edge) / 2, (image_edge - quadrature_edge) / 2, quadrature_edge,
                     quadrature_edge};
  texture.description.ghost_layer = ghost_layer_needed(texture.description, segments);
  const BrickStore store = filled(texture);
  const Field field = texture_field(texture.description, Filter::linear, texture.texels);

  const ReferenceImage exact = slice_sum(field, request, request.window);
  const Difference by_samples = difference(on_cpu(store, request), exact);
  const Difference by_segments =
      difference(on_cpu(store, segments), segment_sum(field, texture.description, segments, segments.window));
  std::string line = "samples " + figures(by_samples) + "; segments " + figures(by_segments);
  EXPECT_LE(by_samples.max, 1e-3);
  EXPECT_LE(by_samples.rms, 1e-4);
  EXPECT_LE(by_segments.max, 1e-3);
  EXPECT_LE(by_segments.rms, 1e-4);

  for (const Platform platform : {Platform::egl, Platform::osmesa}) {
    line += platform == Platform::egl ? "; EGL " : "; OSMesa ";
    try {
      Device device(platform);
      GlslRayCaster caster(store, device);
      Image image(request.window);
      FrameCounts counts;
      caster.render(request, image, counts);
      const Difference by_opengl = difference(image, exact);
      line += figures(by_opengl);
      const bool filter_is_exact = device.description().find("llvmpipe") != std::string::npos;
      EXPECT_LE(by_opengl.max, filter_is_exact ? 3e-5 : 2e-2);
      EXPECT_LE(by_opengl.rms, filter_is_exact ? 1.5e-6 : 1e-3);
      EXPECT_EQ(caster.obstacle(segments), "pre-integrated segments") << "the CPU draws them";
    } catch (const ContextUnavailable& absent) {
      line += absent.what();
    }
  }
  std::printf("%-20s %s\n", scene.name, line.c_str());

  // Other sample positions give another image, so the comparison can fail.
  RenderRequest shifted = request;
  shifted.steps->first += 0.5;
  EXPECT_GT(difference(on_cpu(store, shifted), exact).rms, 2e-4);
}

INSTANTIATE_TEST_SUITE_P(Volumes, TenScenes, ::testing::ValuesIn(scenes),
                         [](const auto& info) { return "Number" + std::to_string(info.index + 1); });

}  // namespace
}  // namespace understudy::volume::glsl
