// SPDX-License-Identifier: Apache-2.0
// Events: records of a stream that are no OpenGL calls. Their ids are made from names as those of calls are.
#pragma once

#include <cstdint>

#include "spu/stream/record.h"

namespace understudy::spu::event {

/// arguments: number of arrays, then 8 words for each: role, index, components, type, normalized, stride and
/// pointer of the application, divisor, then first element and data (a reference) -- see client_arrays.h.
inline constexpr std::uint32_t arrays = stable_id_of("understudy.arrays");
constexpr std::size_t words_per_array = 10;
/// The arrays point where the application had pointed them. No arguments.
inline constexpr std::uint32_t arrays_end = stable_id_of("understudy.arrays_end");

/// The records that follow come from this thread: number (0 the first one seen).
inline constexpr std::uint32_t thread = stable_id_of("understudy.thread");
/// What the thread's last call answered: id of the call, result, then a reference for every argument that names
/// objects and was written.
inline constexpr std::uint32_t answers = stable_id_of("understudy.answers");
/// A context appears: number, number of one it shares objects with (0: none), window system, version (major *
/// 100 + minor * 10), profile mask, red, green, blue, alpha, depth, stencil, samples of its window, whether it
/// is doubly buffered.
inline constexpr std::uint32_t context = stable_id_of("understudy.context");
constexpr std::size_t context_words = 13;
/// The thread's context: number (0: none), width and height of its drawable, and perhaps the drawable's number:
/// 0, or nothing, for one that is the context's own.
inline constexpr std::uint32_t current = stable_id_of("understudy.current");
inline constexpr std::uint32_t context_gone = stable_id_of("understudy.context_gone");  ///< number
/// The thread's drawable shows what was drawn: number of the frame from 1, width and height of the drawable.
inline constexpr std::uint32_t frame = stable_id_of("understudy.frame");
/// The thread's drawable shows what is in its front buffer, in the midst of a frame: width and height of the
/// drawable. Of linked streams alone.
inline constexpr std::uint32_t front_shown = stable_id_of("understudy.front_shown");
/// The application wrote into a mapped buffer: address of the mapping as it was answered, offset, data.
inline constexpr std::uint32_t mapped_write = stable_id_of("understudy.mapped_write");

/// "understudy.frame" for frame; null for an id that is no event.
const char* name_of(std::uint32_t id) noexcept;

}  // namespace understudy::spu::event
