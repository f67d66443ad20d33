// SPDX-License-Identifier: Apache-2.0
// Restores, after the cut, what OpenGL had drawn into objects before it: their contents are read here, and
// become uploads in the stream.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "spu/player/player.h"
#include "spu/stream/record.h"
#include "spu/trim/prefix.h"

namespace understudy::spu {

/// Appends the uploads to `to`; they leave all bindings unchanged. Returns what could not be restored, as text.
std::vector<std::string> restore_drawn(Player& player, const std::map<DrawnObject, StreamObject>& drawn,
                                       Records& to);

}  // namespace understudy::spu
