// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/observation/draw_observer.h"

#include <utility>

#include "spu/track/share_group.h"

namespace understudy::spu {

const GlContext& DrawObserver::context() {
  if (!context_) context_ = describe_context(chain_.below(*this, Phase::plain));
  return *context_;
}

bool DrawObserver::opens_run() {
  if (begins_run()) return true;
  // Whatever else is drawn now goes on top of what waits.
  settle_held();
  return false;
}

std::optional<Refusal> DrawObserver::refusal_of(const Pipeline& pipeline) {
  const GLuint texture = pipeline.volume.texture;
  if (conditional_render) return Refusal{"the slices are rendered conditionally"};
  if (auto refusal = standing_refusal(texture, pipeline.program)) return refusal;
  if (chain_.group().is_rendered_to(texture))
    return Refusal{"the volume texture is rendered into, or another texture shares its texels"};
  return std::nullopt;
}

bool DrawObserver::begins_run() {
  if (inside_begin || !context().sufficient()) return false;
  PipelineFinding finding = read_pipeline(context(), chain_.group(), samplers_, stacks.possible());
  if (const auto* left = std::get_if<LeftAlone>(&finding)) {
    refuse_in_this_frame(left->texture, left->refusal);
    return false;
  }
  auto* const pipeline = std::get_if<Pipeline>(&finding);
  if (pipeline == nullptr) return false;
  if (pipeline->stack) {
    if (conditional_render) return false;
  } else if (const auto refusal = refusal_of(*pipeline)) {
    refuse_in_this_frame(pipeline->volume.texture, *refusal);
    return false;
  }
  run_ = std::make_unique<Run>(std::move(*pipeline), calls_);
  chain_.set_phase(Phase::deferring);
  return true;
}

void DrawObserver::close_run() {
  if (!run_) return;
  std::unique_ptr<Run> run = std::move(run_);
  chain_.set_phase(resting_phase());
  if (!substitutes(run)) {
    settle_held();
    run->replay(*context().gl);
  }
  chain_.set_phase(resting_phase());
}

void DrawObserver::stack_defined() {
  if (stacks.begin()) chain_.group().stacks_watched();
  if (chain_.phase() == Phase::plain) chain_.set_phase(Phase::watching);
}

void DrawObserver::end_stack_watch() {
  if (stacks.end()) chain_.group().stacks_left();
}

}  // namespace understudy::spu
