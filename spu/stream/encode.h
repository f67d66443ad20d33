// SPDX-License-Identifier: Apache-2.0
// Encodes calls to records.
//
// Everything that OpenGL would read through a pointer during the call is copied into the record, so that the
// application may change its memory afterwards: pixels in the layout of tight_image(), strings, arrays,
// indices, and the elements of client vertex arrays that a draw uses. Offsets into bound buffers stay offsets.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "dispatch/call_shape.h"
#include "dispatch/table.h"
#include "spu/stream/begin_and_end.h"
#include "spu/stream/client_arrays.h"
#include "spu/stream/record.h"

namespace understudy::spu {

/// Whether the caller needs the answer, or the memory behind a pointer, before it continues: results, outputs,
/// and inputs of unknown extent.
bool needs_answer(CallId call) noexcept;

class Encoder {
 public:
  /// The meaning of a pointer depends on bindings, the pixel store and the vertex arrays, which are queried
  /// from `questions`. `before_question` runs first: it must make the calls that were recorded but not made
  /// yet, as they may change the answers.
  Encoder(const DispatchTable& questions, std::function<void()> before_question);

  /// Appends the call to `to`, enclosed in events if it needs them. `words` are the arguments as encoded by
  /// AsWords.
  void encode(CallId call, const std::uint64_t* words, Records& to);

  /// For readers in another process: replaces the application's addresses by `somewhere`, so that calls which
  /// differ only in addresses are encoded as the same words.
  void hide_addresses() { hides_addresses_ = true; }

  /// Whether the application is between glBegin and glEnd, where OpenGL answers no queries.
  bool inside_begin() const { return begin_and_end_.inside(); }

 private:
  /// A pointer argument while it is being encoded.
  struct Argument {
    Reference reference;
    std::span<const std::byte> bytes;  ///< the bytes that `reference` refers to, if its kind is inside
    std::vector<std::byte> owned;      ///< the memory of `bytes`, if it is ours
  };

  std::uint64_t told(std::uint64_t address) const;
  GLint ask(GLenum name);
  const DispatchTable& ask();
  void follow_begin_and_end(CallId call, const std::uint64_t* words, Records& to);
  Argument prepare(CallId call, std::size_t parameter, const std::uint64_t* words);
  void write(CallId call, const std::uint64_t* words, std::vector<Argument>& arguments, Records& to);
  bool begin_arrays(CallId call, const std::uint64_t* words, Records& to);
  void note_element(CallId call, const std::uint64_t* words);
  void insert_arrays_before_begin(Records& to);

  const DispatchTable& questions_;
  std::function<void()> before_question_;
  std::vector<Argument> arguments_;  ///< not freed, so that its memory is reused
  bool hides_addresses_ = false;
  BeginAndEnd begin_and_end_;
  /// The application has pointed an array at its own memory at least once: draws must be checked.
  bool client_memory_ = false;
  std::vector<ClientArray> arrays_at_begin_;
  ElementRange elements_since_begin_;
  std::size_t begin_position_ = 0;
  std::uint64_t begin_generation_ = 0;
};

/// Replaces a hidden address of the application.
constexpr std::uint64_t somewhere = 1;

/// Appends the `arrays` event for `range` of `arrays`.
void append_arrays(const std::vector<ClientArray>& arrays, const ElementRange& range, Records& to,
                   bool hides_addresses = false);

}  // namespace understudy::spu
