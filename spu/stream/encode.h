// SPDX-License-Identifier: Apache-2.0
// From calls to records.
//
// Everything that OpenGL would read through a pointer while the call runs is copied into the record, so the
// application may do with its memory what it likes afterwards: pixels as tight_image() lays them, strings,
// arrays, indices, and the elements of client vertex arrays that a draw uses. Offsets into bound buffers stay
// offsets.
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

/// The caller must know the answer, or the memory behind a pointer, before it goes on: results, outputs, and
/// inputs whose extent nobody knows.
bool needs_answer(CallId call) noexcept;

class Encoder {
 public:
  /// What a pointer means depends on bindings, the pixel store and the vertex arrays; `questions` is asked for
  /// them. `before_question` runs first: calls that were recorded but not made yet must be made, as they may
  /// change the answers.
  Encoder(const DispatchTable& questions, std::function<void()> before_question);

  /// Appends the call, with events around it where it needs them, to `to`. `words` are the arguments as
  /// AsWords makes them.
  void encode(CallId call, const std::uint64_t* words, Records& to);

  /// Whoever reads the records has another memory: addresses of the application are told as "somewhere", so
  /// that calls that differ in nothing else are the same words.
  void hide_addresses() { hides_addresses_ = true; }

  /// The application is between glBegin and glEnd: OpenGL answers no questions.
  bool inside_begin() const { return begin_and_end_.inside(); }

 private:
  /// A pointer argument on its way into a record.
  struct Argument {
    Reference reference;
    std::span<const std::byte> bytes;  ///< what `reference` is to point at, when its kind is inside
    std::vector<std::byte> owned;      ///< where bytes point, when they are ours
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
  std::vector<Argument> arguments_;  ///< kept for its memory
  bool hides_addresses_ = false;
  BeginAndEnd begin_and_end_;
  /// The application pointed an array at its own memory at least once: draws must look.
  bool client_memory_ = false;
  std::vector<ClientArray> arrays_at_begin_;
  ElementRange elements_since_begin_;
  std::size_t begin_position_ = 0;
  std::uint64_t begin_generation_ = 0;
};

/// An address that the application has, where it is hidden.
constexpr std::uint64_t somewhere = 1;

/// The `arrays` event for `range` of `arrays`.
void append_arrays(const std::vector<ClientArray>& arrays, const ElementRange& range, Records& to,
                   bool hides_addresses = false);

}  // namespace understudy::spu
