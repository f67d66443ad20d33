// SPDX-License-Identifier: Apache-2.0
// How the two ends of a connection over TCP find out that they share a secret, before either believes anything
// else.
//
// The client says its version, what it wants and a random number; the server its version and another one; the
// client proves that it has the secret, then the server does. The secret is the one that both have, or what
// follows from their key files (credentials.h). A proof is HMAC-SHA-512-256 (libsodium's crypto_auth) of a
// label for the direction and of all that was said before, so that nobody can use one end's proof at another,
// at another time or for other wishes. (Challenge and response in both directions: ISO/IEC 9798-4.) Part of
// what was said are the public keys from which both ends make the keys of the session (session_keys.h), with
// which all that follows is encrypted and authenticated (record.h). Whether it is, is a wish like others:
// nobody on the way can change it, and a client is never given less than it wanted.
//
// Nothing here touches a socket; each step takes one message of a fixed size and gives the next. The first one
// of both sides ends before the keys, and stays as it is in all versions: so versions that differ are told
// apart.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "compositor/transport/pixel_width.h"
#include "compositor/transport/tcp/credentials.h"
#include "compositor/transport/tcp/session_keys.h"

namespace understudy::compositor {

constexpr std::uint32_t tcp_protocol_version = 5;  ///< grows with every change of what travels over TCP

enum class Destination : std::uint8_t {
  nodes,      ///< the render service
  gl_server,  ///< makes the calls of an application
  last = gl_server
};

/// What a client wants, and how.
struct ConnectionRequest {
  Destination to = Destination::nodes;
  Layout pixels = Layout::rgba32f;  ///< of the nodes' images on their way back
  int jpeg_quality = 0;             ///< of images of views that move, 1 to 100; 0: no bit of them is lost
  bool only_asks = false;           ///< whether it would be let in
  bool plain = false;               ///< unencrypted, for connections within one machine
};

enum class AdmissionVerdict : std::uint32_t {
  accepted,
  wrong_secret,
  too_many,
  not_offered,
  not_plain,
  last = not_plain
};

constexpr std::size_t hello_bytes = 48;
constexpr std::size_t challenge_bytes = 48;
constexpr std::size_t client_key_bytes =
    2 * public_key_bytes;                                   ///< behind the hello: of the session, of its file
constexpr std::size_t server_key_bytes = public_key_bytes;  ///< behind the challenge
constexpr std::size_t proof_bytes = 32;
constexpr std::size_t verdict_bytes = 40;

/// The other end cannot be believed, or does not believe this one. The text says why, and what to do.
class HandshakeFailed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class ServerHandshake {
 public:
  /// `credentials` must outlive it.
  explicit ServerHandshake(const Credentials& credentials) : credentials_(&credentials) {}
  explicit ServerHandshake(Credentials&&) = delete;

  /// How many bytes its next message has; 0 when all has been said.
  std::size_t wants() const;
  /// The answer to a message. Throws HandshakeFailed: then what is in last_words() goes out, and no more.
  std::vector<std::byte> answer(std::span<const std::byte> message);
  /// The client has proved that it has the secret.
  bool proved() const { return step_ == Step::proved; }
  /// What says whether the client is let in, once proved.
  std::vector<std::byte> verdict(AdmissionVerdict verdict) const;
  std::span<const std::byte> last_words() const { return last_words_; }
  const ConnectionRequest& connection_request() const { return connection_request_; }
  /// Of this end, once proved; none for a client that wanted to do without.
  const std::optional<SessionKeys>& session_keys() const { return session_keys_; }

 private:
  enum class Step { hello, key, proof, proved };

  void take_hello(std::span<const std::byte> message);
  std::vector<std::byte> challenge(std::span<const std::byte> their_key);
  void take_proof(std::span<const std::byte> message);

  const Credentials* credentials_;
  Step step_ = Step::hello;
  ConnectionRequest connection_request_;
  PublicKey their_key_{};
  std::optional<KeyPair> key_;
  std::optional<Secret> secret_;  ///< of the proofs
  std::optional<SessionKeys> session_keys_;
  std::vector<std::byte> said_;  ///< hello and challenge, with the keys behind them
  std::vector<std::byte> last_words_;
};

class ClientHandshake {
 public:
  /// `credentials` must outlive it.
  ClientHandshake(const Credentials& credentials, const ConnectionRequest& connection_request,
                  std::uint32_t version = tcp_protocol_version);
  ClientHandshake(Credentials&&, const ConnectionRequest&, std::uint32_t = tcp_protocol_version) = delete;

  /// With its key behind it.
  const std::vector<std::byte>& hello() const { return hello_; }
  /// Throws HandshakeFailed for a challenge behind which no key of this version follows.
  void check(std::span<const std::byte> challenge) const;
  /// The proof, for a challenge with its key behind it. Throws HandshakeFailed.
  std::vector<std::byte> answer(std::span<const std::byte> challenge_and_key);
  /// Throws HandshakeFailed unless the server has the secret and lets this client in.
  void finish(std::span<const std::byte> verdict) const;
  /// Of this end, once finished; none for a client that wanted to do without.
  std::optional<SessionKeys> session_keys() const;

 private:
  const Credentials* credentials_;
  std::uint32_t version_;
  bool plain_;
  KeyPair key_;
  PublicKey their_key_{};
  std::optional<Secret> secret_;  ///< of the proofs
  std::vector<std::byte> hello_;
  std::vector<std::byte> said_;
};

}  // namespace understudy::compositor
