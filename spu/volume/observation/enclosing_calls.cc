// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/observation/enclosing_calls.h"

#include "spu/volume/observation/draw_observer.h"

namespace understudy::spu {
namespace {

/// Sets the observer's `Flag` to `Value`, then calls `Slot`.
template <auto Flag, bool Value, auto Slot, class... Arguments>
void APIENTRY note(Arguments... arguments) {
  DrawObserver& observer = DrawObserver::current();
  observer.*Flag = Value;
  (observer.next().*Slot)(arguments...);
}

template <auto Flag, bool Value, auto Slot, class... Arguments>
void fill(DispatchTable& table, void (APIENTRY* DispatchTable::*)(Arguments...)) {
  table.*Slot = note<Flag, Value, Slot, Arguments...>;
}

template <auto Flag, auto Begin, auto End>
void fill(DispatchTable& table) {
  fill<Flag, true, Begin>(table, Begin);
  fill<Flag, false, End>(table, End);
}

}  // namespace

void fill_enclosing_call_slots(DispatchTable& table) {
  using T = DispatchTable;
  using O = DrawObserver;
  fill<&O::conditional_render, &T::BeginConditionalRender, &T::EndConditionalRender>(table);
  fill<&O::conditional_render, &T::BeginConditionalRenderNV, &T::EndConditionalRenderNV>(table);
  fill<&O::transform_feedback, &T::BeginTransformFeedback, &T::EndTransformFeedback>(table);
  fill<&O::transform_feedback, &T::BeginTransformFeedbackEXT, &T::EndTransformFeedbackEXT>(table);
  fill<&O::transform_feedback, &T::BeginTransformFeedbackNV, &T::EndTransformFeedbackNV>(table);
}

}  // namespace understudy::spu
