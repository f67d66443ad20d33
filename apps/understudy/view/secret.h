// SPDX-License-Identifier: Apache-2.0
// What a viewer must know to be let in, and how it shows that it does without saying it: the server names a
// number that it used never before, the viewer answers with HMAC-SHA-256 (RFC 2104) of it under the secret.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace understudy::launcher {

/// So many random bytes, two hexadecimal digits each. Throws std::runtime_error.
std::string random_digits(std::size_t bytes);

/// 64 hexadecimal digits; the secret's own digits, as text, are the key.
std::string proof_of(std::string_view secret, std::string_view challenge);

/// In a time that does not tell where they differ.
bool equal(std::string_view a, std::string_view b);

}  // namespace understudy::launcher
