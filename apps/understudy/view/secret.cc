// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/view/secret.h"

#include <fmt/format.h>
#include <sodium.h>

#include <array>
#include <span>
#include <stdexcept>
#include <vector>

namespace understudy::launcher {
namespace {

/// Prefix that distinguishes these proofs from others made with the same secret.
constexpr std::string_view purpose = "understudy view ";

std::string digits_of(std::span<const unsigned char> bytes) {
  std::string digits;
  for (const unsigned char byte : bytes) digits += fmt::format("{:02x}", byte);
  return digits;
}

}  // namespace

std::string random_digits(std::size_t bytes) {
  if (::sodium_init() < 0) throw std::runtime_error("the system provides no random numbers");
  std::vector<unsigned char> random(bytes);
  ::randombytes_buf(random.data(), random.size());
  return digits_of(random);
}

std::string proof_of(std::string_view secret, std::string_view challenge) {
  const std::string message = std::string(purpose).append(challenge);
  const auto bytes_of = [](std::string_view text) {
    return reinterpret_cast<const unsigned char*>(text.data());
  };
  crypto_auth_hmacsha256_state state;
  std::array<unsigned char, crypto_auth_hmacsha256_BYTES> proof{};
  ::crypto_auth_hmacsha256_init(&state, bytes_of(secret), secret.size());
  ::crypto_auth_hmacsha256_update(&state, bytes_of(message), message.size());
  ::crypto_auth_hmacsha256_final(&state, proof.data());
  return digits_of(proof);
}

bool equal(std::string_view a, std::string_view b) {
  return a.size() == b.size() && ::sodium_memcmp(a.data(), b.data(), a.size()) == 0;
}

}  // namespace understudy::launcher
