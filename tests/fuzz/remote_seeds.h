// SPDX-License-Identifier: Apache-2.0
// Initial inputs for fuzzers: messages of the two ends of a connection, and of an application and a GL server,
// in the current protocol version.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace understudy::spu::testing {

using Seeds = std::map<std::string, std::vector<std::byte>>;  ///< by description

/// For play_remote_input() of remote_input.h.
Seeds remote_seeds();
/// For open_records() of record_input.h.
Seeds record_seeds();
/// For play_gl_server_input().
Seeds gl_server_seeds();

}  // namespace understudy::spu::testing
