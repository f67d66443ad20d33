// SPDX-License-Identifier: Apache-2.0
#include "spu/stream/brought_arrays.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>

#include "spu/stream/bound_buffers.h"
#include "spu/stream/event.h"
#include "spu/stream/extent.h"
#include "spu/stream/pointer_words.h"

namespace understudy::spu {
namespace {

/// While in scope, no buffer is bound to GL_ARRAY_BUFFER, so that arrays can be pointed at memory.
class WithoutArrayBuffer {
 public:
  explicit WithoutArrayBuffer(const DispatchTable& gl)
      : gl_(gl), bound_(asked(gl, GL_ARRAY_BUFFER_BINDING).value_or(0)) {
    if (bound_ != 0) gl.BindBuffer(GL_ARRAY_BUFFER, 0);
  }
  ~WithoutArrayBuffer() {
    if (bound_ != 0) gl_.BindBuffer(GL_ARRAY_BUFFER, GLuint(bound_));
  }
  WithoutArrayBuffer(const WithoutArrayBuffer&) = delete;
  WithoutArrayBuffer& operator=(const WithoutArrayBuffer&) = delete;

 private:
  const DispatchTable& gl_;
  const GLint bound_;
};

/// Calls that may change which arrays are enabled, where they point or how they are read.
bool may_change_arrays(std::string_view name) {
  if (name.starts_with("glGet") || name.starts_with("glIs")) return false;
  constexpr std::array<std::string_view, 9> parts = {"Pointer",      "ClientState",       "ClientAttrib",
                                                     "VertexArray",  "VertexAttribArray", "Divisor",
                                                     "VertexBuffer", "InterleavedArrays", "DeleteBuffers"};
  constexpr std::array<std::string_view, 5> beginnings = {"glVertexAttribBinding", "glVertexAttribFormat",
                                                          "glVertexAttribIFormat", "glVertexAttribLFormat",
                                                          "glBindVertex"};
  return std::any_of(parts.begin(), parts.end(), [&](auto part) { return name.find(part) != name.npos; }) ||
         std::any_of(beginnings.begin(), beginnings.end(), [&](auto start) { return name.starts_with(start); });
}

/// Calls that read vertex arrays, and some calls of extensions that were not examined.
bool may_read_arrays(std::string_view name) {
  if (name.starts_with("glDrawBuffer") || name.starts_with("glDrawPixels") || name.starts_with("glDrawTex"))
    return false;
  return name.starts_with("glDraw") || name.starts_with("glMultiDraw") || name.starts_with("glMultiMode") ||
         name.starts_with("glArrayElement") || name.starts_with("glMultiElement");
}

struct ArrayUse {
  bool changes = false;
  bool reads = false;
  bool begins = false;
};

ArrayUse use_of(CallId call) {
  static const std::vector<ArrayUse> all = [] {
    std::vector<ArrayUse> table(call_count);
    for (std::size_t i = 0; i < call_count; ++i) {
      const std::string_view name = call_name(CallId(i));
      table[i] = {may_change_arrays(name), may_read_arrays(name), CallId(i) == CallId::Begin};
    }
    return table;
  }();
  return all[std::size_t(call)];
}

/// OpenGL may read the whole index range that glDrawRangeElements specifies.
void narrow_claim(CallId call, std::uint64_t* words, const ElementRange& range) {
  const CallShape& shape = call_shape(call);
  const std::uint8_t start = argument_named(shape, "start");
  const std::uint8_t end = argument_named(shape, "end");
  if (start == no_argument || end == no_argument) return;
  const std::uint8_t base = argument_named(shape, "basevertex");
  const std::int64_t added = base == no_argument ? 0 : std::int32_t(words[base]);
  words[start] = std::uint64_t(range.first - added);
  words[end] = std::uint64_t(range.last - added);
}

}  // namespace

const std::byte* BroughtArrays::kept(std::span<const std::byte> data, bool copies) {
  if (!copies) return data.data();
  if (copies_used_ == copies_.size()) copies_.emplace_back();
  std::vector<std::uint64_t>& copy = copies_[copies_used_++];
  copy.resize(words_for(data.size()));
  std::memcpy(copy.data(), data.data(), data.size());
  return reinterpret_cast<const std::byte*>(copy.data());
}

std::string BroughtArrays::take(std::span<const std::uint64_t> fields, const Record& record,
                                const DispatchTable& gl, bool copies) {
  const auto data = record.bytes(fields[9]);
  const auto first = std::int64_t(fields[8]);
  if (fields[0] >= array_role_count || !data || first < 0 || first > std::int64_t(1) << 32)
    return "a vertex array leads out of the stream";
  Brought brought{.array = {.role = ArrayRole(fields[0]),
                            .index = GLuint(fields[1]),
                            .size = GLint(fields[2]),
                            .type = GLenum(fields[3]),
                            .normalized = fields[4] != 0,
                            .stride = GLsizei(fields[5]),
                            .pointer = Reference::from(fields[6]).value,
                            .divisor = GLuint(fields[7])},
                  .first = first};
  const std::size_t bytes = brought.array.element_bytes();
  if (bytes != 0) brought.elements = std::int64_t(data->size() / bytes);
  // The address of element 0, although only elements from `first` on are present.
  if (brought.elements > 0) brought.pointer = word_of(kept(*data, copies)) - std::uint64_t(first) * bytes;
  point_array(gl, brought.array, GLsizei(bytes), address_in(brought.pointer));
  // OpenGL may have rejected the call, and still read from elsewhere.
  if (in_memory_) note_pointer(brought.array, pointer_of(gl, brought.array));
  brought_.push_back(brought);
  return {};
}

std::string BroughtArrays::begin(const Record& record, const DispatchTable& gl, bool copies) {
  const auto arguments = record.arguments();
  const std::uint64_t count = arguments.empty() ? 0 : arguments[0];
  if (arguments.empty() || count > (arguments.size() - 1) / event::words_per_array)
    return "vertex arrays: fewer than announced";
  end(gl, false);
  active_ = true;
  const WithoutArrayBuffer without(gl);
  std::string error;
  for (std::uint64_t i = 0; i < count && error.empty(); ++i)
    error = take(arguments.subspan(1 + i * event::words_per_array, event::words_per_array), record, gl, copies);
  return error;
}

void BroughtArrays::end(const DispatchTable& gl, bool restores) {
  if (active_) {
    const WithoutArrayBuffer without(gl);
    for (const Brought& brought : brought_) {
      point_array(gl, brought.array, brought.array.stride,
                  restores ? address_in(brought.array.pointer) : nullptr);
      if (in_memory_) note_pointer(brought.array, 0);
    }
  }
  active_ = false;
  brought_.clear();
  copies_used_ = 0;
}

/// The event only changes where arrays point, so that most of them need not be queried again for every draw.
void BroughtArrays::note_pointer(const ClientArray& array, std::uint64_t pointer) {
  const auto found = std::find_if(in_memory_->begin(), in_memory_->end(), [&](const ClientArray& known) {
    return known.role == array.role && known.index == array.index;
  });
  if (found == in_memory_->end()) {
    in_memory_.reset();
  } else {
    found->pointer = pointer;
  }
}

/// Queries which arrays are in memory; returns false if that is not possible now.
bool BroughtArrays::look(bool inside_begin, const DispatchTable& gl) {
  if (in_memory_) return true;
  if (inside_begin || !asked(gl, GL_ARRAY_BUFFER_BINDING)) return false;
  in_memory_ = arrays_without_buffer(gl);
  return true;
}

bool BroughtArrays::covers(const ClientArray& used, const ElementRange& range) const {
  const auto found = std::find_if(brought_.begin(), brought_.end(), [&](const Brought& brought) {
    return brought.array.role == used.role && brought.array.index == used.index;
  });
  if (found == brought_.end() || used.pointer == 0 || found->pointer != used.pointer ||
      found->array.divisor != used.divisor) {
    return false;
  }
  const bool by_vertex = used.divisor == 0;
  const std::int64_t first = by_vertex ? range.first : range.first_instance;
  const std::int64_t last =
      by_vertex ? range.last : first + (range.last_instance - first) / std::int64_t(used.divisor);
  return first >= found->first && last < found->first + found->elements;
}

std::string BroughtArrays::check_draw(CallId call, std::uint64_t* words, const DispatchTable& gl) {
  if (in_memory_->empty()) return {};
  const auto range = draws_arrays(call) ? element_range(gl, call, words) : std::nullopt;
  if (!range) return "nobody knows which elements of its vertex arrays it reads";
  if (range->empty()) return {};
  for (const ClientArray& used : *in_memory_) {
    if (!covers(used, *range)) return "reads elements of vertex arrays that did not come with it";
  }
  narrow_claim(call, words, *range);
  return {};
}

std::string BroughtArrays::check(CallId call, std::uint64_t* words, bool inside_begin, const DispatchTable& gl,
                                 bool& left_out) {
  const ArrayUse use = use_of(call);
  if (use.changes) {
    if (active_) return "changes vertex arrays between those of a draw and the draw";
    in_memory_.reset();
  }
  if (use.begins) look(inside_begin, gl);
  if (!use.reads) return {};
  left_out = !look(inside_begin, gl);
  return left_out ? std::string() : check_draw(call, words, gl);
}

}  // namespace understudy::spu
