// SPDX-License-Identifier: Apache-2.0
// How the two ends of a connection over TCP find out that they share a secret, before either trusts anything
// else.
//
// The client sends its version, its request and a random number; the server sends its version and another
// random number; the client proves that it has the secret, then the server does. The secret is one that both
// have, or is derived from their key files (credentials.h). A proof is HMAC-SHA-512-256 (libsodium's
// crypto_auth) of a label for the direction and of all that was sent before, so nobody can use one end's proof
// at another end, at another time or for another request. (Challenge and response in both directions: ISO/IEC
// 9798-4.) What was sent includes the public keys from which both ends make the session's keys
// (session_keys.h), with which all that follows is encrypted and authenticated (record.h). Whether to encrypt
// is part of the request: nobody on the way can change it, and a client never gets less than it requested.
//
// Nothing here uses a socket; each step takes one message of a fixed size and returns the next. The first
// message of either side ends before the keys and is the same in all versions, so different versions are
// detected.
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

constexpr std::uint32_t tcp_protocol_version = 5;  ///< grows with every change of the format over TCP

enum class Destination : std::uint8_t {
  nodes,      ///< the render service
  gl_server,  ///< executes the calls of an application
  last = gl_server
};

/// What a client requests.
struct ConnectionRequest {
  Destination to = Destination::nodes;
  Layout pixels = Layout::rgba32f;  ///< of the nodes' images on their way back
  int jpeg_quality = 0;             ///< of images of moving views, 1 to 100; 0: images are sent without loss
  bool only_asks = false;           ///< ask whether this client would be accepted
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
    2 * public_key_bytes;                                   ///< after the hello: the session's, then the file's
constexpr std::size_t server_key_bytes = public_key_bytes;  ///< after the challenge
constexpr std::size_t proof_bytes = 32;
constexpr std::size_t verdict_bytes = 40;

/// The other end is not trusted, or does not trust this one. The text says why, and what to do.
class HandshakeFailed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class ServerHandshake {
 public:
  /// `credentials` must outlive this object.
  explicit ServerHandshake(const Credentials& credentials) : credentials_(&credentials) {}
  explicit ServerHandshake(Credentials&&) = delete;

  /// Size of the client's next message; 0 if there is none.
  std::size_t wants() const;
  /// Returns the answer to a message. Throws HandshakeFailed: only last_words() may be sent then.
  std::vector<std::byte> answer(std::span<const std::byte> message);
  /// Whether the client has proved that it has the secret.
  bool proved() const { return step_ == Step::proved; }
  /// Returns the message that tells a client whether it is accepted; once proved.
  std::vector<std::byte> verdict(AdmissionVerdict verdict) const;
  std::span<const std::byte> last_words() const { return last_words_; }
  const ConnectionRequest& connection_request() const { return connection_request_; }
  /// The keys of this end, once proved; null if the client requested no encryption.
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
  std::vector<std::byte> said_;  ///< hello and challenge, each followed by its keys
  std::vector<std::byte> last_words_;
};

class ClientHandshake {
 public:
  /// `credentials` must outlive this object.
  ClientHandshake(const Credentials& credentials, const ConnectionRequest& connection_request,
                  std::uint32_t version = tcp_protocol_version);
  ClientHandshake(Credentials&&, const ConnectionRequest&, std::uint32_t = tcp_protocol_version) = delete;

  /// Followed by the client's keys.
  const std::vector<std::byte>& hello() const { return hello_; }
  /// Throws HandshakeFailed if no key of this version follows the challenge.
  void check(std::span<const std::byte> challenge) const;
  /// Returns the proof, for a challenge followed by the server's key. Throws HandshakeFailed.
  std::vector<std::byte> answer(std::span<const std::byte> challenge_and_key);
  /// Throws HandshakeFailed unless the server has the secret and accepts this client.
  void finish(std::span<const std::byte> verdict) const;
  /// The keys of this end, once finished; null if the client requested no encryption.
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
