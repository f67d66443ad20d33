// SPDX-License-Identifier: Apache-2.0
// What a program's tables hold, to distinguish an edited table from one that was only corrected for another
// step.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "spu/volume/observation/run.h"

namespace understudy::spu {

struct GlContext;

/// The texels of one table.
struct TableContents {
  GLint sampler_location = -1;
  std::vector<float> rgba;  ///< empty: too large, or not a table
};

/// Reads the textures that the program samples by the samplers of these names.
std::vector<TableContents> table_contents(const GlContext& context, const Run& run,
                                          std::span<const std::string> samplers);

/// Whether every number is unchanged, or an opacity that was corrected for steps `factor` times as long,
/// 1 - (1 - a)^factor.
bool only_corrected(std::span<const TableContents> before, std::span<const TableContents> now, double factor);

}  // namespace understudy::spu
