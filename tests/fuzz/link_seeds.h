// Inputs for fuzzers to begin with: what two ends of a link say to each other, and an application and a stage,
// as this version says it.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace understudy::spu::testing {

using Seeds = std::map<std::string, std::vector<std::byte>>;  ///< by what they are

/// For play_link_input() of link_input.h.
Seeds link_seeds();
/// For play_stage_input().
Seeds stage_seeds();

}  // namespace understudy::spu::testing
