// SPDX-License-Identifier: Apache-2.0
// Pairs of X25519 keys (Bernstein 2006): of one session, or of a key file (key_file.h).
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include "compositor/transport/tcp/secret.h"

namespace understudy::compositor {

constexpr std::size_t public_key_bytes = 32;
constexpr std::size_t private_key_bytes = 32;

using PublicKey = std::array<unsigned char, public_key_bytes>;

/// Wiped on destruction.
class KeyPair {
 public:
  /// Makes a new pair.
  KeyPair();
  explicit KeyPair(std::span<const unsigned char, private_key_bytes> private_key);
  KeyPair(const KeyPair&) = default;
  KeyPair& operator=(const KeyPair&) = default;
  ~KeyPair();

  const PublicKey& public_key() const { return public_; }
  std::span<const unsigned char, private_key_bytes> private_key() const { return private_; }
  /// Returns what this pair and that of `theirs` agree on, which nobody else can know; null if `theirs` is no
  /// key.
  std::optional<Secret> shared_with(const PublicKey& theirs) const;

 private:
  PublicKey public_{};
  std::array<unsigned char, private_key_bytes> private_{};
};

}  // namespace understudy::compositor
