// SPDX-License-Identifier: Apache-2.0
// By what an end of a connection over TCP proves who it is: a secret that both ends have, or a key of its own,
// whose public half the other end knows. A server may have both.
//
// With keys, the secret of a session's proofs is what only the two can compute (a triple Diffie-Hellman, as in
// Noise's KK without the static pair; Perrin 2018): from the client's key of the session and the server's of
// its file, and the other way around. So whoever steals the key of one end can pretend to be that end, and
// nobody else to it.
#pragma once

#include <optional>
#include <vector>

#include "compositor/transport/tcp/key_pair.h"
#include "compositor/transport/tcp/secret.h"

namespace understudy::compositor {

class Credentials {
 public:
  explicit Credentials(const Secret& secret) : secret_(secret) {}
  /// `known`: of a client, the server's key alone; of a server, those of all of its clients. Of a server,
  /// `secret` lets in those who have it, too.
  Credentials(const KeyPair& own, std::vector<PublicKey> known, std::optional<Secret> secret = {})
      : secret_(std::move(secret)), own_(own), known_(std::move(known)) {}

  bool by_key() const { return own_.has_value(); }
  /// Of a client's key file; zeros with a shared secret.
  PublicKey public_key() const;

  /// The secret of the proofs of a session, with what the other end said. Of no use, and as long in the making,
  /// for whoever is not known.
  Secret secret_with_server(const KeyPair& of_session, const PublicKey& their_of_session) const;
  Secret secret_with_client(const KeyPair& of_session, const PublicKey& their_of_session,
                            const PublicKey& their_of_file) const;

 private:
  std::optional<Secret> secret_;
  std::optional<KeyPair> own_;
  std::vector<PublicKey> known_;
};

}  // namespace understudy::compositor
