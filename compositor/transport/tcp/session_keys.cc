// SPDX-License-Identifier: Apache-2.0
#include "compositor/transport/tcp/session_keys.h"

#include <sodium.h>

#include <string_view>

#include "compositor/transport/wire.h"

namespace understudy::compositor {

namespace {

using Key = std::array<unsigned char, session_key_bytes>;
static_assert(crypto_kx_SESSIONKEYBYTES == session_key_bytes);

constexpr std::string_view label = "understudy session key";

void bind(Key& key, const Secret& secret, std::span<const std::byte> said) {
  crypto_generichash_state state;
  ::crypto_generichash_init(&state, secret.key().data(), secret.key().size(), key.size());
  ::crypto_generichash_update(&state, reinterpret_cast<const unsigned char*>(label.data()), label.size());
  ::crypto_generichash_update(&state, key.data(), key.size());
  ::crypto_generichash_update(&state, reinterpret_cast<const unsigned char*>(said.data()), said.size());
  ::crypto_generichash_final(&state, key.data(), key.size());
  ::sodium_memzero(&state, sizeof state);
}

}  // namespace

SessionKeys::~SessionKeys() {
  ::sodium_memzero(receive.data(), receive.size());
  ::sodium_memzero(send.data(), send.size());
}

SessionKeys session_keys(Side side, const KeyPair& own, const PublicKey& theirs, const Secret& secret,
                         std::span<const std::byte> said) {
  SessionKeys keys;
  const auto agree = side == Side::client ? &::crypto_kx_client_session_keys : &::crypto_kx_server_session_keys;
  if (agree(keys.receive.data(), keys.send.data(), own.public_key().data(), own.private_key().data(),
            theirs.data()) != 0)
    throw MalformedMessage("its key for the session is none");
  bind(keys.receive, secret, said);
  bind(keys.send, secret, said);
  return keys;
}

}  // namespace understudy::compositor
