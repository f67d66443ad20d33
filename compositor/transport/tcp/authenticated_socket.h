// SPDX-License-Identifier: Apache-2.0
// The result of a handshake: a socket whose other end is authenticated, and the keys of the session.
#pragma once

#include <optional>

#include "compositor/transport/file_descriptor.h"
#include "compositor/transport/tcp/session_keys.h"

namespace understudy::compositor {

struct AuthenticatedSocket {
  FileDescriptor socket;
  std::optional<SessionKeys> keys;  ///< null: both ends are on this machine, and chose no encryption
};

}  // namespace understudy::compositor
