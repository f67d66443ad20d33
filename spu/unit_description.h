// SPDX-License-Identifier: Apache-2.0
// What a unit says about itself, so that chains can be made from text (Chromium's units did the same).
#pragma once

#include <memory>
#include <span>

#include "spu/chain.h"
#include "spu/unit_options.h"

namespace understudy::spu {

class RenderSession;

struct UnitDescription;
struct UnitPlugin;

/// What a unit gets when it is made.
struct UnitPlace {
  Chain& chain;
  const UnitDescription& description;
  const OptionValues& options;
  std::shared_ptr<RenderSession> session;  ///< of the process
};

/// Where in a chain a unit may stand.
enum class UnitPosition {
  once,        ///< it finds itself by its type, so a chain can hold one
  repeatable,  ///< any number of times
  last,        ///< the end of every chain
};

/// A constant with static storage, which spu/registry/assemble.cc lists, or what a loaded library says.
struct UnitDescription {
  const char* name;
  const char* help;  ///< one line
  std::span<const UnitOption> options = {};
  UnitPosition position = UnitPosition::once;
  const char* needs = nullptr;        ///< a unit that must stand somewhere before it
  const char* leads_to = nullptr;     ///< a unit that must stand somewhere behind it
  const char* or_leads_to = nullptr;  ///< or this one
  /// Null for what is no unit but the driver.
  std::unique_ptr<Unit> (*make)(const UnitPlace& place) = nullptr;
  const UnitPlugin* plugin = nullptr;  ///< of a unit in a library that was loaded
};

}  // namespace understudy::spu
