// SPDX-License-Identifier: Apache-2.0
// Determines what finally reaches a fragment's colour, depth and discards through tables: a texel of a table is
// replaced by what its coordinate depends on; at a texel of the volume the path ends.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "spu/volume/program/facts.h"

namespace understudy::spu::program {

enum class Target : std::uint8_t {
  colour,
  depth,       ///< gl_FragDepth
  coverage,    ///< gl_SampleMask and the stencil reference
  discard,     ///< whether the fragment is discarded
  coordinate,  ///< of a texel of the volume that reaches one of the above
};

struct Influence {
  std::uint32_t source = 0;  ///< index in StageFacts::sources
  Flow flow = Flow::data;
  Target target = Target::colour;
  bool through_table = false;                          ///< through the coordinate of another texture
  auto operator<=>(const Influence&) const = default;  // NOLINT(modernize-use-nullptr): there is no pointer
};

/// Returns influences in ascending order, each once. `volumes` names the samplers whose texels end a path;
/// texels of other samplers are listed, and followed.
std::vector<Influence> influences(const StageFacts& fragment, std::span<const std::string> volumes);

/// Returns the fetches of the volume that reach any target, in order.
std::vector<std::size_t> volume_fetches(const StageFacts& fragment, std::span<const Influence> influences,
                                        std::span<const std::string> volumes);

/// A scalar of a uniform, and all that a change of it may affect.
struct UniformUse {
  std::uint32_t source = 0;
  bool colour = false;
  bool depth = false;
  bool discard = false;
  bool coordinate = false;
  bool chooses_colour = false;  ///< by a branch: a plane beyond which samples are skipped, a side that is lit
  bool branch = false;          ///< one of the flows above is a branch
  bool loop_end = false;        ///< one of the flows above ends a loop
};

std::vector<UniformUse> uniform_uses(const StageFacts& fragment, std::span<const Influence> influences);

/// Describes influences, such as "varying texcoord.xz decides which fragments are discarded": one text for all
/// components of a variable.
std::vector<std::string> texts(const StageFacts& fragment, std::span<const Influence> influences);

/// Returns what the vertex stage computes the fragment stage's input `varying` from; null if it does not write
/// it.
std::optional<Dependences> written_from(const StageFacts& vertex, const Source& varying);

/// Returns whether the input is the same for all fragments of a draw: neither an attribute nor gl_VertexID
/// reaches it.
bool is_constant_over_draw(const StageFacts& vertex, const Source& varying);

}  // namespace understudy::spu::program
