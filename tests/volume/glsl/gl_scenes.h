// SPDX-License-Identifier: Apache-2.0
// Small scenes for the GLSL ray caster: every texel type, operator, wrapping and kind of step.
#pragma once

#include <vector>

#include "tests/volume/scenes.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/raycast/ray_caster.h"
#include "volume/request.h"

namespace understudy::volume::glsl::testing {

using namespace volume::testing;

constexpr int width = 61, height = 47;

struct Scene {
  const char* name;
  Texture texture;
  RenderRequest request;
};

/// Constant steps of about one texel.
inline RaySteps steps_of(double length) {
  RaySteps steps;
  steps.metric = {1 / length, 0, 0, 0, 1 / length, 0, 0, 0, 1 / length};
  steps.first = 0.5;
  return steps;
}

inline DepthImage tilted_wall(const RenderRequest& request) {
  DepthImage depth;
  depth.rect = request.window;
  const Vec4 middle = transform_point(request.texture_to_clip, {0.5, 0.5, 0.5}),
             end = transform_point(request.texture_to_clip, {1, 0.2, 0.9});
  const double there = (middle[2] / middle[3] + 1) / 2, slope = (end[2] / end[3] + 1) / 2 - there;
  const int middle_column = depth.rect.width / 2;
  for (int y = 0; y < depth.rect.height; ++y)
    for (int x = 0; x < depth.rect.width; ++x)
      depth.depth.push_back(float(there + slope * (x - middle_column) / depth.rect.width));
  return depth;
}

/// Only the highest values, above about 0.7, are visible.
inline TransferFunction sparse_table() {
  TransferFunction f;
  for (int i = 0; i < 64; ++i) {
    const float a = i < 44 ? 0.0F : 0.04F * float(i - 43);
    f.entries.push_back({a, 0.5F * a, 0.2F * a, a});
  }
  return f;
}

inline std::vector<Scene> scenes() {
  const Matrix4 usual = usual_camera(width, height);
  const Matrix4 inside =
      multiply(perspective(70, double(width) / height, 0.01, 10),
               multiply(look_at({0.1, -0.05, 0.2}, {-0.4, 0.1, -0.3}, {0, 1, 0}), unit_cube()));
  const Matrix4 orthographic = multiply(parallel(0.9, 0.8, -5, 5),
                                        multiply(look_at({0.9, 0.7, 1.6}, {0, 0, 0}, {0, 1, 0}), unit_cube()));
  std::vector<Scene> all;
  const auto add = [&](const char* name, Texture texture, const Matrix4& camera) -> RenderRequest& {
    all.push_back({name, std::move(texture), {}});
    all.back().request = request_for(all.back().texture, camera, width, height, 70);
    return all.back().request;
  };
  add("ball, bytes, planes", sampled(describe({64, 64, 64}, TexelType::u8), sphere_field(0.35)), usual);
  add("Marschner-Lobb, 16 bits, steps", sampled(describe({41, 41, 41}, TexelType::u16), marschner_lobb_field()),
      usual)
      .steps = steps_of(0.025);
  add("ramp, floats, planes",
      sampled(describe({33, 21, 50}, TexelType::f32), linear_field({0.4, 0.3, 0.2}, 0.05)), orthographic);
  RenderRequest& sparse =
      add("ball, sparse, steps", sampled(describe({70, 64, 57}, TexelType::u8), sphere_field(0.3)), usual);
  sparse.classification = sparse_table();
  sparse.steps = steps_of(0.016);
  sparse.termination = 1e-5F;
  RenderRequest& ended =
      add("noise, ends at an opacity", noise(describe({19, 23, 17}, TexelType::u8), 10), usual);
  ended.classification = smooth_table(256, 0.4F);
  ended.opacity_limit = 0.9F;
  add("noise, bytes, border", noise(describe({19, 23, 17}, TexelType::u8, Wrap::border), 1), usual);
  add("noise, 16 bits, repeated, nearest", noise(describe({19, 23, 17}, TexelType::u16, Wrap::repeat), 2),
      usual)
      .filter = Filter::nearest;
  add("noise, colours", noise(describe({24, 31, 29}, TexelType::rgba8), 3), usual);
  RenderRequest& maximum =
      add("noise, maximum, steps", noise(describe({37, 29, 41}, TexelType::u8), 4), orthographic);
  maximum.op = Operator::max;
  maximum.steps = steps_of(0.03);
  maximum.steps->divided = true;
  add("noise, minimum", noise(describe({24, 31, 29}, TexelType::u8), 5), usual).op = Operator::min;
  RenderRequest& sum = add("noise, sum, floats", noise(describe({24, 31, 29}, TexelType::f32), 6), usual);
  sum.op = Operator::add;
  sum.classification = smooth_table(256, 0.02F);
  add("noise, first hit", noise(describe({37, 29, 41}, TexelType::u16), 9), usual).op = Operator::first_hit;
  add("noise, from within", noise(describe({37, 29, 41}, TexelType::u8), 7), inside).steps = steps_of(0.03);
  RenderRequest& cut = add("ball, wall and clip plane",
                           sampled(describe({50, 50, 50}, TexelType::u8), sphere_field(0.4)), usual);
  cut.clip_planes = {{{1, 0.3, -0.2}, -0.4}};
  cut.depth = tilted_wall(cut);
  cut.region = {{0.03, 0, 0.05}, {0.97, 0.9, 1}};
  RenderRequest& jittered =
      add("noise, each ray begun elsewhere", noise(describe({37, 29, 41}, TexelType::u8), 8), usual);
  jittered.steps = steps_of(0.03);
  jittered.steps->offsets = RayOffsets{3, 2, {0.1F, 0.9F, 0.4F, 0.7F, 0, 0.3F}};
  return all;
}

struct GlImage {
  Image image;
  FrameCounts counts;
};

inline GlImage on_cpu(const Scene& scene) {
  GlImage image{Image(scene.request.window), {}};
  raycast(filled(scene.texture), scene.request, image.image, image.counts);
  return image;
}

}  // namespace understudy::volume::glsl::testing
