// SPDX-License-Identifier: Apache-2.0
#include "compositor/transport/tcp/key_pair.h"

#include <sodium.h>

#include <algorithm>
#include <stdexcept>

namespace understudy::compositor {

KeyPair::KeyPair() {
  static_assert(crypto_kx_PUBLICKEYBYTES == public_key_bytes);
  static_assert(crypto_kx_SECRETKEYBYTES == private_key_bytes);
  if (::sodium_init() < 0) throw std::runtime_error("this machine has no random numbers for keys");
  ::crypto_kx_keypair(public_.data(), private_.data());
}

KeyPair::KeyPair(std::span<const unsigned char, private_key_bytes> private_key) {
  std::ranges::copy(private_key, private_.begin());
  ::crypto_scalarmult_base(public_.data(), private_.data());
}

KeyPair::~KeyPair() {
  ::sodium_memzero(private_.data(), private_.size());
}

std::optional<Secret> KeyPair::shared_with(const PublicKey& theirs) const {
  std::array<unsigned char, crypto_scalarmult_BYTES> value{};
  const bool is_key = ::crypto_scalarmult(value.data(), private_.data(), theirs.data()) == 0;
  const Secret shared(std::as_bytes(std::span(value)));
  ::sodium_memzero(value.data(), value.size());
  return is_key ? std::optional(shared) : std::nullopt;
}

}  // namespace understudy::compositor
