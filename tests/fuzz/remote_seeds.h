// SPDX-License-Identifier: Apache-2.0
// Inputs for fuzzers to begin with: what two ends of a link say to each other, and an application and a GL
// server, as this version says it.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace understudy::spu::testing {

using Seeds = std::map<std::string, std::vector<std::byte>>;  ///< by what they are

/// For play_remote_input() of remote_input.h.
Seeds remote_seeds();
/// For open_records() of record_input.h.
Seeds record_seeds();
/// For play_gl_server_input().
Seeds gl_server_seeds();

}  // namespace understudy::spu::testing
