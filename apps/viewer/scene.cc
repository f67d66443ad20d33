// SPDX-License-Identifier: Apache-2.0
#include "apps/viewer/scene.h"

#include <GL/glew.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <utility>

#include "apps/viewer/model/error.h"

namespace viewer {

namespace {

void report(const VolumeFacts& volume, const Texels& texels) {
  fmt::print("{}: {} {}, values {:g} to {:g}, drawn as {:g} -> 0, {:g} -> 1\n", volume.file,
             text_of(volume.size), name_of(volume.type), texels.lowest, texels.highest, volume.value_at_0,
             volume.value_at_1);
  if (volume.not_finite > 0)
    fmt::print(stderr,
               "understudy-viewer: warning: {}: {} of {} voxels are NaN or infinite, and are shown as empty\n",
               volume.file, volume.not_finite, volume.size[0] * volume.size[1] * volume.size[2]);
}

}  // namespace

Scene::Scene(const Options& options, Volume volume)
    : box_(box_of(volume.size, volume.spacing)),
      slices_across_diagonal_(viewer::slices_across_diagonal(box_, options.slices)),
      op_(options.op),
      background_(options.background),
      write_depth_(options.write_depth) {
  if (options.frame_and_axes) opaque_ = frame_and_axes(box_);
  if (options.opaque_ball) add_ball(box_, opaque_);
  volume_.file = volume.file;
  volume_.size = volume.size;
  volume_.spacing = volume.spacing;
  volume_.type = volume.type;
  Texels texels = to_texels(std::move(volume));
  volume_.texel_format = texels.format;
  volume_.value_at_0 = texels.value_at_0;
  volume_.value_at_1 = texels.value_at_1;
  volume_.not_finite = texels.not_finite;
  report(volume_, texels);
  if (options.second_volume) second_ = make_mode(options.mode, texels, volume_.file, options.time_step);
  mode_ = make_mode(options.mode, std::move(texels), volume_.file, options.time_step);
  set_preset(*options.preset);
}

double Scene::opacity_exponent() const {
  return 1.0 / (slices_across_diagonal_ * box_.finest_voxel_edge);
}

void Scene::set_preset(const Preset& preset) {
  preset_ = &preset;
  table_ = make_table(preset, opacity_exponent(), volume_.not_finite > 0);
  mode_->set_table(colours_for(op_, table_));
  if (!second_) return;
  // The successor of a preset from a file is the first built-in one.
  const auto built_in = std::ranges::find(presets(), preset.name, &Preset::name);
  const auto next = built_in == presets().end()
                        ? std::size_t(0)
                        : static_cast<std::size_t>(built_in - presets().begin() + 1) % presets().size();
  second_table_ = make_table(presets()[next], opacity_exponent(), volume_.not_finite > 0);
  second_->set_table(colours_for(op_, second_table_));
}

void Scene::draw_volumes(DrawnFrame& frame) {
  const auto draw = [&](Mode& mode, const Table& table, double size, const Vec3& centre) {
    frame.volumes.push_back({size * box_.edges, centre - 0.5 * size * box_.edges, colours_for(op_, table)});
    Mat4 placed = translation(centre);
    for (const std::size_t diagonal : {0, 5, 10}) placed[diagonal] = size;
    mode.draw_slices(frame.stack, {frame.matrices.modelview * placed, frame.matrices.projection});
  };
  if (!second_) {
    draw(*mode_, table_, 1, {0, 0, 0});
    return;
  }
  // Both have half the size, and meet corner to corner in the box's centre.
  const auto draw_first = [&] { draw(*mode_, table_, 0.5, -0.25 * box_.edges); };
  const auto draw_second = [&] { draw(*second_, second_table_, 0.5, 0.25 * box_.edges); };
  const bool second_is_farther = dot(frame.stack.normal, box_.edges) > 0;
  if (second_is_farther != frame.stack.front_to_back) {
    draw_second();
    draw_first();
  } else {
    draw_first();
    draw_second();
  }
}

void Scene::draw_back_to_front(DrawnFrame& frame) {
  glClearColor(static_cast<float>(background_[0]), static_cast<float>(background_[1]),
               static_cast<float>(background_[2]), 0.0F);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glEnable(GL_DEPTH_TEST);
  if (!opaque_.triangles.empty()) mode_->draw_opaque(opaque_, frame.matrices);

  // Solid geometry hides slices, but slices never hide each other.
  glDepthMask(write_depth_ ? GL_TRUE : GL_FALSE);
  blend_with(op_);
  draw_volumes(frame);
  glDisable(GL_BLEND);
  glDepthMask(GL_TRUE);
}

void Scene::draw_front_to_back(DrawnFrame& frame) {
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glEnable(GL_DEPTH_TEST);
  // Solid geometry hides slices by its depth, and is visible through the slices before it: its
  // colour is drawn after them.
  glDepthFunc(GL_LEQUAL);
  if (!opaque_.triangles.empty()) {
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    mode_->draw_opaque(opaque_, frame.matrices);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  }
  glDepthMask(GL_FALSE);
  blend_with(op_);
  draw_volumes(frame);
  if (!opaque_.triangles.empty()) mode_->draw_opaque(opaque_, frame.matrices);
  glDisable(GL_DEPTH_TEST);
  const Mat4 unit = translation({0, 0, 0});
  mode_->draw_opaque(whole_image(to_float(background_)), {unit, unit});
  glDisable(GL_BLEND);
  glDepthMask(GL_TRUE);
}

DrawnFrame Scene::draw(const Camera& camera, int width, int height) {
  DrawnFrame frame{camera,
                   matrices_of(camera, width, height),
                   width,
                   height,
                   cut_slices(box_, view_direction(camera), slices_across_diagonal_),
                   {}};
  glViewport(0, 0, width, height);
  mode_->next_frame();
  if (second_) second_->next_frame();
  if (op_ == Operator::under) {
    frame.stack.front_to_back = true;
    std::reverse(frame.stack.slices.begin(), frame.stack.slices.end());
    draw_front_to_back(frame);
  } else {
    draw_back_to_front(frame);
  }

  if (const GLenum error = glGetError(); error != GL_NO_ERROR)
    throw Error(ExitCode::no_opengl,
                fmt::format("OpenGL reported error 0x{:x} while drawing; try another --mode", error));
  return frame;
}

}  // namespace viewer
