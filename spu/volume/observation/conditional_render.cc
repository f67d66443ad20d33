// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/observation/conditional_render.h"

#include "spu/volume/observation/draw_observer.h"

namespace understudy::spu {
namespace {

template <auto Slot>
void APIENTRY begin(GLuint query, GLenum mode) {
  DrawObserver& observer = *Chain::current()->find<DrawObserver>();
  observer.conditional_render = true;
  (observer.next().*Slot)(query, mode);
}

template <auto Slot>
void APIENTRY end() {
  DrawObserver& observer = *Chain::current()->find<DrawObserver>();
  observer.conditional_render = false;
  (observer.next().*Slot)();
}

}  // namespace

void fill_conditional_render_slots(DispatchTable& table) {
  table.BeginConditionalRender = begin<&DispatchTable::BeginConditionalRender>;
  table.BeginConditionalRenderNV = begin<&DispatchTable::BeginConditionalRenderNV>;
  table.EndConditionalRender = end<&DispatchTable::EndConditionalRender>;
  table.EndConditionalRenderNV = end<&DispatchTable::EndConditionalRenderNV>;
}

}  // namespace understudy::spu
