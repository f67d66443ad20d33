// SPDX-License-Identifier: Apache-2.0
// How the bytes of one direction of a session travel: a stream's head (crypto_secretstream's, 24 bytes), and
// then records. A record is the number of its sealed bytes, in four bytes, least first, and these: up to
// max_record_bytes, encrypted and authenticated (XChaCha20-Poly1305, libsodium's crypto_secretstream), with 17
// bytes more. Records are counted at both ends, so that one that was changed, left out, replayed, moved or
// taken from another session does not open. The number is part of what is authenticated.
//
// What an onlooker sees: when how many bytes travel. An end that closes says nothing more in here: whoever can
// cut a line can end a session, and that is a loss to those who use it.
#pragma once

#include <cstddef>
#include <cstdint>

namespace understudy::compositor {

/// Long enough that sealing costs what its bytes cost, short enough that the line has something to do
/// meanwhile.
constexpr std::size_t max_record_bytes = std::size_t(1) << 16;
constexpr std::size_t record_seal_bytes = 17;
constexpr std::size_t record_length_bytes = 4;
constexpr std::size_t stream_head_bytes = 24;
/// Then the sender changes the key, by a one-way function of itself: about 1 GiB.
constexpr std::uint32_t records_of_a_key = 1 << 14;

}  // namespace understudy::compositor
