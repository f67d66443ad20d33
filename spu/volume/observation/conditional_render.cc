#include "spu/volume/observation/conditional_render.h"

#include "spu/volume/volume_unit.h"

namespace understudy::spu {
namespace {

template <auto Slot>
void APIENTRY begin(GLuint query, GLenum mode) {
  VolumeUnit& unit = *Chain::current()->find<VolumeUnit>();
  unit.conditional_render = true;
  (unit.next().*Slot)(query, mode);
}

template <auto Slot>
void APIENTRY end() {
  VolumeUnit& unit = *Chain::current()->find<VolumeUnit>();
  unit.conditional_render = false;
  (unit.next().*Slot)();
}

}  // namespace

void fill_conditional_render_slots(DispatchTable& table) {
  table.BeginConditionalRender = begin<&DispatchTable::BeginConditionalRender>;
  table.BeginConditionalRenderNV = begin<&DispatchTable::BeginConditionalRenderNV>;
  table.EndConditionalRender = end<&DispatchTable::EndConditionalRender>;
  table.EndConditionalRenderNV = end<&DispatchTable::EndConditionalRenderNV>;
}

}  // namespace understudy::spu
