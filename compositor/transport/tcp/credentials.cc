// SPDX-License-Identifier: Apache-2.0
#include "compositor/transport/tcp/credentials.h"

#include <sodium.h>

#include <algorithm>
#include <array>
#include <span>

namespace understudy::compositor {

namespace {

constexpr PublicKey no_key{};

Secret nobodys_secret() {
  std::array<unsigned char, 32> random{};
  ::randombytes_buf(random.data(), random.size());
  return Secret(std::as_bytes(std::span(random)));
}

/// `client_side` is agreed on with the key of the client's file, `server_side` with that of the server's.
Secret secret_of_keys(const std::optional<Secret>& client_side, const std::optional<Secret>& server_side,
                      const PublicKey& client, const PublicKey& server) {
  if (!client_side || !server_side) return nobodys_secret();
  std::array<unsigned char, 4 * 32> all{};
  auto end = std::ranges::copy(client_side->key(), all.begin()).out;
  end = std::ranges::copy(server_side->key(), end).out;
  end = std::ranges::copy(client, end).out;
  std::ranges::copy(server, end);
  const Secret secret(std::as_bytes(std::span(all)));
  ::sodium_memzero(all.data(), all.size());
  return secret;
}

}  // namespace

PublicKey Credentials::public_key() const {
  return own_ ? own_->public_key() : no_key;
}

Secret Credentials::secret_with_server(const KeyPair& of_session, const PublicKey& their_of_session) const {
  if (!own_) return secret_.value();
  const PublicKey& server = known_.front();
  return secret_of_keys(own_->shared_with(their_of_session), of_session.shared_with(server), own_->public_key(),
                        server);
}

Secret Credentials::secret_with_client(const KeyPair& of_session, const PublicKey& their_of_session,
                                       const PublicKey& their_of_file) const {
  if (their_of_file == no_key) return secret_ ? *secret_ : nobodys_secret();
  if (!own_) return nobodys_secret();
  const Secret secret = secret_of_keys(of_session.shared_with(their_of_file),
                                       own_->shared_with(their_of_session), their_of_file, own_->public_key());
  const bool known = std::ranges::find(known_, their_of_file) != known_.end();
  return known ? secret : nobodys_secret();
}

}  // namespace understudy::compositor
