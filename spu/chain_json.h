// SPDX-License-Identifier: Apache-2.0
// A chain as a JSON file: {"chain": ["track", {"unit": "trace", "file": "a.ust", "level": 3}, "driver"]}.
#pragma once

#include <string>
#include <string_view>

#include "spu/chain_text.h"

namespace understudy::spu {

/// `name` identifies the text in messages. Throws ChainError.
ChainSettings parse_chain_json(std::string_view json, const std::string& name);

/// Throws ChainError, also if the file does not exist or is not a chain.
ChainSettings read_chain_file(const std::string& path);

}  // namespace understudy::spu
