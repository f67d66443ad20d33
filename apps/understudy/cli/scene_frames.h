// SPDX-License-Identifier: Apache-2.0
// Images of one scene, with samples where a budget wants them, if there is one.
#pragma once

#include <optional>

#include "compositor/rendered.h"
#include "compositor/service.h"
#include "spu/volume/budget/budget.h"
#include "volume/description.h"
#include "volume/request.h"

namespace understudy::launcher {

struct RenderFigures;

class SceneFrames {
 public:
  /// `service` outlives this. `own` is what is shown without a budget.
  SceneFrames(compositor::ImageService& service, const volume::VolumeDescription& volume,
              const volume::RenderRequest& own, const spu::BudgetAsked& asked);
  /// Images are proven before they are shown, and not looked at again: where that takes long.
  void look_no_more() { looks_ = false; }

  /// In place of an image that a budget finds wrong by too much, another is made. Notes the request, the step,
  /// the time and what was counted. Throws as the service does, and std::invalid_argument where a budget cannot
  /// be kept.
  compositor::Rendered next(RenderFigures& figures);

 private:
  /// False: there is nothing to choose for, an empty image.
  bool choose_samples(RenderFigures& figures);

  compositor::ImageService& service_;
  volume::VolumeDescription volume_;
  volume::RenderRequest own_;
  std::optional<spu::Budget> budget_;
  bool looks_ = true;
};

}  // namespace understudy::launcher
