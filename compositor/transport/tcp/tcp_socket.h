// SPDX-License-Identifier: Apache-2.0
// TCP sockets for connections: they wait for nothing, send at once, and notice in bounded time that the line is
// cut.
#pragma once

#include <string>

#include "compositor/transport/file_descriptor.h"
#include "compositor/transport/socket.h"
#include "compositor/transport/tcp/address.h"

namespace understudy::compositor {

/// Port 0: any that is free. Throws std::runtime_error with what to do.
FileDescriptor listen_at(const TcpAddress& address);

/// Where a listening socket listens, or where a connection comes from, as a number.
TcpAddress own_address(int socket);
TcpAddress peer_address(int socket);

/// Throws std::runtime_error.
FileDescriptor connect_to(const TcpAddress& address, Deadline deadline);

/// Whether both ends of a connection have loopback addresses, which no packet from elsewhere can have.
bool is_within_machine(int socket);

/// For a connection that was accepted: what connect_to() has set already.
void set_connection_options(int socket);

/// What the kernel has measured on the bytes of this connection.
struct LineFigures {
  double bytes_per_second = 0;  ///< 0: nothing known yet
  double round_trip_ms = 0;
};
LineFigures line_figures(int socket);

}  // namespace understudy::compositor
