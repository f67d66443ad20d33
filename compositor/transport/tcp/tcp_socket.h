// SPDX-License-Identifier: Apache-2.0
// TCP sockets for connections: they do not block, send at once, and notice a cut in bounded time.
#pragma once

#include <string>

#include "compositor/transport/file_descriptor.h"
#include "compositor/transport/socket.h"
#include "compositor/transport/tcp/address.h"

namespace understudy::compositor {

/// Port 0: any free one. Throws std::runtime_error with what to do.
FileDescriptor listen_at(const TcpAddress& address);

/// The address at which a socket listens, or from which a connection comes, in numeric form.
TcpAddress own_address(int socket);
TcpAddress peer_address(int socket);

/// Connects; throws std::runtime_error with the reason.
FileDescriptor connect_to(const TcpAddress& address, Deadline deadline);

/// Whether both ends of a connection have loopback addresses, which no packet from elsewhere can have.
bool is_within_machine(int socket);

/// For an accepted connection; connect_to() sets them itself.
void set_connection_options(int socket);

/// What the kernel has measured for this connection.
struct LineFigures {
  double bytes_per_second = 0;  ///< 0: not known yet
  double round_trip_ms = 0;
};
LineFigures line_figures(int socket);

}  // namespace understudy::compositor
