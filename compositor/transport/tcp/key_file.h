// SPDX-License-Identifier: Apache-2.0
// Files with keys. A key file holds an end's own pair, for its user alone (mode 0600); beside it is FILE.pub
// with the public key, a line that anybody may see. A file of public keys has one such line for each key; text
// after a key, empty lines and lines that begin with # are ignored.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "compositor/transport/tcp/key_pair.h"

namespace understudy::compositor {

constexpr std::size_t max_public_keys = 4096;  ///< in a file

/// Returns a key's line in a file of public keys.
std::string line_of(const PublicKey& key);

/// Makes `file` and `file`.pub. Throws std::runtime_error if one of them exists or cannot be made.
KeyPair make_key_file(const std::filesystem::path& file);
/// Reads a key file. Throws std::runtime_error, with what to do.
KeyPair read_key_file(const std::filesystem::path& file);
/// Returns at least one key. Throws std::runtime_error, with what to do.
std::vector<PublicKey> read_public_keys(const std::filesystem::path& file);

}  // namespace understudy::compositor
