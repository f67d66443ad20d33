// SPDX-License-Identifier: Apache-2.0
// A run: consecutive draws of slices with one pipeline, kept instead of executed until they are recognised.
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

/// Elements of one draw from the bound element buffer; `offset` as passed by the application.
struct ElementPart {
  GLsizei count = 0;
  const void* offset = nullptr;
  GLint base_vertex = 0;
};

class Run {
 public:
  /// Clears `calls`, which must outlive the run: the next run reuses its memory. `core`: of a core profile, in
  /// which attribute 0 has a current value.
  Run(Pipeline pipeline, Records& calls, bool core) : pipeline_(std::move(pipeline)), calls_(calls) {
    calls_.clear();
    if (core) set_.generic = ~std::uint32_t(0);
    // Bound already, but an earlier replay leaves the last slice bound.
    if (pipeline_.stack) bind_slice(pipeline_.volume.texture);
  }

  const Pipeline& pipeline() const { return pipeline_; }

  /// Begins the next slice of a stack: binds its texture, and passes its index to feedback mode.
  void bind_slice(GLuint texture);
  /// The stack's textures in drawing order, without those at the end that nothing was drawn with.
  std::vector<GLuint> slices() const;
  /// Number of slices of a stack; 0 if they have different numbers of draws.
  std::size_t slices_drawn_alike() const;
  /// The texture that identifies the volume: of a stack the end with the smaller name, whichever is drawn
  /// first.
  GLuint volume_texture() const;

  /// Deferred calls. All of them are plain, and only those that set_attribute() and call_list() add set
  /// attributes.
  Records& calls() { return calls_; }
  /// Adds a call of kind `vertex`, with its arguments in the form of AsWords.
  void set_attribute(CallId call, const std::uint64_t* words);
  /// Adds a display list that consists of vertices only.
  void call_list(GLuint list);
  /// Draws elements of arrays in the application's memory, one glBegin and glEnd for each of `parts`. They
  /// leave the current attributes unchanged, as draws of arrays do.
  void draw_memory(const ArraySources& sources, GLenum mode, std::span<const std::vector<std::uint32_t>> parts);
  /// Draw from buffers. Indices of elements are in the bound element buffer.
  void draw_arrays(GLenum mode, std::span<const GLint> first, std::span<const GLsizei> count);
  void draw_elements(GLenum mode, std::span<const ElementPart> ranges, GLenum type);
  /// The same for one range, with `instances` instances.
  void draw_arrays_instanced(GLenum mode, GLint first, GLsizei count, GLsizei instances);
  void draw_elements_instanced(GLenum mode, const ElementPart& range, GLenum type, GLsizei instances);
  /// Array draws from buffers were kept as they are: the arrays must not change.
  bool reads_arrays = false;
  /// Returns how many triangles the run draws, provided that no index restarts a primitive; empty if it
  /// consists of other calls than indexed draws and multi-draws of triangles, which only the driver can count.
  std::optional<std::size_t> triangles() const;
  /// False after a draw of points, of lines, or of unknown primitives.
  bool only_polygons = true;
  bool inside_begin = false;
  std::size_t draws = 0;
  /// Its image, or its calls, have reached the framebuffer: it must not be drawn again.
  bool shown = false;

  /// The extent of what the run holds. If a draw cannot be kept completely, the run is rewound to where it
  /// began.
  struct Mark {
    std::size_t words;
    std::size_t buffer_draws;
  };
  Mark mark() const { return {calls_.words().size(), buffer_draws_.size()}; }
  void rewind(const Mark& mark) {
    calls_.rewind(mark.words);
    buffer_draws_.erase(buffer_draws_.begin() + std::ptrdiff_t(mark.buffer_draws), buffer_draws_.end());
  }

  /// Makes the calls on `gl`, in order. The first replay changes the current attributes as the run does. Later
  /// ones begin with the attributes with which the first began, and restore those that they found.
  void replay(const DispatchTable& gl) const;

 private:
  /// One call; its parts are in the four vectors below, from `part` on.
  struct BufferDraw {
    std::size_t position;  ///< word of the deferred calls that it precedes
    GLenum mode;
    GLenum type;  ///< of the indices; 0: no indices
    std::size_t part;
    std::size_t parts;
    GLsizei instances = 1;  ///< if not 1, the draw has one part
  };
  void draw_kept(const DispatchTable& gl, const BufferDraw& draw) const;
  std::optional<std::size_t> triangles_of(const BufferDraw& draw) const;
  struct Place {
    std::size_t word = 0;         ///< in the deferred calls
    std::size_t buffer_draw = 0;  ///< index of the next one
  };
  /// Makes the calls from `place` to word `end`, and the draws from buffers before it.
  void make_calls(const DispatchTable& gl, Place& place, std::size_t end) const;
  void make_all_calls(const DispatchTable& gl) const;

  /// Calls that must leave the current attributes unchanged.
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
  AttributeSet set_;                 ///< by calls that change the current attributes
  std::size_t attributes_read_ = 0;  ///< word after the last call that sets attributes, or draws from buffers
  /// Values of `set_` before the first replay.
  mutable std::optional<CurrentAttributes> initial_;
  std::vector<GLsizei> counts_;
  std::vector<GLint> first_;  ///< vertices, if there are no indices
  std::vector<GLint> base_vertex_;
  std::vector<const void*> offsets_;
};

}  // namespace understudy::spu
