// SPDX-License-Identifier: Apache-2.0
// Encodes plain calls (dispatch/call_shape.h) to records and makes them: the fast path for streams that stay in
// the process.
//
// The records are those of encode.h and decode.h, with every array inside its record. Writing them needs no
// query of OpenGL, and reading them allocates no memory.
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

/// Appends a plain call; `words` are the arguments as encoded by AsWords.
void append_plain_call(Records& to, CallId call, const std::uint64_t* words);

/// CallId::Begin for &DispatchTable::Begin.
template <class Function>
CallId call_of(Function DispatchTable::*slot) noexcept {
  // In the C++ ABI of all systems with GLX or EGL, a pointer to a data member is its offset.
  return static_cast<CallId>(std::size_t(std::bit_cast<std::ptrdiff_t>(slot)) / sizeof(AnyFunction));
}

/// The same, with arguments of the command's types: append_call(records, &DispatchTable::Begin, GL_QUADS).
template <class... Parameters>
void append_call(Records& to, void (APIENTRY* DispatchTable::*command)(Parameters...),
                 std::type_identity_t<Parameters>... arguments) {
  const std::array<std::uint64_t, sizeof...(Parameters)> words = {word(arguments)...};
  append_plain_call(to, call_of(command), words.data());
}

/// Makes the plain calls in `words` on `gl`, in order. Stops at the first record that is not a plain call, that
/// lacks data which its call reads, or whose function `gl` lacks. Returns the number of words processed.
std::size_t make_plain_calls(std::span<const std::uint64_t> words, const DispatchTable& gl);

}  // namespace understudy::spu
