// SPDX-License-Identifier: Apache-2.0
// Fresh keys for each session over TCP. Each end makes a key pair for this session alone and sends the public
// key in the handshake, whose proofs cover both. What the two agree on (libsodium's crypto_kx), the secret of
// the proofs and all messages of the handshake make one key for each direction (BLAKE2b). So whoever learns the
// secret later cannot decrypt recorded sessions (Diffie, van Oorschot, Wiener 1992: authenticated key exchange,
// forward secrecy).
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "compositor/transport/tcp/key_pair.h"
#include "compositor/transport/tcp/secret.h"

namespace understudy::compositor {

constexpr std::size_t session_key_bytes = 32;

/// The keys of one end: it receives with the key that the other end sends with. Wiped on destruction.
struct SessionKeys {
  std::array<unsigned char, session_key_bytes> receive{};
  std::array<unsigned char, session_key_bytes> send{};

  SessionKeys() = default;
  SessionKeys(const SessionKeys&) = default;
  SessionKeys& operator=(const SessionKeys&) = default;
  ~SessionKeys();
};

enum class Side { client, server };

/// `said` is the handshake up to the proofs, including both public keys. Throws MalformedMessage if `theirs` is
/// no key.
SessionKeys session_keys(Side side, const KeyPair& own, const PublicKey& theirs, const Secret& secret,
                         std::span<const std::byte> said);

}  // namespace understudy::compositor
