// SPDX-License-Identifier: Apache-2.0
// Authenticates a viewer without transmitting the secret: the server sends a random challenge that it has never
// used before, and the viewer answers with its HMAC-SHA-256 (RFC 2104) under the secret.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace understudy::launcher {

/// Returns this number of random bytes, each as two hexadecimal digits. Throws std::runtime_error.
std::string random_digits(std::size_t bytes);

/// Returns the proof as 64 hexadecimal digits. The key is the text of the secret's digits.
std::string proof_of(std::string_view secret, std::string_view challenge);

/// Compares in a time that does not depend on where they differ.
bool equal(std::string_view a, std::string_view b);

}  // namespace understudy::launcher
