// SPDX-License-Identifier: Apache-2.0
// Assembles chains from text, as Chromium does from its configurations: "track volume driver". A text that
// begins with "@" or is the name of a .json file refers to the chain in that file. chain_text.h has the
// grammar, chain_json.h the format of the file.
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

/// The descriptions that a chain's text may refer to.
using UnitTable = std::span<const UnitDescription* const>;

/// All units, by name.
UnitTable unit_table();

/// Adds the units named in `description`, the one nearest to the application first; "driver" stands for the
/// real OpenGL and must be last. Returns an error in the description, or nothing; after an error the chain has
/// no units.
std::optional<std::string> assemble(Chain& chain, std::string_view description,
                                    const std::shared_ptr<RenderSession>& session,
                                    UnitTable units = unit_table());

/// Returns the chain as text that is independent of the working folder: a chain's file is replaced by its
/// contents, and the files named in it become absolute, relative to `folder`. Throws ChainError if
/// `description` is not a chain that can be assembled.
std::string resolved_chain(std::string_view description, const std::filesystem::path& folder,
                           UnitTable units = unit_table());

/// Returns the files that the units of a resolved chain write. Throws ChainError.
std::vector<std::filesystem::path> files_of_units(std::string_view resolved, UnitTable units = unit_table());

}  // namespace understudy::spu
