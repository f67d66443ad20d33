// SPDX-License-Identifier: Apache-2.0
// What an end of a connection over TCP proves its identity by: a secret that both ends have, or a key of its
// own, whose public half the other end knows. A server may have both.
//
// With keys, the proofs of a session use a secret that only the two ends can compute (a triple Diffie-Hellman,
// as in Noise's KK without the static pair; Perrin 2018): from the client's session key and the server's file
// key, and the other way around. So whoever steals the key of one end can impersonate that end, but nobody else
// to it.
#pragma once

#include <optional>
#include <vector>

#include "compositor/transport/tcp/key_pair.h"
#include "compositor/transport/tcp/secret.h"

namespace understudy::compositor {

class Credentials {
 public:
  explicit Credentials(const Secret& secret) : secret_(secret) {}
  /// `known` is the server's key for a client, and the keys of all its clients for a server. With `secret`, a
  /// server also accepts clients that have the secret.
  Credentials(const KeyPair& own, std::vector<PublicKey> known, std::optional<Secret> secret = {})
      : secret_(std::move(secret)), own_(own), known_(std::move(known)) {}

  bool by_key() const { return own_.has_value(); }
  /// Of a client's key file; zeros with a shared secret.
  PublicKey public_key() const;

  /// Returns the secret of a session's proofs, from the keys that the other end sent. For an unknown end it is
  /// useless, but takes as long to compute.
  Secret secret_with_server(const KeyPair& of_session, const PublicKey& their_of_session) const;
  Secret secret_with_client(const KeyPair& of_session, const PublicKey& their_of_session,
                            const PublicKey& their_of_file) const;

 private:
  std::optional<Secret> secret_;
  std::optional<KeyPair> own_;
  std::vector<PublicKey> known_;
};

}  // namespace understudy::compositor
