// SPDX-License-Identifier: Apache-2.0
// Events: records of a stream that are not OpenGL calls. Their ids are hashed from names, like those of calls.
#pragma once

#include <cstdint>

#include "spu/stream/record.h"

namespace understudy::spu::event {

/// Arguments: number of arrays, then 10 words for each: role, index, components, type, normalized, the
/// application's stride and pointer, divisor, first element and data (a reference) -- see client_arrays.h.
inline constexpr std::uint32_t arrays = stable_id_of("understudy.arrays");
constexpr std::size_t words_per_array = 10;
/// Restores the application's array pointers. No arguments.
inline constexpr std::uint32_t arrays_end = stable_id_of("understudy.arrays_end");

/// The following records come from this thread: number (0 is the first one seen).
inline constexpr std::uint32_t thread = stable_id_of("understudy.thread");
/// The answer of the thread's last call: id of the call, result, then a reference for every written argument
/// that names objects.
inline constexpr std::uint32_t answers = stable_id_of("understudy.answers");
/// A context is created: number, number of one that it shares objects with (0: none), window system, version
/// (major * 100 + minor * 10), profile mask, red, green, blue, alpha, depth, stencil, samples of its window,
/// whether it is double-buffered.
inline constexpr std::uint32_t context = stable_id_of("understudy.context");
constexpr std::size_t context_words = 13;
/// A context becomes current on the thread: number (0: none), width and height of its drawable, optionally the
/// drawable's number: 0, or missing, for the context's own drawable.
inline constexpr std::uint32_t current = stable_id_of("understudy.current");
inline constexpr std::uint32_t context_gone = stable_id_of("understudy.context_gone");  ///< number
/// The thread's drawable shows a frame: number of the frame from 1, width and height of the drawable.
inline constexpr std::uint32_t frame = stable_id_of("understudy.frame");
/// The thread's drawable shows its front buffer in the middle of a frame: width and height of the drawable.
/// Only in linked streams.
inline constexpr std::uint32_t front_shown = stable_id_of("understudy.front_shown");
/// The application wrote into a mapped buffer: address of the mapping as returned, offset, data.
inline constexpr std::uint32_t mapped_write = stable_id_of("understudy.mapped_write");

/// "understudy.frame" for frame; null for an id that is not an event.
const char* name_of(std::uint32_t id) noexcept;

}  // namespace understudy::spu::event
