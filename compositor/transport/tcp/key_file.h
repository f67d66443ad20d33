// SPDX-License-Identifier: Apache-2.0
// Files with keys. A key file holds an end's own pair, for its user alone (mode 0600); beside it lies FILE.pub
// with the public key, a line that may be shown to anybody. A file of public keys has one such line for each;
// what follows the key in a line, empty lines and those that begin with # say nothing.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "compositor/transport/tcp/key_pair.h"

namespace understudy::compositor {

constexpr std::size_t max_public_keys = 4096;  ///< in a file

/// The line of a file of public keys.
std::string line_of(const PublicKey& key);

/// Makes `file` and `file`.pub. Throws std::runtime_error where one is there, or cannot be made.
KeyPair make_key_file(const std::filesystem::path& file);
/// Throws std::runtime_error, with what to do.
KeyPair read_key_file(const std::filesystem::path& file);
/// At least one. Throws std::runtime_error, with what to do.
std::vector<PublicKey> read_public_keys(const std::filesystem::path& file);

}  // namespace understudy::compositor
