// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/observation/draw_observer.h"

#include <exception>
#include <utility>

#include "spu/track/share_group.h"

namespace understudy::spu {

const GlContext& DrawObserver::context() {
  if (!context_) context_ = describe_context(chain_.below(*this, Phase::plain));
  return *context_;
}

bool DrawObserver::opens_run() {
  if (begins_run()) return true;
  // Any other draw goes on top of the waiting runs, so they are shown first.
  settle_held();
  return false;
}

std::optional<Refusal> DrawObserver::refusal_of(const Pipeline& pipeline) {
  const GLuint texture = pipeline.volume.texture;
  if (conditional_render) return Refusal{"the slices are rendered conditionally"};
  if (transform_feedback && context_->version < 400) return Refusal{"transform feedback is active"};
  if (auto refusal = standing_refusal(texture, pipeline.program)) return refusal;
  if (chain_.group().is_rendered_to(texture))
    return Refusal{"the volume texture is rendered into, or another texture shares its texels"};
  return std::nullopt;
}

bool DrawObserver::begins_run() {
  if (inside_begin || chain_.group().is_left_to_driver() || !context().sufficient()) return false;
  PipelineFinding finding = read_pipeline(context(), chain_.group(), samplers_, stacks.possible());
  if (const auto* left = std::get_if<LeftAlone>(&finding)) {
    refuse_in_this_frame(left->texture, left->refusal);
    return false;
  }
  auto* const pipeline = std::get_if<Pipeline>(&finding);
  if (pipeline == nullptr || leaves_all(*pipeline)) return false;
  if (pipeline->stack) {
    if (conditional_render || (transform_feedback && context().version < 400)) return false;
  } else if (const auto refusal = refusal_of(*pipeline)) {
    refuse_in_this_frame(pipeline->volume.texture, *refusal);
    return false;
  }
  run_ = std::make_unique<Run>(std::move(*pipeline), calls_, context().core);
  chain_.set_phase(Phase::deferring);
  return true;
}

void DrawObserver::close_run() {
  if (!run_) return;
  closing_ = std::move(run_);
  chain_.set_phase(resting_phase());
  if (!substitutes(closing_)) {
    settle_held();
    draw(*closing_);
  }
  closing_.reset();
  chain_.set_phase(resting_phase());
}

void DrawObserver::draw(Run& run) {
  if (std::exchange(run.shown, true)) return;
  run.replay(*context().gl);
}

void DrawObserver::give_up() {
  try {
    settle_held();
  } catch (...) {
    // No run is held any more.
  }
  if (closing_) draw(*closing_);
  if (run_) draw(*run_);
}

void DrawObserver::stack_defined() {
  if (stacks.begin()) chain_.group().stacks_watched();
  if (chain_.phase() == Phase::plain) chain_.set_phase(Phase::watching);
}

void DrawObserver::end_stack_watch() {
  if (stacks.end()) chain_.group().stacks_left();
}

}  // namespace understudy::spu
