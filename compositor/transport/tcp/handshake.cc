// SPDX-License-Identifier: Apache-2.0
#include "compositor/transport/tcp/handshake.h"

#include <fmt/format.h>
#include <sodium.h>

#include <cstring>
#include <string_view>

#include "compositor/transport/wire.h"

namespace understudy::compositor {

namespace {

using Buffer = std::vector<std::byte>;
using Nonce = std::array<std::uint8_t, 32>;
using Mac = std::array<unsigned char, crypto_auth_BYTES>;
static_assert(sizeof(Mac) == proof_bytes);

constexpr std::array<char, 8> magic = {'U', 'N', 'D', 'E', 'R', 'L', 'N', 'K'};

struct HandshakeHello {
  std::array<char, 8> magic_number = magic;
  std::uint32_t version = tcp_protocol_version;
  std::uint8_t to = 0;
  std::uint8_t pixels = 0;
  std::uint8_t jpeg_quality = 0;
  std::uint8_t flags = 0;
  Nonce nonce{};
};
static_assert(sizeof(HandshakeHello) == hello_bytes);

struct Challenge {
  std::array<char, 8> magic_number = magic;
  std::uint32_t version = tcp_protocol_version;
  std::uint32_t unused = 0;
  Nonce nonce{};
};
static_assert(sizeof(Challenge) == challenge_bytes);

struct VerdictWords {
  std::uint32_t verdict = 0;
  std::uint32_t unused = 0;
  Mac proof{};
};
static_assert(sizeof(VerdictWords) == verdict_bytes);

enum Flag : std::uint8_t { only_asks = 1, plain = 2, all_flags = only_asks | plain };

template <class Words>
Buffer buffer_of(const Words& words) {
  const auto bytes = std::as_bytes(std::span(&words, 1));
  return {bytes.begin(), bytes.end()};
}

template <class Words>
Words words_of(std::span<const std::byte> bytes) {
  Words words;
  if (bytes.size() != sizeof words) throw HandshakeFailed("it said less than it should");
  std::memcpy(&words, bytes.data(), sizeof words);
  return words;
}

void append(Buffer& to, const PublicKey& key) {
  const auto bytes = std::as_bytes(std::span(key));
  to.insert(to.end(), bytes.begin(), bytes.end());
}

Nonce fresh_nonce() {
  Nonce nonce;
  ::randombytes_buf(nonce.data(), nonce.size());
  return nonce;
}

/// The server's proof includes `verdict`, so that nobody can turn one verdict into another.
Mac proof(const Secret& secret, std::string_view label, std::span<const std::byte> said,
          std::uint32_t verdict = 0) {
  Buffer text(label.size() + said.size() + sizeof verdict);
  std::memcpy(text.data(), label.data(), label.size());
  std::memcpy(text.data() + label.size(), said.data(), said.size());
  std::memcpy(text.data() + label.size() + said.size(), &verdict, sizeof verdict);
  Mac mac;
  ::crypto_auth(mac.data(), reinterpret_cast<const unsigned char*>(text.data()), text.size(),
                secret.key().data());
  return mac;
}

bool same(const Mac& a, const Mac& b) {
  return ::sodium_memcmp(a.data(), b.data(), a.size()) == 0;
}

SessionKeys agreed_keys(const KeyPair& own, Side side, const PublicKey& theirs, const Secret& secret,
                        std::span<const std::byte> said) {
  try {
    return session_keys(side, own, theirs, secret, said);
  } catch (const MalformedMessage& error) {
    throw HandshakeFailed(error.what());
  }
}

constexpr std::string_view from_client = "understudy link: client";
constexpr std::string_view from_server = "understudy link: server";

}  // namespace

std::size_t ServerHandshake::wants() const {
  switch (step_) {
    case Step::hello:
      return hello_bytes;
    case Step::key:
      return client_key_bytes;
    case Step::proof:
      return proof_bytes;
    default:
      return 0;
  }
}

std::vector<std::byte> ServerHandshake::answer(std::span<const std::byte> message) {
  if (step_ == Step::key) return challenge(message);
  if (step_ == Step::hello)
    take_hello(message);
  else
    take_proof(message);
  return {};
}

void ServerHandshake::take_hello(std::span<const std::byte> message) {
  const auto hello = words_of<HandshakeHello>(message);
  if (hello.magic_number != magic) throw HandshakeFailed("it is no program of Understudy");
  if (hello.version != tcp_protocol_version) {
    last_words_ = buffer_of(Challenge{});
    throw HandshakeFailed(
        fmt::format("it speaks version {} of the connection, this is version {}: use one version of "
                    "Understudy on both machines",
                    hello.version, tcp_protocol_version));
  }
  if (hello.to > std::uint8_t(Destination::last) || hello.pixels > std::uint8_t(Layout::rgba8) ||
      hello.jpeg_quality > 100 || (hello.flags & ~all_flags) != 0)
    throw HandshakeFailed("it wants what there is not");
  connection_request_ = {Destination(hello.to), Layout(hello.pixels), hello.jpeg_quality,
                         (hello.flags & only_asks) != 0, (hello.flags & plain) != 0};
  said_.assign(message.begin(), message.end());
  step_ = Step::key;
}

std::vector<std::byte> ServerHandshake::challenge(std::span<const std::byte> their_key) {
  const auto [of_session, of_file] = words_of<std::array<PublicKey, 2>>(their_key);
  their_key_ = of_session;
  append(said_, of_session);
  append(said_, of_file);
  Challenge challenge;
  challenge.nonce = fresh_nonce();
  Buffer words = buffer_of(challenge);
  append(words, key_.emplace().public_key());
  said_.insert(said_.end(), words.begin(), words.end());
  secret_ = credentials_->secret_with_client(*key_, of_session, of_file);
  step_ = Step::proof;
  return words;
}

void ServerHandshake::take_proof(std::span<const std::byte> message) {
  Mac theirs;
  if (step_ != Step::proof || message.size() != sizeof theirs) throw HandshakeFailed("it spoke out of turn");
  std::memcpy(theirs.data(), message.data(), sizeof theirs);
  if (!same(theirs, proof(*secret_, from_client, said_))) {
    // Without a proof: a client without the secret learns nothing about it.
    last_words_ = buffer_of(VerdictWords{std::uint32_t(AdmissionVerdict::wrong_secret)});
    throw HandshakeFailed(
        "its secret is not the one of --secret-file here (give both machines the same file), or its key is not "
        "among those of --clients");
  }
  if (!connection_request_.plain) session_keys_ = agreed_keys(*key_, Side::server, their_key_, *secret_, said_);
  step_ = Step::proved;
}

std::vector<std::byte> ServerHandshake::verdict(AdmissionVerdict verdict) const {
  VerdictWords words{std::uint32_t(verdict)};
  words.proof = proof(*secret_, from_server, said_, words.verdict);
  return buffer_of(words);
}

ClientHandshake::ClientHandshake(const Credentials& credentials, const ConnectionRequest& connection_request,
                                 std::uint32_t version)
    : credentials_(&credentials), version_(version), plain_(connection_request.plain) {
  HandshakeHello hello;
  hello.version = version;
  hello.to = std::uint8_t(connection_request.to);
  hello.pixels = std::uint8_t(connection_request.pixels);
  hello.jpeg_quality = std::uint8_t(connection_request.jpeg_quality);
  hello.flags = std::uint8_t((connection_request.only_asks ? only_asks : 0) | (plain_ ? plain : 0));
  hello.nonce = fresh_nonce();
  hello_ = buffer_of(hello);
  append(hello_, key_.public_key());
  append(hello_, credentials_->public_key());
}

void ClientHandshake::check(std::span<const std::byte> challenge) const {
  const auto words = words_of<Challenge>(challenge);
  if (words.magic_number != magic)
    throw HandshakeFailed("it is no understudy serve --listen: look at host and port");
  if (words.version != version_)
    throw HandshakeFailed(
        fmt::format("it speaks version {} of the connection, this is version {}: use one version of "
                    "Understudy on both machines",
                    words.version, version_));
}

std::vector<std::byte> ClientHandshake::answer(std::span<const std::byte> challenge_and_key) {
  if (challenge_and_key.size() < challenge_bytes) throw HandshakeFailed("it said less than it should");
  check(challenge_and_key.first(challenge_bytes));
  their_key_ = words_of<PublicKey>(challenge_and_key.subspan(challenge_bytes));
  said_ = hello_;
  said_.insert(said_.end(), challenge_and_key.begin(), challenge_and_key.end());
  secret_ = credentials_->secret_with_server(key_, their_key_);
  return buffer_of(proof(*secret_, from_client, said_));
}

void ClientHandshake::finish(std::span<const std::byte> verdict) const {
  const auto words = words_of<VerdictWords>(verdict);
  if (words.verdict == std::uint32_t(AdmissionVerdict::wrong_secret))
    throw HandshakeFailed(credentials_->by_key()
                              ? "it does not know the key of --key, or has another one than that of "
                                "--server-key: append FILE.pub of "
                                "this machine to its --clients"
                              : "its secret is another one: copy its --secret-file to this machine");
  if (!secret_ || words.verdict > std::uint32_t(AdmissionVerdict::last) ||
      !same(words.proof, proof(*secret_, from_server, said_, words.verdict)))
    throw HandshakeFailed(
        credentials_->by_key()
            ? "it has not the key of --server-key itself: do not trust it, look at host and port"
            : "it has not the secret of --secret-file itself: do not trust it, look at host and port");
  if (words.verdict == std::uint32_t(AdmissionVerdict::too_many))
    throw HandshakeFailed("as many clients as it takes are there already: try again later");
  if (words.verdict == std::uint32_t(AdmissionVerdict::not_offered))
    throw HandshakeFailed("it has no GL server: start it with understudy serve --gl-server --listen …");
  if (words.verdict == std::uint32_t(AdmissionVerdict::not_plain))
    throw HandshakeFailed(
        "it encrypts: leave --plain out, or start understudy serve with --plain too, on one machine with this");
}

std::optional<SessionKeys> ClientHandshake::session_keys() const {
  if (plain_) return std::nullopt;
  return agreed_keys(key_, Side::client, their_key_, *secret_, said_);
}

}  // namespace understudy::compositor
