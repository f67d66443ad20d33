// SPDX-License-Identifier: Apache-2.0
// Every bound of connections, whatever they carry: sizes that are checked before a message is trusted, and
// waiting times. What the render service adds: compositor/service/limits.h.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

namespace understudy::compositor::limits {

using std::chrono::milliseconds;

// Messages.
constexpr std::uint64_t max_hello_bytes = 64;  ///< what is accepted from a pending client
constexpr std::uint64_t max_message_bytes = (std::uint64_t(1) << 28) + (std::uint64_t(1) << 20);
constexpr std::size_t max_text_bytes = 1024;              ///< of a refusal
constexpr std::size_t read_ahead = std::size_t(1) << 20;  ///< memory given to a message before its bytes arrive

// Connections over TCP (transport/tcp).
constexpr std::size_t min_secret_bytes = 16;
constexpr std::size_t max_secret_bytes = 4096;
constexpr std::size_t max_pending_clients = 256;  ///< unauthenticated ones; above this the oldest is closed
constexpr std::size_t max_tcp_block_bytes = std::size_t(1) << 18;  ///< of a message, before compression

// Times. A peer at a Unix socket may be silent for ever between two messages (a viewer that nobody turns), but
// not within a message, or when an answer is due. The ends of a connection over TCP send signs of life.
constexpr milliseconds hello_patience{5'000};   ///< from accept to a complete hello
constexpr milliseconds stall_patience{10'000};  ///< between two pieces of one message
constexpr milliseconds send_patience{
    30'000};  ///< until more of a message has been sent, however long the message is
constexpr milliseconds server_patience{
    120'000};  ///< for a call that a GL server makes, with all calls before it
constexpr milliseconds connection_patience{20'000};  ///< of a connection over TCP whose peer is silent

}  // namespace understudy::compositor::limits
