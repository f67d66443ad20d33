// SPDX-License-Identifier: Apache-2.0
// How the bytes of one direction of a session are sent: a stream's head (crypto_secretstream's, 24 bytes), then
// records. A record is the number of its sealed bytes, in four bytes, least significant first, followed by
// these: up to max_record_bytes, encrypted and authenticated (XChaCha20-Poly1305, libsodium's
// crypto_secretstream), and 17 bytes more. The number is authenticated, too. Both ends count records, so a
// record that was changed, omitted, replayed, moved or taken from another session does not open.
//
// An observer sees when how many bytes are sent. No record announces the end: whoever can cut a connection can
// end a session, which its users see as a lost connection.
#pragma once

#include <cstddef>
#include <cstdint>

namespace understudy::compositor {

/// Large enough that sealing costs little more than its bytes, small enough that the connection is busy while
/// the next record is sealed.
constexpr std::size_t max_record_bytes = std::size_t(1) << 16;
constexpr std::size_t record_seal_bytes = 17;
constexpr std::size_t record_length_bytes = 4;
constexpr std::size_t stream_head_bytes = 24;
/// After so many the sender changes the key, by a one-way function of itself: about 1 GiB.
constexpr std::uint32_t records_of_a_key = 1 << 14;

}  // namespace understudy::compositor
