// SPDX-License-Identifier: Apache-2.0
// What a handshake leaves: a socket whose other end has proved itself, and the keys of the session.
#pragma once

#include <optional>

#include "compositor/transport/file_descriptor.h"
#include "compositor/transport/tcp/session_keys.h"

namespace understudy::compositor {

struct AuthenticatedSocket {
  FileDescriptor socket;
  std::optional<SessionKeys> keys;  ///< none: both ends are on this machine, and wanted no encryption
};

}  // namespace understudy::compositor
