// SPDX-License-Identifier: Apache-2.0
// Renders images of one scene; an error or time budget, if there is one, chooses the samples.
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
  /// `service` must outlive this object. `own` is rendered if there is no budget.
  SceneFrames(compositor::ImageService& service, const volume::VolumeDescription& volume,
              const volume::RenderRequest& own, const spu::BudgetAsked& asked);
  /// Disables checks of images after they are rendered, where these take long: images are
  /// proven before they are shown.
  void look_no_more() { looks_ = false; }

  /// Renders the next image. Repeats it with finer samples if its error is found to exceed the budget.
  /// Records the request, step, time and counts in `figures`. Throws as the service does, and
  /// std::invalid_argument if a budget cannot be kept.
  compositor::Rendered next(RenderFigures& figures);

 private:
  /// Returns false if the image is empty, so that there is nothing to choose for.
  bool choose_samples(RenderFigures& figures);

  compositor::ImageService& service_;
  volume::VolumeDescription volume_;
  volume::RenderRequest own_;
  std::optional<spu::Budget> budget_;
  bool looks_ = true;
};

}  // namespace understudy::launcher
