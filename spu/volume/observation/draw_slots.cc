// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/observation/draw_slots.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <exception>
#include <numeric>
#include <span>
#include <string_view>
#include <vector>

#include "dispatch/pass_through.h"
#include "spu/stream/plain_calls.h"
#include "spu/track/call_names.h"
#include "spu/track/calls.h"
#include "spu/track/share_group.h"
#include "spu/volume/observation/array_calls.h"
#include "spu/volume/observation/client_arrays.h"
#include "spu/volume/observation/draw_observer.h"
#include "spu/volume/observation/enclosing_calls.h"
#include "spu/volume/observation/indexed_state_calls.h"
#include "spu/volume/observation/passing_calls.h"
#include "spu/volume/observation/state_kinds.h"
#include "spu/volume/observation/texture_changes.h"

namespace understudy::spu {
namespace {

/// Draws of more elements are not deferred.
constexpr GLsizei most_elements = 1 << 22;

struct CloseRun {
  [[gnu::noinline]] static const DispatchTable& before(CallId call) {
    DrawObserver& observer = DrawObserver::current();
    observer.close_run();
    if (!passes_held_runs(call)) observer.settle_held();
    // The phase that begins now may handle the call, too.
    const Phase phase = observer.chain().phase();
    return phase == Phase::deferring ? observer.next() : observer.chain().face(observer, phase);
  }
};

template <auto Slot>
void APIENTRY switch_capability(GLenum capability) {
  DrawObserver& observer = DrawObserver::current();
  observer.close_run();
  if (!passes_held_runs(capability)) observer.settle_held();
  (observer.next().*Slot)(capability);
}

struct IntoRun {
  static constexpr bool chooses(std::string_view name) { return kind_of_name(name) == CallKind::vertex; }
  [[gnu::noinline]] static std::uint64_t call(CallId call, const std::uint64_t* words) {
    DrawObserver& observer = DrawObserver::current();
    if (observer.run_open()) {
      observer.run().set_attribute(call, words);
    } else {
      Records one;
      append_plain_call(one, call, words);
      make_plain_calls(one.words(), observer.next());
    }
    return 0;
  }
};

/// Keeps the draw in the open run, or opens a run; false if the application's draw is to be made now.
bool joins_run(DrawObserver& observer) {
  return observer.run_open() || observer.opens_run();
}

GLenum APIENTRY get_error() {
  DrawObserver& observer = DrawObserver::current();
  observer.close_run();
  const GLenum kept = observer.kept_errors.take();
  return kept != GL_NO_ERROR ? kept : observer.next().GetError();
}

void APIENTRY begin(GLenum mode) {
  DrawObserver& observer = DrawObserver::current();
  if (!joins_run(observer)) {
    observer.inside_begin = true;
    return observer.next().Begin(mode);
  }
  append_call(observer.run().calls(), &DispatchTable::Begin, mode);
  observer.run().only_polygons &= draws_polygons(mode);
  observer.run().inside_begin = true;
  ++observer.run().draws;
}

void APIENTRY end_in_run() {
  DrawObserver& observer = DrawObserver::current();
  if (!observer.run_open()) return observer.next().End();
  Run& run = observer.run();
  append_call(run.calls(), &DispatchTable::End);
  run.inside_begin = false;
}

void APIENTRY end_while_watching() {
  DrawObserver& observer = DrawObserver::current();
  observer.inside_begin = false;
  observer.next().End();
}

void APIENTRY draw_list(GLuint list) {
  DrawObserver& observer = DrawObserver::current();
  const auto record = observer.chain().group().list(list);
  const bool slices = record && record->draws && record->only_geometry;
  if (!slices || !joins_run(observer)) {
    observer.settle();
    return observer.next().CallList(list);
  }
  observer.run().call_list(list);
  observer.run().only_polygons &= record->only_polygons;
  ++observer.run().draws;
}

/// Returns whether all counts may be those of slices; draws with invalid or enormous counts are passed on.
bool all_wait(std::span<const GLsizei> counts) {
  return std::all_of(counts.begin(), counts.end(),
                     [](GLsizei count) { return count >= 0 && count <= most_elements; });
}

/// In its scope a draw is added to a run: completely, or, after an exception, not at all.
class WholeDraw {
 public:
  explicit WholeDraw(Run& run) : run_(run), begin_(run.mark()) {}
  ~WholeDraw() {
    if (std::uncaught_exceptions() > exceptions_) run_.rewind(begin_);
  }
  WholeDraw(const WholeDraw&) = delete;
  WholeDraw& operator=(const WholeDraw&) = delete;

