// A run: consecutive draws of slices with one pipeline, kept instead of drawn until it is known what they mean.
#pragma once

#include <cstddef>
#include <vector>

#include "spu/stream/record.h"
#include "spu/volume/pipeline.h"

namespace understudy::spu {

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
  /// The texture that the volume is known by: of a stack one of its ends, whichever is drawn first.
  GLuint volume_texture() const;

  /// Where deferred calls go; all of them are plain.
  Records& calls() { return calls_; }
  /// glDrawElements whose indices lie in the bound element buffer; `offset` as the application gave it.
  void draw_elements(GLenum mode, GLsizei count, GLenum type, const void* offset) {
    elements_.push_back({calls_.words().size(), mode, count, type, offset});
    reads_arrays = true;
  }
  /// Array draws were kept as immediate calls, which move the current attributes; the arrays would not have.
  bool expanded_arrays = false;
  /// Array draws were kept as they are, from buffers: the arrays must stay as they were.
  bool reads_arrays = false;
  bool inside_begin = false;
  std::size_t draws = 0;

  /// Makes the calls on `gl`, in order.
  void replay(const DispatchTable& gl) const;

 private:
  struct ElementDraw {
    std::size_t position;  ///< words of deferred calls before it
    GLenum mode;
    GLsizei count;
    GLenum type;
    const void* offset;
  };

  struct StackSlice {
    GLuint texture;
    std::size_t draws_before;
  };

  Pipeline pipeline_;
  Records& calls_;
  std::vector<StackSlice> slices_;
  std::vector<ElementDraw> elements_;
};

}  // namespace understudy::spu
