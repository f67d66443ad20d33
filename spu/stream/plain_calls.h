// SPDX-License-Identifier: Apache-2.0
// Plain calls (dispatch/call_shape.h) to records and back: the short way for streams that never leave the
// process.
//
// The records are those of encode.h and decode.h, with every array inside its record. Nothing has to be asked
// of OpenGL to write them, and no memory is needed to read them.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "dispatch/call_words.h"
#include "spu/stream/record.h"

namespace understudy::spu {

/// Appends a call whose shape is plain; `words` are the arguments as AsWords makes them.
void append_plain_call(Records& to, CallId call, const std::uint64_t* words);

/// CallId::Begin for &DispatchTable::Begin.
template <class Function>
CallId call_of(Function DispatchTable::*slot) noexcept {
  // The C++ ABI of every system with GLX or EGL: a pointer to a data member is its offset.
  return static_cast<CallId>(std::size_t(std::bit_cast<std::ptrdiff_t>(slot)) / sizeof(AnyFunction));
}

/// The same with the arguments' types checked: append_call(records, &DispatchTable::Begin, GL_QUADS).
template <class... Parameters>
void append_call(Records& to, void (APIENTRY* DispatchTable::*command)(Parameters...),
                 std::type_identity_t<Parameters>... arguments) {
  const std::array<std::uint64_t, sizeof...(Parameters)> words = {word(arguments)...};
  append_plain_call(to, call_of(command), words.data());
}

/// Makes the plain calls in `words` on `gl`, in order. Stops at the first record that is no plain call, does
/// not hold what its call reads, or that `gl` has no function for. Answers how many words it came through.
std::size_t make_plain_calls(std::span<const std::uint64_t> words, const DispatchTable& gl);

}  // namespace understudy::spu
