// SPDX-License-Identifier: Apache-2.0
// Every kind of message between applications, launchers and nodes: an example of each, and its decoder.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "compositor/service/node_protocol.h"
#include "volume/description.h"
#include "volume/request.h"

namespace understudy::compositor::testing {

struct MessageKind {
  const char* name;
  std::vector<std::byte> bytes;
  /// Throws MalformedMessage if the message is malformed.
  std::function<std::vector<std::byte>(std::span<const std::byte>)> read_and_write_again;
};

std::vector<MessageKind> all_message_kinds();

volume::VolumeDescription some_volume();
volume::RenderRequest some_request(bool colours, bool depth);
volume::RenderRequest some_request_for_slice_segments();
/// The head, the texels, and zeros up to a multiple of eight bytes.
std::vector<std::byte> texels_message(const Texels& texels);

}  // namespace understudy::compositor::testing
