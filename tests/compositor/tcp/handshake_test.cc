// SPDX-License-Identifier: Apache-2.0
// Which clients are accepted, and what the others receive: nothing is trusted that is not proved.
#include "compositor/transport/tcp/handshake.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstring>
#include <fstream>
#include <functional>
#include <random>
#include <set>

#include "compositor/transport/tcp/address.h"
#include "compositor/transport/tcp/key_file.h"
#include "compositor/transport/tcp/secret.h"
#include "compositor/transport/wire.h"
#include "tests/compositor/scratch_folder.h"
#include "tests/compositor/tcp/session.h"

namespace understudy::compositor {
namespace {

using testing::challenge_to;
using ::testing::HasSubstr;
using testing::ScratchFolder;
using testing::secret_of;

std::string failure(const std::function<void()>& step) {
  try {
    step();
  } catch (const HandshakeFailed& error) {
    return error.what();
  }
  return {};
}

const ConnectionRequest some_wishes = {Destination::gl_server, Layout::rgba8, 75, true, true};

TEST(Handshake, BothSidesProveThemselvesAndTheWishesArrive) {
  const Credentials secret = secret_of("sixteen bytes or more");
  ClientHandshake client(secret, some_wishes);
  ServerHandshake server(secret);
  ASSERT_EQ(server.wants(), hello_bytes);
  const auto challenge = challenge_to(server, client.hello());
  ASSERT_EQ(server.wants(), proof_bytes);
  EXPECT_FALSE(server.proved());
  EXPECT_TRUE(server.answer(client.answer(challenge)).empty());
  EXPECT_TRUE(server.proved());
  EXPECT_EQ(server.wants(), 0U);
  EXPECT_EQ(server.connection_request().to, Destination::gl_server);
  EXPECT_EQ(server.connection_request().pixels, Layout::rgba8);
  EXPECT_EQ(server.connection_request().jpeg_quality, 75);
  EXPECT_TRUE(server.connection_request().only_asks);
  EXPECT_TRUE(server.connection_request().plain);
  EXPECT_NO_THROW(client.finish(server.verdict(AdmissionVerdict::accepted)));
  EXPECT_THAT(failure([&] { client.finish(server.verdict(AdmissionVerdict::too_many)); }),
              HasSubstr("try again later"));
  EXPECT_THAT(failure([&] { client.finish(server.verdict(AdmissionVerdict::not_offered)); }),
              HasSubstr("--gl-server"));
  EXPECT_THAT(failure([&] { client.finish(server.verdict(AdmissionVerdict::not_plain)); }),
              HasSubstr("leave --plain out"));
  EXPECT_FALSE(client.session_keys().has_value());
  EXPECT_FALSE(server.session_keys().has_value());
}

TEST(Handshake, EachSessionHasKeysOfItsOwnAndOneForEachDirection) {
  const Credentials secret = secret_of("sixteen bytes or more");
  std::set<std::array<unsigned char, session_key_bytes>> all;
  for (int session = 0; session < 3; ++session) {
    const auto [client, server] = testing::keys_of_session(secret);
    EXPECT_EQ(client.send, server.receive);
    EXPECT_EQ(client.receive, server.send);
    all.insert({client.send, client.receive});
  }
  EXPECT_EQ(all.size(), 6U);
}

/// An attacker in the middle replaces the keys of both ends: it has keys with each, but no proof.
TEST(Handshake, KeysThatWereExchangedOnTheWayAreNotBelieved) {
  const Credentials secret = secret_of("sixteen bytes or more");
  const KeyPair of_somebody;
  const auto with_their_key = [&](std::vector<std::byte> words, std::size_t at) {
    std::ranges::copy(std::as_bytes(std::span(of_somebody.public_key())), words.begin() + std::ptrdiff_t(at));
    return words;
  };
  ClientHandshake client(secret, {});
  ServerHandshake server(secret);
  const auto challenge = challenge_to(server, with_their_key(client.hello(), hello_bytes));
  EXPECT_THROW(server.answer(client.answer(with_their_key(challenge, challenge_bytes))), HandshakeFailed);
  EXPECT_FALSE(server.session_keys().has_value());
}

TEST(Handshake, AKeyThatGivesAKnownSecretIsNone) {
  const Secret secret(std::as_bytes(std::span("sixteen bytes or more")));
  PublicKey one{};
  one[0] = 1;  // of order 1
  for (const PublicKey& weak : {PublicKey{}, one}) {
    EXPECT_THROW(session_keys(Side::server, KeyPair(), weak, secret, {}), MalformedMessage);
    EXPECT_FALSE(KeyPair().shared_with(weak).has_value());
  }
}

/// A client and a server with key files; whether the server accepts the client.
struct ByKeys {
  KeyPair client;
  KeyPair server;

