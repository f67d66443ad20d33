#include "apps/viewer/scene.h"

#include <GL/glew.h>
#include <fmt/format.h>

#include <cstdio>
#include <utility>

#include "apps/viewer/error.h"

namespace viewer {

namespace {

void report(const VolumeFacts& volume, const Texels& texels) {
  fmt::print("{}: {} {}, values {:g} to {:g}, drawn as {:g} -> 0, {:g} -> 1\n", volume.file,
             text_of(volume.size), name_of(volume.type), texels.lowest, texels.highest, volume.value_at_0,
             volume.value_at_1);
  if (volume.not_finite > 0)
    fmt::print(stderr,
               "understudy-viewer: warning: {}: {} of {} voxels are NaN or infinite and are shown as empty\n",
               volume.file, volume.not_finite, volume.size[0] * volume.size[1] * volume.size[2]);
}

}  // namespace

Scene::Scene(const Options& options, Volume volume)
    : box_(box_of(volume.size, volume.spacing)),
      slices_across_diagonal_(viewer::slices_across_diagonal(box_, options.slices)),
      frame_and_axes_(options.frame_and_axes),
      background_(options.background),
      opaque_(frame_and_axes(box_)) {
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
  mode_ = make_mode(options.mode, std::move(texels), volume_.file);
  set_preset(*options.preset);
}

double Scene::opacity_exponent() const {
  return 1.0 / (slices_across_diagonal_ * box_.finest_voxel_edge);
}

void Scene::set_preset(const Preset& preset) {
  preset_ = &preset;
  table_ = make_table(preset, opacity_exponent(), volume_.not_finite > 0);
  mode_->set_table(table_);
}

DrawnFrame Scene::draw(const Camera& camera, int width, int height) {
  DrawnFrame frame{camera, matrices_of(camera, width, height), width, height,
                   cut_slices(box_, view_direction(camera), slices_across_diagonal_)};
  glViewport(0, 0, width, height);
  glClearColor(static_cast<float>(background_[0]), static_cast<float>(background_[1]),
               static_cast<float>(background_[2]), 0.0F);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glEnable(GL_DEPTH_TEST);
  if (frame_and_axes_) mode_->draw_opaque(opaque_, frame.matrices);

  // Slices are hidden by what is solid, but never by each other.
  glDepthMask(GL_FALSE);
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  mode_->draw_slices(frame.stack, frame.matrices);
  glDisable(GL_BLEND);
  glDepthMask(GL_TRUE);

  if (const GLenum error = glGetError(); error != GL_NO_ERROR)
    throw Error(ExitCode::no_opengl,
                fmt::format("OpenGL reports error 0x{:x} while drawing; try another --mode", error));
  return frame;
}

}  // namespace viewer
