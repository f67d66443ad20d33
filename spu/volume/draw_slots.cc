#include "spu/volume/draw_slots.h"

#include <numeric>
#include <vector>

#include "dispatch/pass_through.h"
#include "spu/stream/plain_calls.h"
#include "spu/track/calls.h"
#include "spu/volume/array_calls.h"
#include "spu/volume/client_arrays.h"
#include "spu/volume/conditional_render.h"
#include "spu/volume/texture_changes.h"
#include "spu/volume/volume_unit.h"

namespace understudy::spu {
namespace {

/// More elements in one draw than this are no slices.
constexpr GLsizei most_elements = 1 << 22;

VolumeUnit& here() {
  return *Chain::current()->find<VolumeUnit>();
}

struct CloseRun {
  static const DispatchTable& before(CallId) {
    VolumeUnit& unit = here();
    unit.close_run();
    // The call may be one that is looked at in the phase that is entered now.
    return unit.chain().face(unit, unit.chain().phase());
  }
};

struct IntoRun {
  static std::uint64_t call(CallId call, const std::uint64_t* words) {
    append_plain_call(here().run().calls(), call, words);
    return 0;
  }
};

/// Keeps the draw in the open run, or opens one; false: the application's draw is to be made now.
bool joins_run(VolumeUnit& unit) {
  return unit.chain().phase() == Phase::deferring || unit.opens_run();
}

void APIENTRY begin(GLenum mode) {
  VolumeUnit& unit = here();
  if (!joins_run(unit)) {
    unit.inside_begin = true;
    return unit.next().Begin(mode);
  }
  append_call(unit.run().calls(), &DispatchTable::Begin, mode);
  unit.run().inside_begin = true;
  ++unit.run().draws;
}

void APIENTRY end_in_run() {
  Run& run = here().run();
  append_call(run.calls(), &DispatchTable::End);
  run.inside_begin = false;
}

void APIENTRY end_while_watching() {
  VolumeUnit& unit = here();
  unit.inside_begin = false;
  unit.next().End();
}

void APIENTRY call_list(GLuint list) {
  VolumeUnit& unit = here();
  const auto record = unit.chain().group().list(list);
  const bool slices = record && record->draws && record->only_geometry;
  if (!slices || !joins_run(unit)) {
    unit.close_run();
    return unit.next().CallList(list);
  }
  append_call(unit.run().calls(), &DispatchTable::CallList, list);
  ++unit.run().draws;
}

/// Adds an array draw to the run; false when its arrays are not of a kind that can wait.
bool defer_arrays(VolumeUnit& unit, GLenum mode, GLint first, GLsizei count) {
  ArraySources sources;
  if (count < 0 || first < 0 || count > most_elements || read_array_sources(unit.context(), sources))
    return false;
  Run& run = unit.run();
  if (sources.client_memory) {
    std::vector<std::uint32_t> indices(static_cast<std::size_t>(count));
    std::iota(indices.begin(), indices.end(), std::uint32_t(first));
    append_elements(run.calls(), sources, mode, indices);
    run.expanded_arrays = true;
  } else {
    append_call(run.calls(), &DispatchTable::DrawArrays, mode, first, count);
    run.reads_arrays = true;
  }
  ++run.draws;
  return true;
}

void APIENTRY draw_arrays(GLenum mode, GLint first, GLsizei count) {
  VolumeUnit& unit = here();
  if (joins_run(unit) && defer_arrays(unit, mode, first, count)) return;
  unit.close_run();
  unit.next().DrawArrays(mode, first, count);
}

void APIENTRY multi_draw_arrays(GLenum mode, const GLint* first, const GLsizei* count, GLsizei draws) {
  VolumeUnit& unit = here();
  if (joins_run(unit)) {
    GLsizei done = 0;
    while (done < draws && defer_arrays(unit, mode, first[done], count[done])) ++done;
    if (done == draws) return;
    unit.close_run();
    unit.next().MultiDrawArrays(mode, first + done, count + done, draws - done);
    return;
  }
  unit.next().MultiDrawArrays(mode, first, count, draws);
}

std::size_t index_size(GLenum type) {
  return type == GL_UNSIGNED_BYTE ? 1 : type == GL_UNSIGNED_SHORT ? 2 : type == GL_UNSIGNED_INT ? 4 : 0;
}

bool defer_elements(VolumeUnit& unit, GLenum mode, GLsizei count, GLenum type, const void* indices) {
  const DispatchTable& gl = unit.next();
  ArraySources sources;
  const std::size_t size = index_size(type);
  if (count < 0 || count > most_elements || size == 0 || read_array_sources(unit.context(), sources))
    return false;
  GLint element_buffer = 0;
  gl.GetIntegerv(GL_ELEMENT_ARRAY_BUFFER_BINDING, &element_buffer);
  Run& run = unit.run();
  if (element_buffer != 0 && !sources.client_memory) {
    run.draw_elements(mode, count, type, indices);
  } else if (element_buffer == 0 && sources.client_memory && indices != nullptr) {
    std::vector<std::uint32_t> elements;
    elements.reserve(std::size_t(count));
    for (GLsizei i = 0; i < count; ++i) {
      const auto* at = static_cast<const std::byte*>(indices) + std::size_t(i) * size;
      std::uint32_t value = 0;
      std::memcpy(&value, at, size);  // little-endian, as every platform with OpenGL drivers of this kind is
      elements.push_back(value);
    }
    append_elements(run.calls(), sources, mode, elements);
    run.expanded_arrays = true;
  } else {
    return false;
  }
  ++run.draws;
  return true;
}

void APIENTRY draw_elements(GLenum mode, GLsizei count, GLenum type, const void* indices) {
  VolumeUnit& unit = here();
  if (joins_run(unit) && defer_elements(unit, mode, count, type, indices)) return;
  unit.close_run();
  unit.next().DrawElements(mode, count, type, indices);
}

void APIENTRY draw_range_elements(GLenum mode, GLuint start, GLuint stop, GLsizei count, GLenum type,
                                  const void* indices) {
  VolumeUnit& unit = here();
  if (joins_run(unit) && defer_elements(unit, mode, count, type, indices)) return;
  unit.close_run();
  unit.next().DrawRangeElements(mode, start, stop, count, type, indices);
}

/// More textures in a row than this are no stack.
constexpr std::size_t most_slices = 4096;

void APIENTRY bind_texture_in_run(GLenum target, GLuint texture) {
  VolumeUnit& unit = here();
  const bool slice = unit.run().pipeline().stack && target == GL_TEXTURE_2D && texture != 0 &&
                     !unit.run().inside_begin && unit.run().draws < most_slices;
  if (slice) return unit.run().bind_slice(texture);
  unit.close_run();
  unit.next().BindTexture(target, texture);
}

/// Who names the unit again before every slice changes nothing.
void APIENTRY active_texture_in_run(GLenum texture) {
  VolumeUnit& unit = here();
  const Pipeline& pipeline = unit.run().pipeline();
  if (pipeline.stack && texture == GLenum(GL_TEXTURE0 + pipeline.volume.unit) && !unit.run().inside_begin)
    return;
  unit.close_run();
  unit.next().ActiveTexture(texture);
}

void fill_draws(DispatchTable& table) {
  table.Begin = begin;
  table.CallList = call_list;
  table.DrawArrays = draw_arrays;
  table.DrawArraysEXT = draw_arrays;
  table.MultiDrawArrays = multi_draw_arrays;
  table.MultiDrawArraysEXT = multi_draw_arrays;
  table.DrawElements = draw_elements;
  table.DrawRangeElements = draw_range_elements;
  table.DrawRangeElementsEXT = draw_range_elements;
}

}  // namespace

void fill_watching_slots(DispatchTable& table) {
  fill_draws(table);
  fill_texture_change_slots(table);
  fill_conditional_render_slots(table);
  table.End = end_while_watching;
}

void fill_deferring_slots(DispatchTable& table) {
  PassThrough<CloseRun>::fill(table);
  DispatchTable appending{};
  AsWords<IntoRun>::fill_plain(appending);
  for (std::size_t i = 0; i < call_count; ++i) {
    if (kind_of(CallId(i)) != CallKind::vertex) continue;
    if (const AnyFunction append = slot(appending, CallId(i))) set_slot(table, CallId(i), append);
  }
  table.End = end_in_run;
  table.BindTexture = bind_texture_in_run;
  table.BindTextureEXT = bind_texture_in_run;
  table.ActiveTexture = active_texture_in_run;
  table.ActiveTextureARB = active_texture_in_run;
  fill_draws(table);
  fill_array_calls(table);
}

}  // namespace understudy::spu
