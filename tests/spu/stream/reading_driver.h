// SPDX-License-Identifier: Apache-2.0
// A driver for tests of untrusted streams. It reads and writes every argument to its full extent, as a driver
// without checks would; AddressSanitizer reports accesses outside.
//
// It keeps the state on which the meaning of pointer arguments depends: the pixel store, buffer objects with
// their bytes and mappings, vertex arrays, feedback and selection buffers. Between glBegin and glEnd it does
// not answer queries.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "dispatch/call_id.h"
#include "dispatch/call_shape.h"
#include "dispatch/table.h"

namespace understudy::spu::testing {

/// At most one per thread at a time.
class ReadingDriver {
 public:
  ReadingDriver();
  ~ReadingDriver();
  ReadingDriver(const ReadingDriver&) = delete;
  ReadingDriver& operator=(const ReadingDriver&) = delete;

  const DispatchTable& table() const { return table_; }
  std::uint64_t calls() const { return calls_; }
  /// Depends on all bytes that were read, so that the compiler cannot remove any read.
  std::uint64_t sum() const { return sum_; }

 private:
  struct Slots;
  struct Buffer {
    std::vector<std::byte> bytes;
    bool mapped = false;
    std::size_t mapped_at = 0;
    GLint access = GL_READ_WRITE;
  };
  struct Array {
    bool enabled = false;
    std::uint64_t pointer = 0;
    GLint size = 4;
    GLenum type = GL_FLOAT;
    GLsizei stride = 0;
    GLuint buffer = 0;
    GLuint divisor = 0;
  };
  struct Retained {
    std::uint64_t first = 0;
    std::size_t bytes = 0;
  };
  static constexpr GLuint attributes = 4;

  std::uint64_t call(CallId call, const std::uint64_t* words);
  std::optional<std::uint64_t> change(CallId call, const std::uint64_t* words);
  std::optional<std::uint64_t> change_buffers(CallId call, const std::uint64_t* words);
  void change_arrays(CallId call, const std::uint64_t* words);
  void touch(CallId call, std::size_t parameter, const std::uint64_t* words);
  void read_input(CallId call, std::size_t parameter, const std::uint64_t* words);
  void read_list(CallId call, std::size_t parameter, const std::uint64_t* words);
  void write_output(CallId call, std::size_t parameter, const std::uint64_t* words);
  void draw(CallId call, const std::uint64_t* words);
  void read(std::uint64_t address, std::size_t bytes);
  void write(std::uint64_t address, std::size_t bytes);
  std::uint64_t in_buffer(GLenum target, std::uint64_t pointer);
  Buffer* bound(GLenum target);
  Buffer* buffer_of(CallId call, const std::uint64_t* words);
  void set_data(Buffer& buffer, std::uint64_t bytes, std::uint64_t data);
  std::uint64_t map(CallId call, const std::uint64_t* words);
  void delete_buffers(const std::uint64_t* words);
  std::optional<std::uint64_t> integer(GLenum name) const;
  std::uint64_t pointer(GLenum name) const;
  Array* array(GLenum name);

  DispatchTable table_{};
  std::map<GLenum, GLint> integers_;
  std::map<GLenum, GLuint> bindings_;  ///< by target
  std::map<GLuint, Buffer> buffers_;
  std::array<Array, 3 + attributes> arrays_;  ///< vertices, normals, colours, attributes
  Retained feedback_, selection_;
  GLenum render_mode_ = GL_RENDER;
  std::size_t program_text_ = 0;
  bool inside_ = false;
  std::uint64_t calls_ = 0;
  std::uint64_t sum_ = 0;
};

}  // namespace understudy::spu::testing
