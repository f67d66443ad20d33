// SPDX-License-Identifier: Apache-2.0
// Every bound of connections, whatever they carry: what a message may promise before it is believed, and how
// long anybody waits. What the render service adds: compositor/service/limits.h.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

namespace understudy::compositor::limits {

using std::chrono::milliseconds;

// Messages.
constexpr std::uint64_t max_hello_bytes = 64;  ///< what is accepted from a pending client
constexpr std::uint64_t max_message_bytes = (std::uint64_t(1) << 28) + (std::uint64_t(1) << 20);
constexpr std::size_t max_text_bytes = 1024;  ///< of a refusal
constexpr std::size_t read_ahead = std::size_t(1)
                                   << 20;  ///< memory given to a message before its bytes are here

// Connections over TCP (transport/tcp).
constexpr std::size_t min_secret_bytes = 16;
constexpr std::size_t max_secret_bytes = 4096;
constexpr std::size_t max_pending_clients = 256;  ///< that have not proved themselves; the oldest makes room
constexpr std::size_t max_tcp_block_bytes = std::size_t(1) << 18;  ///< of a message, before it is compressed

// Patience. A peer at a Unix socket that is silent between two messages may be so for ever (a viewer that
// nobody turns); within a message, or when an answer is due, it may not. An end of a connection says that it is
// there.
constexpr milliseconds hello_patience{5'000};   ///< from accept to a complete hello
constexpr milliseconds stall_patience{10'000};  ///< between two pieces of one message
constexpr milliseconds send_patience{
    30'000};  ///< until some more of a message has left, over a connection, too
constexpr milliseconds server_patience{
    120'000};  ///< a call that a GL server makes, with all that went before it
constexpr milliseconds connection_patience{20'000};  ///< with a connection over TCP whose other end is silent

}  // namespace understudy::compositor::limits
