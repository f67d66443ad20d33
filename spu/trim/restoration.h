// SPDX-License-Identifier: Apache-2.0
// Brings back, behind the cut, what OpenGL had drawn into objects before it: their contents are read here, and
// become uploads in the stream.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "spu/player/player.h"
#include "spu/stream/record.h"
#include "spu/trim/prefix.h"

namespace understudy::spu {

/// Appends the uploads to `to`; they leave every binding as it is. Returns what could not be restored, in plain
/// words.
std::vector<std::string> restore_drawn(Player& player, const std::map<DrawnObject, StreamObject>& drawn,
                                       Records& to);

}  // namespace understudy::spu
