// SPDX-License-Identifier: Apache-2.0
// OpenGL's client state: pixel store, buffer bindings, vertex arrays. It follows from the calls alone, and the
// encoder queries it all the time, so these queries need no round trip.
//
// Calls that are errors are recorded as if they had succeeded; the application reads back what it set.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "dispatch/call_id.h"
#include "dispatch/table.h"
#include "spu/stream/pixels.h"

namespace understudy::spu {

/// Who makes a query. The encoder looks only for arrays in the application's memory, which only the vertex
/// array object 0 can have; an application may query more, and of any vertex array object.
enum class Asker { application, encoder };

class ClientState {
 public:
  /// Records a call that is about to be made.
  void note(CallId call, const std::uint64_t* words);
  /// Writes the answer to where the call's last argument points, or to `result`. Returns false if it is not
  /// known here.
  bool answer(CallId call, const std::uint64_t* words, Asker asker, std::uint64_t& result) const;

  GLuint bound_buffer(GLenum target) const;
  /// GL_PACK_*.
  const PixelStore& pack() const { return client_.pack; }

  /// Memory that OpenGL writes after the return of the call that specified it.
  struct Retained {
    std::uint64_t first = 0;
    std::size_t bytes = 0;
  };
  /// The buffer of the mode that the last glRenderMode has left.
  const Retained& feedback() const { return left_mode_ == GL_SELECT ? selection_ : feedback_; }

 private:
  struct Array {
    bool enabled = false;
    bool elsewhere = false;  ///< set by a call that is not tracked here, always from a buffer
    GLint size = 4;
    GLenum type = GL_FLOAT;
    GLsizei stride = 0;
    std::uint64_t pointer = 0;
    GLuint buffer = 0;
    GLuint divisor = 0;
    bool normalized = false;
    bool integer = false;
    bool wide = false;  ///< glVertexAttribLPointer
  };
  /// The state saved by glPushClientAttrib, except for the buffers below.
  struct Client {
    PixelStore unpack;
    PixelStore pack;
    std::map<GLenum, Array> fixed;  ///< by GL_VERTEX_ARRAY etc.
    std::map<GLuint, Array> texture_coordinates;
    std::map<GLuint, Array> generic;
    GLuint active_texture = 0;
    GLuint vertex_array = 0;
    GLuint array_buffer = 0;
  };
  struct Pushed {
    GLbitfield mask;
    Client client;
    GLuint unpack_buffer;
    GLuint pack_buffer;
    GLuint element_buffer;
  };

  void note_pixel_store(GLenum name, GLint value);
  void bind_buffer(GLenum target, GLuint buffer);
  void delete_buffers(GLsizei count, const GLuint* buffers);
  void point(Array& array, GLint size, GLenum type, std::uint64_t stride, std::uint64_t pointer);
  void enable_array(GLenum array, GLuint unit, bool enabled);
  void push(GLbitfield mask);
  void pop();
  void reset(GLbitfield mask);
  void follow_pointer(CallId call, const std::uint64_t* words);
  void point_interleaved(GLenum format, GLsizei stride, std::uint64_t pointer);
  void follow_arrays(CallId call, const std::uint64_t* words);
  void follow_vertex_array(CallId call, const std::uint64_t* words);
  const Array& fixed_array(GLenum array) const;
  const Array& generic_array(GLuint index) const;
  std::optional<GLint> value(GLenum name, Asker asker) const;
  std::optional<GLint> array_value(GLenum name) const;
  std::optional<GLint> attribute_value(GLuint index, GLenum name, Asker asker) const;
  std::optional<std::uint64_t> pointer(GLenum name) const;
  bool answer_enabled(GLenum name, Asker asker, std::uint64_t& result) const;

  Client client_;
  std::vector<Pushed> pushed_;
  std::map<GLenum, GLuint> buffers_;          ///< by target, except for arrays and elements
  std::map<GLuint, GLuint> element_buffers_;  ///< by vertex array object
  Retained feedback_;
  Retained selection_;
  GLenum mode_ = GL_RENDER;
  GLenum left_mode_ = GL_RENDER;
  bool restarts_ = false;  ///< primitive restart was ever enabled
};

}  // namespace understudy::spu