 private:
  Run& run_;
  const Run::Mark begin_;
  const int exceptions_ = std::uncaught_exceptions();
};

/// Adds one draw of vertices `first[i]`... to the run; false if its arrays cannot be deferred.
bool defer_arrays(DrawObserver& observer, GLenum mode, std::span<const GLint> first,
                  std::span<const GLsizei> count) {
  ArraySources sources;
  if (!all_wait(count) || std::any_of(first.begin(), first.end(), [](GLint f) { return f < 0; }) ||
      read_array_sources(observer.context(), sources))
    return false;
  Run& run = observer.run();
  const WholeDraw whole(run);
  if (sources.client_memory) {
    std::vector<std::vector<std::uint32_t>> parts;
    for (std::size_t i = 0; i < count.size(); ++i) {
      std::vector<std::uint32_t>& elements = parts.emplace_back(static_cast<std::size_t>(count[i]));
      std::iota(elements.begin(), elements.end(), std::uint32_t(first[i]));
    }
    run.draw_memory(sources, mode, parts);
  } else {
    run.draw_arrays(mode, first, count);
  }
  run.only_polygons &= draws_polygons(mode);
  ++run.draws;
  return true;
}

void APIENTRY draw_arrays(GLenum mode, GLint first, GLsizei count) {
  DrawObserver& observer = DrawObserver::current();
  if (joins_run(observer) && defer_arrays(observer, mode, {&first, 1}, {&count, 1})) return;
  observer.settle();
  observer.next().DrawArrays(mode, first, count);
}

void APIENTRY multi_draw_arrays(GLenum mode, const GLint* first, const GLsizei* count, GLsizei draws) {
  DrawObserver& observer = DrawObserver::current();
  const auto n = std::size_t(std::max(draws, 0));
  if (n > 0 && joins_run(observer) && defer_arrays(observer, mode, {first, n}, {count, n})) return;
  observer.settle();
  observer.next().MultiDrawArrays(mode, first, count, draws);
}

std::size_t index_size(GLenum type) {
  return type == GL_UNSIGNED_BYTE ? 1 : type == GL_UNSIGNED_SHORT ? 2 : type == GL_UNSIGNED_INT ? 4 : 0;
}

/// Returns the indices of `range`, which lie in the application's memory.
std::vector<std::uint32_t> elements_in_memory(const ElementPart& range, std::size_t size) {
  std::vector<std::uint32_t> elements;
  elements.reserve(std::size_t(range.count));
  for (GLsizei i = 0; i < range.count; ++i) {
    const auto* at = static_cast<const std::byte*>(range.offset) + std::size_t(i) * size;
    std::uint32_t value = 0;
    std::memcpy(&value, at, size);  // little-endian, as on every platform with such OpenGL drivers
    elements.push_back(value + std::uint32_t(range.base_vertex));
  }
  return elements;
}

bool defer_elements(DrawObserver& observer, GLenum mode, std::span<const ElementPart> ranges, GLenum type) {
  const DispatchTable& gl = observer.next();
  ArraySources sources;
  const std::size_t size = index_size(type);
  const bool can_wait = std::all_of(ranges.begin(), ranges.end(), [](const ElementPart& range) {
    return range.count >= 0 && range.count <= most_elements;
  });
  if (!can_wait || size == 0 || read_array_sources(observer.context(), sources)) return false;
  GLint element_buffer = 0;
  gl.GetIntegerv(GL_ELEMENT_ARRAY_BUFFER_BINDING, &element_buffer);
  Run& run = observer.run();
  const WholeDraw whole(run);
  const bool somewhere = std::all_of(ranges.begin(), ranges.end(),
                                     [](const ElementPart& range) { return range.offset != nullptr; });
  if (element_buffer != 0 && !sources.client_memory) {
    run.draw_elements(mode, ranges, type);
  } else if (element_buffer == 0 && sources.client_memory && somewhere &&
             !restarts_primitives(observer.context())) {
    std::vector<std::vector<std::uint32_t>> parts;
    for (const ElementPart& range : ranges) parts.push_back(elements_in_memory(range, size));
    run.draw_memory(sources, mode, parts);
  } else {
    return false;
  }
  run.only_polygons &= draws_polygons(mode);
  ++run.draws;
  return true;
}

/// Adds one range of elements to the run; false if the application draws.
bool joins_run(DrawObserver& observer, GLenum mode, const ElementPart& range, GLenum type) {
  if (joins_run(observer) && defer_elements(observer, mode, {&range, 1}, type)) return true;
  observer.settle();
  return false;
}

void APIENTRY draw_elements(GLenum mode, GLsizei count, GLenum type, const void* indices) {
  DrawObserver& observer = DrawObserver::current();
  if (!joins_run(observer, mode, {count, indices}, type))
    observer.next().DrawElements(mode, count, type, indices);
}

void APIENTRY draw_range_elements(GLenum mode, GLuint start, GLuint stop, GLsizei count, GLenum type,
                                  const void* indices) {
  DrawObserver& observer = DrawObserver::current();
  if (!joins_run(observer, mode, {count, indices}, type))
    observer.next().DrawRangeElements(mode, start, stop, count, type, indices);
}

void APIENTRY draw_elements_base_vertex(GLenum mode, GLsizei count, GLenum type, const void* indices,
                                        GLint base_vertex) {
  DrawObserver& observer = DrawObserver::current();
  if (!joins_run(observer, mode, {count, indices, base_vertex}, type))
    observer.next().DrawElementsBaseVertex(mode, count, type, indices, base_vertex);
}

void APIENTRY draw_range_elements_base_vertex(GLenum mode, GLuint start, GLuint stop, GLsizei count,
                                              GLenum type, const void* indices, GLint base_vertex) {
  DrawObserver& observer = DrawObserver::current();
  if (!joins_run(observer, mode, {count, indices, base_vertex}, type))
    observer.next().DrawRangeElementsBaseVertex(mode, start, stop, count, type, indices, base_vertex);
}

/// Adds several ranges of one call, without base vertices if `base_vertices` is null.
bool joins_run(DrawObserver& observer, GLenum mode, GLsizei draws, const GLsizei* count,
               const void* const* indices, const GLint* base_vertices, GLenum type) {
  std::vector<ElementPart> ranges;
  ranges.reserve(std::size_t(std::max(draws, 0)));
  for (GLsizei i = 0; i < draws; ++i)
    ranges.push_back({count[i], indices[i], base_vertices != nullptr ? base_vertices[i] : 0});
  if (!ranges.empty() && joins_run(observer) && defer_elements(observer, mode, ranges, type)) return true;
  observer.settle();
  return false;
}

void APIENTRY multi_draw_elements(GLenum mode, const GLsizei* count, GLenum type, const void* const* indices,
                                  GLsizei draws) {
  DrawObserver& observer = DrawObserver::current();
  if (!joins_run(observer, mode, draws, count, indices, nullptr, type))
    observer.next().MultiDrawElements(mode, count, type, indices, draws);
}

void APIENTRY multi_draw_elements_base_vertex(GLenum mode, const GLsizei* count, GLenum type,
                                              const void* const* indices, GLsizei draws,
                                              const GLint* base_vertices) {
  DrawObserver& observer = DrawObserver::current();
  if (!joins_run(observer, mode, draws, count, indices, base_vertices, type))
    observer.next().MultiDrawElementsBaseVertex(mode, count, type, indices, draws, base_vertices);
}

/// Returns whether arrays, and also indices if `elements` are drawn, lie in buffers.
bool reads_buffers(DrawObserver& observer, bool elements) {
  ArraySources sources;
  if (read_array_sources(observer.context(), sources) || sources.client_memory) return false;
  GLint element_buffer = 0;
  if (elements) observer.next().GetIntegerv(GL_ELEMENT_ARRAY_BUFFER_BINDING, &element_buffer);
  return !elements || element_buffer != 0;
}

/// Adds a draw from buffers with `instances` instances to the run, by `add`; false if the application draws.
template <class Add>
bool joins_run_instanced(DrawObserver& observer, GLenum mode, GLsizei count, GLsizei instances, bool elements,
                         Add add) {
  const bool can_wait = count >= 0 && instances > 0 && std::int64_t(count) * instances <= most_elements;
  if (can_wait && joins_run(observer) && reads_buffers(observer, elements)) {
    Run& run = observer.run();
    const WholeDraw whole(run);
    add(run);
    run.only_polygons &= draws_polygons(mode);
    ++run.draws;
    return true;
  }
  observer.settle();
  return false;
}

bool joins_run_instanced(DrawObserver& observer, GLenum mode, const ElementPart& range, GLenum type,
                         GLsizei instances) {
  // An invalid type is treated like a negative count: the draw call is passed on.
  const GLsizei count = index_size(type) != 0 ? range.count : -1;
  return joins_run_instanced(observer, mode, count, instances, true,
                             [&](Run& run) { run.draw_elements_instanced(mode, range, type, instances); });
}

void APIENTRY draw_arrays_instanced(GLenum mode, GLint first, GLsizei count, GLsizei instances) {
  DrawObserver& observer = DrawObserver::current();
  const GLsizei vertices = first >= 0 ? count : -1;
  if (!joins_run_instanced(observer, mode, vertices, instances, false,
                           [&](Run& run) { run.draw_arrays_instanced(mode, first, count, instances); }))
    observer.next().DrawArraysInstanced(mode, first, count, instances);
}

void APIENTRY draw_elements_instanced(GLenum mode, GLsizei count, GLenum type, const void* indices,
                                      GLsizei instances) {
  DrawObserver& observer = DrawObserver::current();
  if (!joins_run_instanced(observer, mode, {count, indices}, type, instances))
    observer.next().DrawElementsInstanced(mode, count, type, indices, instances);
}

void APIENTRY draw_elements_instanced_base_vertex(GLenum mode, GLsizei count, GLenum type, const void* indices,
                                                  GLsizei instances, GLint base_vertex) {
  DrawObserver& observer = DrawObserver::current();
  if (!joins_run_instanced(observer, mode, {count, indices, base_vertex}, type, instances))
    observer.next().DrawElementsInstancedBaseVertex(mode, count, type, indices, instances, base_vertex);
}

/// Draw commands, as OpenGL lays them out in a buffer.
struct ArraysCommand {
  GLuint count, instances, first, base_instance;
};
struct ElementsCommand {
  GLuint count, instances, first_index;
  GLint base_vertex;
  GLuint base_instance;
};

/// Returns the draw commands at `indirect`; none if they cannot be read, are invalid, or use instances.
template <class Command>
std::vector<Command> indirect_commands(DrawObserver& observer, const void* indirect, GLsizei draws,
                                       GLsizei stride) {
  constexpr GLsizei most_draws = 1 << 16;
  const DispatchTable& gl = observer.next();
  const std::size_t step = stride != 0 ? std::size_t(stride) : sizeof(Command);
  if (draws <= 0 || draws > most_draws || stride < 0 || step % 4 != 0) return {};
  const std::size_t bytes = step * std::size_t(draws - 1) + sizeof(Command);
  std::vector<std::byte> memory(bytes);
  GLint buffer = 0;
  gl.GetIntegerv(GL_DRAW_INDIRECT_BUFFER_BINDING, &buffer);
  if (buffer != 0) {
    GLint size = 0;
    GLint mapped = 0;
    gl.GetBufferParameteriv(GL_DRAW_INDIRECT_BUFFER, GL_BUFFER_SIZE, &size);
    gl.GetBufferParameteriv(GL_DRAW_INDIRECT_BUFFER, GL_BUFFER_MAPPED, &mapped);
    const auto offset = reinterpret_cast<std::uintptr_t>(indirect);
    if (mapped != 0 || offset % 4 != 0 || offset > std::size_t(size) || bytes > std::size_t(size) - offset)
      return {};
    gl.GetBufferSubData(GL_DRAW_INDIRECT_BUFFER, GLintptr(offset), GLsizeiptr(bytes), memory.data());
  } else if (!observer.context().core && indirect != nullptr) {
    std::memcpy(memory.data(), indirect, bytes);
  } else {
    return {};
  }
  std::vector<Command> commands(static_cast<std::size_t>(draws));
  for (std::size_t i = 0; i < commands.size(); ++i)
    std::memcpy(&commands[i], memory.data() + i * step, sizeof(Command));
  const bool plain = std::all_of(commands.begin(), commands.end(), [](const Command& command) {
    return command.instances == 1 && command.base_instance == 0 && command.count <= GLuint(most_elements);
  });
  return plain ? commands : std::vector<Command>{};
}

bool joins_run_indirectly(DrawObserver& observer, GLenum mode, const void* indirect, GLsizei draws,
                          GLsizei stride) {
  if (joins_run(observer)) {
    std::vector<GLint> first;
    std::vector<GLsizei> count;
    for (const auto& command : indirect_commands<ArraysCommand>(observer, indirect, draws, stride)) {
      first.push_back(GLint(command.first));
      count.push_back(GLsizei(command.count));
    }
    if (!count.empty() && defer_arrays(observer, mode, first, count)) return true;
  }
  observer.settle();
  return false;
}

bool joins_run_indirectly(DrawObserver& observer, GLenum mode, GLenum type, const void* indirect, GLsizei draws,
                          GLsizei stride) {
  if (joins_run(observer)) {
    std::vector<ElementPart> parts;
    for (const auto& command : indirect_commands<ElementsCommand>(observer, indirect, draws, stride)) {
      const std::uintptr_t offset = std::uintptr_t(command.first_index) * index_size(type);
      parts.push_back({GLsizei(command.count), reinterpret_cast<const void*>(offset), command.base_vertex});
    }
    GLint element_buffer = 0;
    observer.next().GetIntegerv(GL_ELEMENT_ARRAY_BUFFER_BINDING, &element_buffer);
    if (element_buffer != 0 && !parts.empty() && defer_elements(observer, mode, parts, type)) return true;
  }
  observer.settle();
  return false;
}

void APIENTRY draw_arrays_indirect(GLenum mode, const void* indirect) {
  DrawObserver& observer = DrawObserver::current();
  if (!joins_run_indirectly(observer, mode, indirect, 1, 0)) observer.next().DrawArraysIndirect(mode, indirect);
}

void APIENTRY draw_elements_indirect(GLenum mode, GLenum type, const void* indirect) {
  DrawObserver& observer = DrawObserver::current();
  if (!joins_run_indirectly(observer, mode, type, indirect, 1, 0))
    observer.next().DrawElementsIndirect(mode, type, indirect);
}

void APIENTRY multi_draw_arrays_indirect(GLenum mode, const void* indirect, GLsizei draws, GLsizei stride) {
  DrawObserver& observer = DrawObserver::current();
  if (!joins_run_indirectly(observer, mode, indirect, draws, stride))
    observer.next().MultiDrawArraysIndirect(mode, indirect, draws, stride);
}

void APIENTRY multi_draw_elements_indirect(GLenum mode, GLenum type, const void* indirect, GLsizei draws,
                                           GLsizei stride) {
  DrawObserver& observer = DrawObserver::current();
  if (!joins_run_indirectly(observer, mode, type, indirect, draws, stride))
    observer.next().MultiDrawElementsIndirect(mode, type, indirect, draws, stride);
}

/// More textures in a row are not a stack.
constexpr std::size_t most_slices = 4096;

void APIENTRY bind_texture_in_run(GLenum target, GLuint texture) {
  DrawObserver& observer = DrawObserver::current();
  const bool slice = observer.run_open() && observer.run().pipeline().stack && target == GL_TEXTURE_2D &&
                     texture != 0 && !observer.run().inside_begin && observer.run().draws < most_slices;
  if (slice) return observer.run().bind_slice(texture);
  observer.close_run();
  observer.next().BindTexture(target, texture);
}

/// Selecting the stack's unit again before every slice changes nothing.
void APIENTRY active_texture_in_run(GLenum texture) {
  DrawObserver& observer = DrawObserver::current();
  const Pipeline* const pipeline = observer.run_open() ? &observer.run().pipeline() : nullptr;
  if (pipeline != nullptr && pipeline->stack && texture == GLenum(GL_TEXTURE0 + pipeline->volume.unit) &&
      !observer.run().inside_begin)
    return;
  observer.close_run();
  observer.next().ActiveTexture(texture);
}

/// Also under their extension names, if the driver has the core calls, which runs use.
void fill_instanced_draws(DispatchTable& table) {
  if (table.DrawArraysInstanced != nullptr) {
    table.DrawArraysInstanced = draw_arrays_instanced;
    table.DrawArraysInstancedARB = draw_arrays_instanced;
    table.DrawArraysInstancedEXT = draw_arrays_instanced;
  }
  if (table.DrawElementsInstanced != nullptr) {
    table.DrawElementsInstanced = draw_elements_instanced;
    table.DrawElementsInstancedARB = draw_elements_instanced;
    table.DrawElementsInstancedEXT = draw_elements_instanced;
  }
  if (table.DrawElementsInstancedBaseVertex != nullptr)
    table.DrawElementsInstancedBaseVertex = draw_elements_instanced_base_vertex;
}

void fill_draws(DispatchTable& table) {
  table.Begin = begin;
  table.CallList = draw_list;
  table.DrawArrays = draw_arrays;
  table.DrawArraysEXT = draw_arrays;
  table.MultiDrawArrays = multi_draw_arrays;
  table.MultiDrawArraysEXT = multi_draw_arrays;
  table.DrawElements = draw_elements;
  table.DrawRangeElements = draw_range_elements;
  table.DrawRangeElementsEXT = draw_range_elements;
  table.DrawElementsBaseVertex = draw_elements_base_vertex;
  table.DrawRangeElementsBaseVertex = draw_range_elements_base_vertex;
  table.DrawArraysIndirect = draw_arrays_indirect;
  table.DrawElementsIndirect = draw_elements_indirect;
  table.MultiDrawArraysIndirect = multi_draw_arrays_indirect;
  table.MultiDrawElementsIndirect = multi_draw_elements_indirect;
  table.MultiDrawElements = multi_draw_elements;
  table.MultiDrawElementsEXT = multi_draw_elements;
  table.MultiDrawElementsBaseVertex = multi_draw_elements_base_vertex;
  fill_instanced_draws(table);
}

}  // namespace

void fill_watching_slots(DispatchTable& table) {
  fill_state_kind_slots(table);
  fill_draws(table);
  fill_texture_change_slots(table);
  fill_enclosing_call_slots(table);
  fill_indexed_state_slots(table);
  table.End = end_while_watching;
}

void fill_deferring_slots(DispatchTable& table) {
  PassThrough<CloseRun>::fill(table);
  AsWords<IntoRun>::fill_chosen(table);
  table.End = end_in_run;
  table.BindTexture = bind_texture_in_run;
  table.BindTextureEXT = bind_texture_in_run;
  table.ActiveTexture = active_texture_in_run;
  table.ActiveTextureARB = active_texture_in_run;
  table.Enable = switch_capability<&DispatchTable::Enable>;
  table.Disable = switch_capability<&DispatchTable::Disable>;
  fill_draws(table);
  fill_array_calls(table);
}

void fill_error_slot(DispatchTable& table) {
  table.GetError = get_error;
}

}  // namespace understudy::spu
