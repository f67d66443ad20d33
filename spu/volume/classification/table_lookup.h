// SPDX-License-Identifier: Apache-2.0
// The colour that a transfer function assigns to a value.
#pragma once

#include "volume/classification.h"

namespace understudy::spu {

/// Interpolates linearly between entries; constant outside of the table's range.
volume::Rgba table_at(const volume::TransferFunction& table, float value);

}  // namespace understudy::spu
