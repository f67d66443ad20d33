// SPDX-License-Identifier: Apache-2.0
// How the two ends of a connection over TCP find out that they share a secret, before either believes anything
// else.
//
// The client says its version, what it wants and a random number; the server its version and another one; the
// client proves that it has the secret, then the server does. A proof is HMAC-SHA-512-256 (libsodium's
// crypto_auth) of a label for the direction and of all that was said before, so that nobody can use one end's
// proof at another, at another time or for other wishes. (Challenge and response in both directions: ISO/IEC
// 9798-4.) What comes later is neither signed nor encrypted: on networks that others can write to, connections
// go through ssh.
//
// Nothing here touches a socket; each step takes one message of a fixed size and gives the next.
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
#include "compositor/transport/tcp/secret.h"

namespace understudy::compositor {

constexpr std::uint32_t tcp_protocol_version = 2;  ///< grows with every change of what travels over TCP

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
};

enum class AdmissionVerdict : std::uint32_t {
  accepted,
  wrong_secret,
  too_many,
  not_offered,
  last = not_offered
};

constexpr std::size_t hello_bytes = 48;
constexpr std::size_t challenge_bytes = 48;
constexpr std::size_t proof_bytes = 32;
constexpr std::size_t verdict_bytes = 40;

/// The other end cannot be believed, or does not believe this one. The text says why, and what to do.
class HandshakeFailed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class ServerHandshake {
 public:
  explicit ServerHandshake(const Secret& secret);

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

 private:
  enum class Step { hello, proof, proved };

  const Secret* secret_;
  Step step_ = Step::hello;
  ConnectionRequest connection_request_;
  std::vector<std::byte> said_;  ///< hello and challenge
  std::vector<std::byte> last_words_;
};

class ClientHandshake {
 public:
  ClientHandshake(const Secret& secret, const ConnectionRequest& connection_request,
                  std::uint32_t version = tcp_protocol_version);

  const std::vector<std::byte>& hello() const { return hello_; }
  /// The proof. Throws HandshakeFailed.
  std::vector<std::byte> answer(std::span<const std::byte> challenge);
  /// Throws HandshakeFailed unless the server has the secret and lets this client in.
  void finish(std::span<const std::byte> verdict) const;

 private:
  const Secret* secret_;
  std::uint32_t version_;
  std::vector<std::byte> hello_;
  std::vector<std::byte> said_;
};

}  // namespace understudy::compositor
