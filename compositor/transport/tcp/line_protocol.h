// SPDX-License-Identifier: Apache-2.0
// Messages that the two ends of a connection over TCP send for the connection's own sake.
#pragma once

#include <array>

#include "compositor/transport/message.h"

namespace understudy::compositor {

enum class LineMessage : std::uint16_t {
  alive = 1,  ///< from an end that has nothing else to send
  last = alive
};

constexpr Protocol protocol_of(LineMessage) {
  return {5, 1, std::uint16_t(LineMessage::last)};
}

inline constexpr std::array line_protocols{protocol_of(LineMessage{})};

}  // namespace understudy::compositor
