// SPDX-License-Identifier: Apache-2.0
// Handshakes within a test, and TCP sockets on this machine.
#pragma once

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>

#include <string>
#include <utility>
#include <vector>

#include "compositor/transport/tcp/authenticated_socket.h"
#include "compositor/transport/tcp/handshake.h"
#include "compositor/transport/tcp/tcp_socket.h"

namespace understudy::compositor::testing {

inline Credentials secret_of(const std::string& text) {
  return Credentials(Secret(std::as_bytes(std::span(text))));
}

/// Returns the server's answer to a client's hello.
inline std::vector<std::byte> challenge_to(ServerHandshake& server, std::span<const std::byte> hello) {
  server.answer(hello.first(hello_bytes));
  return server.answer(hello.subspan(hello_bytes));
}

/// Returns the keys of the client and of the server.
inline std::pair<SessionKeys, SessionKeys> keys_of_session(const Credentials& of_client,
                                                           const Credentials& of_server) {
  ClientHandshake client(of_client, {});
  ServerHandshake server(of_server);
  server.answer(client.answer(challenge_to(server, client.hello())));
  client.finish(server.verdict(AdmissionVerdict::accepted));
  return {client.session_keys().value(), server.session_keys().value()};
}

inline std::pair<SessionKeys, SessionKeys> keys_of_session(const Credentials& of_both) {
  return keys_of_session(of_both, of_both);
}

/// Two ends of one connection.
inline std::pair<FileDescriptor, FileDescriptor> connected_sockets() {
  const FileDescriptor listening = listen_at(TcpAddress{"127.0.0.1", 0});
  const Deadline deadline = Clock::now() + std::chrono::seconds(10);
  FileDescriptor near = connect_to(own_address(listening.get()), deadline);
  EXPECT_TRUE(wait_until_ready(listening.get(), POLLIN, deadline));
  FileDescriptor far(::accept4(listening.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
  set_connection_options(far.get());
  return {std::move(near), std::move(far)};
}

}  // namespace understudy::compositor::testing
