// SPDX-License-Identifier: Apache-2.0
// A run: consecutive draws of slices with one pipeline, kept instead of drawn until it is known what they mean.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "spu/stream/record.h"
#include "spu/volume/observation/client_arrays.h"
#include "spu/volume/observation/current_attributes.h"
#include "spu/volume/pipeline/pipeline.h"

namespace understudy::spu {

/// Elements of one draw from the bound element buffer; `offset` as the application gave it.
struct ElementPart {
  GLsizei count = 0;
  const void* offset = nullptr;
  GLint base_vertex = 0;
};

class Run {
 public:
  /// `calls` are cleared, and last longer than the run: their memory serves the next one.
  Run(Pipeline pipeline, Records& calls) : pipeline_(std::move(pipeline)), calls_(calls) {
    calls_.clear();
    // Bound already, but every replay ends with the last one.
    if (pipeline_.stack) bind_slice(pipeline_.volume.texture);
  }

  const Pipeline& pipeline() const { return pipeline_; }

  /// A stack's next slice: the texture is bound, and feedback told its number.
  void bind_slice(GLuint texture);
  /// The stack's textures in the order of drawing; without those that nothing was drawn with in the end.
  std::vector<GLuint> slices() const;
  /// How many slices a stack has; 0 where their numbers of draws differ.
  std::size_t slices_drawn_alike() const;
  /// The texture that the volume is known by: of a stack one of its ends, whichever is drawn first.
  GLuint volume_texture() const;

  /// Where deferred calls go; all of them are plain, and none but those that set_attribute() and call_list()
  /// add sets an attribute.
  Records& calls() { return calls_; }
  /// A call of kind `vertex`, with its arguments as AsWords makes them.
  void set_attribute(CallId call, const std::uint64_t* words);
  /// A display list of nothing but vertices.
  void call_list(GLuint list);
  /// Draws elements of arrays in the application's memory, one glBegin and glEnd for each of `parts`. They do
  /// not set the current attributes, for the arrays would not have.
  void draw_memory(const ArraySources& sources, GLenum mode, std::span<const std::vector<std::uint32_t>> parts);
  /// Draws from buffers. Elements have their indices in the bound element buffer.
  void draw_arrays(GLenum mode, std::span<const GLint> first, std::span<const GLsizei> count);
  void draw_elements(GLenum mode, std::span<const ElementPart> ranges, GLenum type);
  /// The same for one range, `instances` times.
  void draw_arrays_instanced(GLenum mode, GLint first, GLsizei count, GLsizei instances);
  void draw_elements_instanced(GLenum mode, const ElementPart& range, GLenum type, GLsizei instances);
  /// Array draws were kept as they are, from buffers: the arrays must stay as they were.
  bool reads_arrays = false;
  /// How many triangles it draws, where it is nothing but draws of elements and none of these restarts
  /// primitives; empty: only the driver can count them.
  std::optional<std::size_t> triangles() const;
  /// No draw is of points or lines, or of what nobody knows.
  bool only_polygons = true;
  bool inside_begin = false;
  std::size_t draws = 0;
  /// Its image, or its calls, have reached the framebuffer: whatever happens then, it is not drawn again.
  bool shown = false;

  /// How much it holds. A draw that cannot be kept whole is taken back to where it began.
  struct Mark {
    std::size_t words;
    std::size_t buffer_draws;
  };
  Mark mark() const { return {calls_.words().size(), buffer_draws_.size()}; }
  void rewind(const Mark& mark) {
    calls_.rewind(mark.words);
    buffer_draws_.erase(buffer_draws_.begin() + std::ptrdiff_t(mark.buffer_draws), buffer_draws_.end());
  }

  /// Makes the calls on `gl`, in order. The first time the current attributes become what the run makes of
  /// them. Later times begin with the attributes that the first one began with, and leave what they found.
  void replay(const DispatchTable& gl) const;

 private:
  /// One call; its parts stand in the four vectors below from `part` on.
  struct BufferDraw {
    std::size_t position;  ///< words of deferred calls before it
    GLenum mode;
    GLenum type;  ///< of the indices; 0: there are none
    std::size_t part;
    std::size_t parts;
    GLsizei instances = 1;  ///< if not 1, the draw has one part
  };
  void draw_kept(const DispatchTable& gl, const BufferDraw& draw) const;
  std::optional<std::size_t> triangles_of(const BufferDraw& draw) const;
  struct Place {
    std::size_t word = 0;         ///< of the deferred calls
    std::size_t buffer_draw = 0;  ///< the next one
  };
  /// Makes the calls from `place` to word `end`, and the draws from buffers that stand before it.
  void make_calls(const DispatchTable& gl, Place& place, std::size_t end) const;
  void make_all_calls(const DispatchTable& gl) const;

  /// Calls that are to leave the current attributes as they are.
  struct MemoryDraws {
    std::size_t begin;  ///< word of deferred calls
    std::size_t end;
    AttributeSet set;
  };

  struct StackSlice {
    GLuint texture;
    std::size_t draws_before;
  };

  Pipeline pipeline_;
  Records& calls_;
  std::vector<StackSlice> slices_;
  std::vector<BufferDraw> buffer_draws_;
  std::vector<MemoryDraws> memory_draws_;
  AttributeSet set_;                 ///< by calls that leave them so
  std::size_t attributes_read_ = 0;  ///< word behind the last call that sets them, or draws from buffers
  /// Before the first replay, of `set_`.
  mutable std::optional<CurrentAttributes> initial_;
  std::vector<GLsizei> counts_;
  std::vector<GLint> first_;  ///< vertices, where there are no indices
  std::vector<GLint> base_vertex_;
  std::vector<const void*> offsets_;
};

}  // namespace understudy::spu
