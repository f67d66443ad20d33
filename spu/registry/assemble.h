// SPDX-License-Identifier: Apache-2.0
// Chains from text, as Chromium's configurations made them: "track volume driver". A text that begins with "@"
// or is the name of a .json file stands for the chain in that file. chain_text.h has the grammar, chain_json.h
// the file's form.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "spu/chain.h"
#include "spu/unit_description.h"

namespace understudy::spu {

/// Descriptions that a chain's text may name.
using UnitTable = std::span<const UnitDescription* const>;

/// All units there are, by name.
UnitTable unit_table();

/// Adds the units named in `description`, the one nearest to the application first; "driver" stands for the
/// real OpenGL and must be last. Returns what is wrong with the description, or nothing; a chain with an error
/// adds no unit.
std::optional<std::string> assemble(Chain& chain, std::string_view description,
                                    const std::shared_ptr<RenderSession>& session,
                                    UnitTable units = unit_table());

/// The same chain as text that means the same in every folder: the chain's file is read, and files named in it
/// are absolute, starting from `folder`. Throws ChainError when `description` is not a chain that can be
/// assembled.
std::string resolved_chain(std::string_view description, const std::filesystem::path& folder,
                           UnitTable units = unit_table());

/// The files that units of a resolved chain write. Throws ChainError.
std::vector<std::filesystem::path> files_of_units(std::string_view resolved, UnitTable units = unit_table());

}  // namespace understudy::spu
