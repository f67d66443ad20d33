// SPDX-License-Identifier: Apache-2.0
// Which parts of a context's state a command may change, and on which parts a query's answer depends.
#pragma once

#include <cstdint>

#include "dispatch/call_id.h"
#include "spu/track/state_rows.h"

namespace understudy::spu {

/// A set of parts of the state, one per bit.
using StateTopics = std::uint32_t;

namespace topic {
inline constexpr StateTopics nothing = 0;
inline constexpr StateTopics current = 1U << 0;  ///< current vertex attributes
inline constexpr StateTopics matrix = 1U << 1;   ///< top matrices and the matrix mode
inline constexpr StateTopics unit = 1U << 2;     ///< the selected texture unit, of server and client
inline constexpr StateTopics capability = 1U << 3;
inline constexpr StateTopics arrays = 1U << 4;  ///< the vertex array object: which one is bound, and its state
inline constexpr StateTopics buffer = 1U << 5;
inline constexpr StateTopics texture = 1U << 6;
inline constexpr StateTopics framebuffer = 1U << 7;
inline constexpr StateTopics program = 1U << 8;
inline constexpr StateTopics blending = 1U << 9;
inline constexpr StateTopics depth = 1U << 10;
inline constexpr StateTopics stencil = 1U << 11;
inline constexpr StateTopics raster = 1U << 12;  ///< points, lines, polygons, samples
inline constexpr StateTopics viewport = 1U << 13;
inline constexpr StateTopics pixels = 1U << 14;  ///< pixel store and transfer
inline constexpr StateTopics light = 1U << 15;   ///< including fog
inline constexpr StateTopics clearing = 1U << 16;
inline constexpr StateTopics hints = 1U << 17;
inline constexpr StateTopics lists = 1U << 18;
inline constexpr StateTopics everything = ~StateTopics(0);
}  // namespace topic

/// Returns everything for commands without a rule, and for display lists, which may contain any command.
StateTopics topics_changed_by(CallId call);

/// The parts that the value of the row depends on; `nothing` for a constant.
StateTopics topics_of(const StateRow& row);

}  // namespace understudy::spu
