#include "apps/understudy/view/secret.h"

#include <fmt/format.h>
#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/hmac.h>
#include <openssl/rand.h>

#include <array>
#include <span>
#include <stdexcept>
#include <vector>

namespace understudy::launcher {
namespace {

/// Of other proofs under the same secret, none is one of these.
constexpr std::string_view purpose = "understudy view ";

std::string digits_of(std::span<const unsigned char> bytes) {
  std::string digits;
  for (const unsigned char byte : bytes) digits += fmt::format("{:02x}", byte);
  return digits;
}

}  // namespace

std::string random_digits(std::size_t bytes) {
  std::vector<unsigned char> random(bytes);
  if (RAND_bytes(random.data(), int(random.size())) != 1)
    throw std::runtime_error("the system gives no random numbers");
  return digits_of(random);
}

std::string proof_of(std::string_view secret, std::string_view challenge) {
  const std::string message = std::string(purpose).append(challenge);
  std::array<unsigned char, EVP_MAX_MD_SIZE> proof{};
  unsigned size = 0;
  if (HMAC(EVP_sha256(), secret.data(), int(secret.size()),
           reinterpret_cast<const unsigned char*>(message.data()), message.size(), proof.data(),
           &size) == nullptr)
    throw std::runtime_error("HMAC-SHA-256 cannot be computed");
  return digits_of(std::span(proof).first(size));
}

bool equal(std::string_view a, std::string_view b) {
  return a.size() == b.size() && CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

}  // namespace understudy::launcher
