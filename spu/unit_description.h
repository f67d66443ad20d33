// SPDX-License-Identifier: Apache-2.0
// How a unit describes itself, so that chains can be assembled from text (as in Chromium).
#pragma once

#include <memory>
#include <span>

#include "spu/chain.h"
#include "spu/unit_options.h"

namespace understudy::spu {

class RenderSession;

struct UnitDescription;
struct UnitPlugin;

/// What a unit is created with.
struct UnitPlace {
  Chain& chain;
  const UnitDescription& description;
  const OptionValues& options;
  std::shared_ptr<RenderSession> session;  ///< shared by the process
};

/// Where in a chain a unit may stand.
enum class UnitPosition {
  once,        ///< at most once: it is looked up by its type
  repeatable,  ///< any number of times
  last,        ///< the end of every chain
};

/// A static constant listed in spu/registry/assemble.cc, or the description of a unit in a loaded library.
struct UnitDescription {
  const char* name;
  const char* help;  ///< one line
  std::span<const UnitOption> options = {};
  UnitPosition position = UnitPosition::once;
  const char* needs = nullptr;        ///< a unit that must precede it in the chain
  const char* leads_to = nullptr;     ///< a unit that must follow it in the chain
  const char* or_leads_to = nullptr;  ///< or this one
  /// Null for the driver, which is not a unit.
  std::unique_ptr<Unit> (*make)(const UnitPlace& place) = nullptr;
  const UnitPlugin* plugin = nullptr;  ///< set for a unit from a loaded library
};

}  // namespace understudy::spu