  static bool let_in(const Credentials& of_client, const Credentials& of_server) {
    ClientHandshake client(of_client, {});
    ServerHandshake server(of_server);
    try {
      server.answer(client.answer(challenge_to(server, client.hello())));
      client.finish(server.verdict(AdmissionVerdict::accepted));
    } catch (const HandshakeFailed&) {
      return false;
    }
    EXPECT_EQ(client.session_keys().value().send, server.session_keys().value().receive);
    return true;
  }
};

TEST(Handshake, KeysServeInPlaceOfASecret) {
  const ByKeys keys;
  const KeyPair other;
  const Credentials client(keys.client, {keys.server.public_key()});
  EXPECT_TRUE(ByKeys::let_in(client, {keys.server, {other.public_key(), keys.client.public_key()}}));
  // One of the keys is a different one.
  EXPECT_FALSE(ByKeys::let_in(client, {keys.server, {other.public_key()}}));
  EXPECT_FALSE(ByKeys::let_in(client, {other, {keys.client.public_key()}}));
  EXPECT_FALSE(ByKeys::let_in({other, {keys.server.public_key()}}, {keys.server, {keys.client.public_key()}}));
  EXPECT_FALSE(ByKeys::let_in({keys.client, {other.public_key()}}, {keys.server, {keys.client.public_key()}}));
  // Keys at one end alone are not enough.
  EXPECT_FALSE(ByKeys::let_in(secret_of("what somebody made up"), {keys.server, {keys.client.public_key()}}));
  EXPECT_FALSE(ByKeys::let_in(client, secret_of("sixteen bytes or more")));
}

TEST(Handshake, AServerMayHaveKeysAndASecret) {
  const ByKeys keys;
  const std::string text = "sixteen bytes or more";
  const Credentials server(keys.server, {keys.client.public_key()}, Secret(std::as_bytes(std::span(text))));
  EXPECT_TRUE(ByKeys::let_in(secret_of(text), server));
  EXPECT_TRUE(ByKeys::let_in({keys.client, {keys.server.public_key()}}, server));
  EXPECT_FALSE(ByKeys::let_in(secret_of("what somebody made up"), server));
}

/// A stolen key of a server does not make its thief a client.
TEST(Handshake, AStolenKeyOfAServerMakesNoClient) {
  const ByKeys keys;
  const Credentials thief(keys.server, {keys.server.public_key()});
  ClientHandshake client(thief, {});
  std::vector<std::byte> hello = client.hello();
  std::ranges::copy(std::as_bytes(std::span(keys.client.public_key())), hello.end() - public_key_bytes);
  const Credentials credentials(keys.server, {keys.client.public_key()});
  ServerHandshake server(credentials);
  EXPECT_THROW(server.answer(client.answer(challenge_to(server, hello))), HandshakeFailed);
}

TEST(KeyFile, IsMadeForItsOwnerAloneAndReadAgain) {
  const ScratchFolder folder;
  const std::string file = folder / "key";
  const KeyPair key = make_key_file(file);
  struct stat status {};
  ASSERT_EQ(::stat(file.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 07777, 0600U);
  EXPECT_EQ(read_key_file(file).public_key(), key.public_key());
  EXPECT_EQ(read_public_keys(file + ".pub"), std::vector{key.public_key()});
  // Existing files are not overwritten.
  EXPECT_THROW(make_key_file(file), std::runtime_error);
  std::filesystem::remove(file + ".pub");
  EXPECT_THROW(make_key_file(file), std::runtime_error);
  EXPECT_EQ(read_key_file(file).public_key(), key.public_key());
  ::chmod(file.c_str(), 0644);
  EXPECT_THROW(read_key_file(file), std::runtime_error);
}

TEST(KeyFile, OfManyClientsHasALineForEach) {
  const ScratchFolder folder;
  const std::string file = folder / "clients";
  const std::vector<PublicKey> keys = {KeyPair().public_key(), KeyPair().public_key()};
  std::ofstream(file) << "# who may come in\n\n"
                      << line_of(keys[0]) << " the first\n"
                      << line_of(keys[1]) << "\n";
  EXPECT_EQ(read_public_keys(file), keys);
  const auto refused = [&](const std::string& contents) {
    std::ofstream(file) << contents;
    EXPECT_THROW(read_public_keys(file), std::runtime_error) << contents;
  };
  refused("");
  refused("# nobody\n");
  refused("understudy-key\n");
  refused("understudy-key AAAA\n");
  refused(line_of(keys[0]).substr(1) + "\n");
  refused(line_of(keys[0]) + "\nsomething else\n");
  EXPECT_THROW(read_public_keys(folder / "missing"), std::runtime_error);
  EXPECT_THROW(read_key_file(file), std::runtime_error);
}

TEST(Handshake, AWishForNoEncryptionIsNotPutInOnTheWay) {
  const Credentials secret = secret_of("sixteen bytes or more");
  ClientHandshake client(secret, {});
  std::vector<std::byte> changed = client.hello();
  changed[15] |= std::byte(2);
  ServerHandshake server(secret);
  EXPECT_THROW(server.answer(client.answer(challenge_to(server, changed))), HandshakeFailed);
  EXPECT_TRUE(server.connection_request().plain);
  EXPECT_FALSE(server.proved());
}

TEST(Handshake, AnotherSecretIsToldSoAndLearnsNothing) {
  const Credentials theirs = secret_of("one secret of a client");
  const Credentials ours = secret_of("another one, of a server");
  ClientHandshake client(theirs, {});
  ServerHandshake server(ours);
  const auto proof = client.answer(challenge_to(server, client.hello()));
  EXPECT_THAT(failure([&] { server.answer(proof); }), HasSubstr("--secret-file"));
  EXPECT_FALSE(server.proved());
  const std::vector<std::byte> words(server.last_words().begin(), server.last_words().end());
  ASSERT_EQ(words.size(), verdict_bytes);
  // No byte that only a holder of the secret can compute.
  EXPECT_TRUE(std::all_of(words.begin() + 8, words.end(), [](std::byte byte) { return byte == std::byte(0); }));
  EXPECT_THAT(failure([&] { client.finish(words); }), HasSubstr("copy its --secret-file"));
}

TEST(Handshake, AServerWithoutTheSecretIsNotTrusted) {
  const Credentials ours = secret_of("the secret of a client");
  const Credentials theirs = secret_of("what somebody made up");
  ClientHandshake client(ours, {});
  ServerHandshake impostor(theirs);
  client.answer(challenge_to(impostor, client.hello()));
  EXPECT_THAT(failure([&] { client.finish(impostor.verdict(AdmissionVerdict::accepted)); }),
              HasSubstr("do not trust it"));
}

TEST(Handshake, ProofsServeOnce) {
  const Credentials secret = secret_of("sixteen bytes or more");
  ClientHandshake client(secret, {});
  ServerHandshake first(secret);
  const auto proof = client.answer(challenge_to(first, client.hello()));
  EXPECT_NO_THROW(first.answer(proof));
  // The same messages, replayed to the server, which has another random number now.
  ServerHandshake second(secret);
  challenge_to(second, client.hello());
  EXPECT_THROW(second.answer(proof), HandshakeFailed);
  // The server's own message, sent back to it.
  const std::vector<std::byte> verdict = first.verdict(AdmissionVerdict::accepted);
  ServerHandshake third(secret);
  challenge_to(third, client.hello());
  EXPECT_THROW(third.answer(std::span(verdict).subspan(8)), HandshakeFailed);
}

TEST(Handshake, OtherWishesThanProvedAreNotBelieved) {
  const Credentials secret = secret_of("sixteen bytes or more");
  ClientHandshake client(secret, some_wishes);
  for (std::size_t at = 0; at < client.hello().size(); ++at) {
    std::vector<std::byte> changed = client.hello();
    changed[at] ^= std::byte(1);
    EXPECT_THROW(
        {
          ServerHandshake server(secret);
          server.answer(client.answer(challenge_to(server, changed)));
        },
        HandshakeFailed)
        << "byte " << at;
  }
}

TEST(Handshake, OtherVersionsAreToldOnBothSides) {
  const Credentials secret = secret_of("sixteen bytes or more");
  ClientHandshake newer(secret, {}, tcp_protocol_version + 1);
  ServerHandshake server(secret);
  EXPECT_THAT(failure([&] { challenge_to(server, newer.hello()); }), HasSubstr("one version of Understudy"));
  ASSERT_EQ(server.last_words().size(), challenge_bytes);
  EXPECT_THAT(failure([&] { newer.check(server.last_words()); }), HasSubstr("one version of Understudy"));
}

TEST(Handshake, GarbageIsNeverBelieved) {
  const Credentials secret = secret_of("sixteen bytes or more");
  std::mt19937 random(7);
  const auto garbage = [&](std::size_t size) {
    std::vector<std::byte> bytes(size);
    for (std::byte& byte : bytes) byte = std::byte(random());
    return bytes;
  };
  for (int round = 0; round < 200; ++round) {
    ServerHandshake strict(secret);
    EXPECT_THROW(strict.answer(garbage(hello_bytes)), HandshakeFailed);
    EXPECT_THROW(strict.answer(garbage(round)), HandshakeFailed);
    ClientHandshake client(secret, {});
    ServerHandshake server(secret);
    challenge_to(server, client.hello());
    EXPECT_THROW(server.answer(garbage(proof_bytes)), HandshakeFailed);
    EXPECT_THROW(client.answer(garbage(challenge_bytes + server_key_bytes)), HandshakeFailed);
    EXPECT_THROW(client.finish(garbage(verdict_bytes)), HandshakeFailed);
  }
}

TEST(Secret, IsMadeOnceForItsOwnerAlone) {
  const ScratchFolder folder;
  const std::string file = folder / "secret";
  bool made = false;
  const Secret first = read_or_make_secret(file, made);
  EXPECT_TRUE(made);
  struct stat status {};
  ASSERT_EQ(::stat(file.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 07777, 0600U);
  EXPECT_EQ(status.st_size, 32);
  const Secret second = read_or_make_secret(file, made);
  EXPECT_FALSE(made);
  EXPECT_TRUE(std::ranges::equal(first.key(), second.key()));
  // No other file was left there.
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(std::string(folder / "")), {}), 1);
}

TEST(Secret, WhatOthersMayReadOrGuessIsNone) {
  const ScratchFolder folder;
  const auto refused = [&](const char* name, const std::string& contents, mode_t mode) {
    const std::string file = folder / name;
    std::ofstream(file) << contents;
    ::chmod(file.c_str(), mode);
    try {
      read_secret(file);
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(refused("readable", std::string(32, 'x'), 0644), HasSubstr("chmod 600"));
  EXPECT_THAT(refused("short", "x", 0600), HasSubstr("16 to 4096 bytes"));
  EXPECT_THAT(refused("long", std::string(5000, 'x'), 0600), HasSubstr("16 to 4096 bytes"));
  EXPECT_THROW(read_secret(folder / "missing"), std::runtime_error);
  EXPECT_THROW(read_secret(std::string(folder / "")), std::runtime_error);
  bool made = false;
  EXPECT_THROW(read_or_make_secret("/nowhere/at/all", made), std::runtime_error);
}

TEST(Address, OneFunctionReadsThemAll) {
  const auto text = [](const std::string& written) {
    const auto address = tcp_address_of(written);
    return address ? address->text() : "a path";
  };
  EXPECT_EQ(text("host:80"), "host:80");
  EXPECT_EQ(text("192.0.2.1:7070"), "192.0.2.1:7070");
  EXPECT_EQ(text("[2001:db8::1]:7070"), "[2001:db8::1]:7070");
  EXPECT_EQ(text(":7070"), "127.0.0.1:7070");
  EXPECT_EQ(text("7070"), "127.0.0.1:7070");
  EXPECT_EQ(text("/run/nodes:1.sock"), "a path");
  EXPECT_EQ(text("nodes.sock"), "a path");
  EXPECT_EQ(text(""), "a path");
  for (const char* wrong : {"host:", "host:x", "host:70000", "host:-1", "::1:80", "host:80 "})
    EXPECT_THROW(tcp_address_of(wrong), std::runtime_error) << wrong;
}

}  // namespace
}  // namespace understudy::compositor
