// SPDX-License-Identifier: Apache-2.0
// What the two ends of a connection over TCP say to each other on their own account.
#pragma once

#include <array>

#include "compositor/transport/message.h"

namespace understudy::compositor {

enum class LineMessage : std::uint16_t {
  alive = 1,  ///< from an end that has nothing else to say
  last = alive
};

constexpr Protocol protocol_of(LineMessage) {
  return {5, 1, std::uint16_t(LineMessage::last)};
}

inline constexpr std::array line_protocols{protocol_of(LineMessage{})};

}  // namespace understudy::compositor
