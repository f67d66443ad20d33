// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/observation/run.h"

#include <algorithm>

#include "spu/stream/plain_calls.h"

namespace understudy::spu {

void Run::bind_slice(GLuint texture) {
  append_call(calls_, &DispatchTable::BindTexture, GL_TEXTURE_2D, texture);
  // For feedback mode; core profiles have neither it nor fixed-function vertices.
  if (!pipeline_.vertex_shader) append_call(calls_, &DispatchTable::PassThrough, GLfloat(slices_.size()));
  slices_.push_back({texture, draws});
}

void Run::draw_arrays(GLenum mode, std::span<const GLint> first, std::span<const GLsizei> count) {
  reads_arrays = true;
  if (count.size() == 1) {
    append_call(calls_, &DispatchTable::DrawArrays, mode, first[0], count[0]);
    attributes_read_ = calls_.words().size();
    return;
  }
  attributes_read_ = calls_.words().size();
  buffer_draws_.push_back({calls_.words().size(), mode, 0, counts_.size(), count.size()});
  counts_.insert(counts_.end(), count.begin(), count.end());
  first_.insert(first_.end(), first.begin(), first.end());
  base_vertex_.resize(counts_.size());
  offsets_.resize(counts_.size());
}

void Run::draw_elements(GLenum mode, std::span<const ElementPart> ranges, GLenum type) {
  attributes_read_ = calls_.words().size();
  buffer_draws_.push_back({calls_.words().size(), mode, type, counts_.size(), ranges.size()});
  for (const ElementPart& range : ranges) {
    counts_.push_back(range.count);
    offsets_.push_back(range.offset);
    base_vertex_.push_back(range.base_vertex);
  }
  first_.resize(counts_.size());
  reads_arrays = true;
}

void Run::draw_arrays_instanced(GLenum mode, GLint first, GLsizei count, GLsizei instances) {
  reads_arrays = true;
  append_call(calls_, &DispatchTable::DrawArraysInstanced, mode, first, count, instances);
  attributes_read_ = calls_.words().size();
}

void Run::draw_elements_instanced(GLenum mode, const ElementPart& range, GLenum type, GLsizei instances) {
  draw_elements(mode, {&range, 1}, type);
  buffer_draws_.back().instances = instances;
}

void Run::draw_kept(const DispatchTable& gl, const BufferDraw& draw) const {
  const GLsizei* const count = counts_.data() + draw.part;
  const void* const* const offset = offsets_.data() + draw.part;
  const GLint* const base = base_vertex_.data() + draw.part;
  // Base vertices are used only if there are any: older contexts lack these calls.
  const bool based = std::any_of(base, base + draw.parts, [](GLint vertex) { return vertex != 0; });
  const auto parts = GLsizei(draw.parts);
  if (draw.instances != 1) {
    if (based)
      gl.DrawElementsInstancedBaseVertex(draw.mode, *count, draw.type, *offset, draw.instances, *base);
    else
      gl.DrawElementsInstanced(draw.mode, *count, draw.type, *offset, draw.instances);
  } else if (draw.type == 0) {
    gl.MultiDrawArrays(draw.mode, first_.data() + draw.part, count, parts);
  } else if (parts == 1 && based) {
    gl.DrawElementsBaseVertex(draw.mode, *count, draw.type, *offset, *base);
  } else if (parts == 1) {
    gl.DrawElements(draw.mode, *count, draw.type, *offset);
  } else if (based) {
    gl.MultiDrawElementsBaseVertex(draw.mode, count, draw.type, offset, parts, base);
  } else {
    gl.MultiDrawElements(draw.mode, count, draw.type, offset, parts);
  }
}

std::optional<std::size_t> Run::triangles_of(const BufferDraw& draw) const {
  std::size_t triangles = 0;
  for (std::size_t part = draw.part; part < draw.part + draw.parts; ++part) {
    const std::size_t vertices = std::size_t(std::max(counts_[part], 0));
    if (draw.mode == GL_TRIANGLES)
      triangles += vertices / 3;
    else if (draw.mode == GL_TRIANGLE_STRIP || draw.mode == GL_TRIANGLE_FAN)
      triangles += vertices < 3 ? 0 : vertices - 2;
    else
      return std::nullopt;
  }
  return triangles * std::size_t(std::max(draw.instances, 0));
}

std::optional<std::size_t> Run::triangles() const {
  if (!calls_.words().empty()) return std::nullopt;
  std::size_t all = 0;
  for (const BufferDraw& draw : buffer_draws_) {
    const auto triangles = triangles_of(draw);
    if (!triangles) return std::nullopt;
    all += *triangles;
  }
  return all;
}

std::vector<GLuint> Run::slices() const {
  std::vector<GLuint> textures;
  for (const StackSlice& slice : slices_) {
    if (slice.draws_before < draws) textures.push_back(slice.texture);
  }
  return textures;
}

std::size_t Run::slices_drawn_alike() const {
  const std::size_t drawn = slices().size();
  if (drawn == 0 || draws % drawn != 0) return 0;
  const std::size_t of_slice = draws / drawn;
  for (std::size_t i = 0; i < drawn; ++i) {
    if (slices_[i].draws_before != i * of_slice) return 0;
  }
  return drawn;
}

GLuint Run::volume_texture() const {
  if (!pipeline_.stack) return pipeline_.volume.texture;
  const std::vector<GLuint> textures = slices();
  return textures.empty() ? pipeline_.volume.texture : std::min(textures.front(), textures.back());
}

void Run::set_attribute(CallId call, const std::uint64_t* words) {
  append_plain_call(calls_, call, words);
  set_.add(call, words);
  attributes_read_ = calls_.words().size();
}

void Run::call_list(GLuint list) {
  append_call(calls_, &DispatchTable::CallList, list);
  set_.add_list();
  attributes_read_ = calls_.words().size();
}

void Run::draw_memory(const ArraySources& sources, GLenum mode,
                      std::span<const std::vector<std::uint32_t>> parts) {
  const std::size_t begin = calls_.words().size();
  for (const auto& elements : parts) append_elements(calls_, sources, mode, elements);
  // Draws between which no attribute is set save and restore attributes once.
  if (memory_draws_.empty() || memory_draws_.back().end <= attributes_read_)
    memory_draws_.push_back({.begin = begin, .end = begin, .set = {.generic = set_.generic}});
  memory_draws_.back().end = calls_.words().size();
  memory_draws_.back().set.add(sources.arrays);
}

void Run::make_calls(const DispatchTable& gl, Place& place, std::size_t end) const {
  const auto words = calls_.words();
  for (; place.buffer_draw < buffer_draws_.size(); ++place.buffer_draw) {
    const BufferDraw& draw = buffer_draws_[place.buffer_draw];
    if (draw.position >= end) break;
    make_plain_calls(words.subspan(place.word, draw.position - place.word), gl);
    place.word = draw.position;
    draw_kept(gl, draw);
  }
  make_plain_calls(words.subspan(place.word, end - place.word), gl);
  place.word = end;
}

void Run::make_all_calls(const DispatchTable& gl) const {
  Place place;
  for (const MemoryDraws& draws : memory_draws_) {
    make_calls(gl, place, draws.begin);
    const CurrentAttributes before(gl, draws.set);
    make_calls(gl, place, draws.end);
    before.make_current(gl);
  }
  make_calls(gl, place, calls_.words().size());
  for (; place.buffer_draw < buffer_draws_.size(); ++place.buffer_draw)
    draw_kept(gl, buffer_draws_[place.buffer_draw]);
}

void Run::replay(const DispatchTable& gl) const {
  if (set_.empty()) return make_all_calls(gl);
  if (!initial_) {
    initial_.emplace(gl, set_);
    return make_all_calls(gl);
  }
  const CurrentAttributes now(gl, set_);
  initial_->make_current(gl);
  make_all_calls(gl);
  now.make_current(gl);
}

}  // namespace understudy::spu
