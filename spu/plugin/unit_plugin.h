// SPDX-License-Identifier: Apache-2.0
// A stream processing unit that is built outside of this project: a shared library that `--chain` names. This
// header is all that it needs; docs/new-spu.md makes one.
//
// The library exports one UnitPlugin under the name `understudy_unit` (UNDERSTUDY_EXPORT_UNIT). It calls
// nothing of Understudy's by name: what it needs comes through pointers, so that it can be loaded by the
// launcher, which looks at its options, and by the library under the viewer.
#pragma once

#include <cstdint>
#include <span>

#include "dispatch/signature.h"
#include "dispatch/table.h"
#include "spu/unit_options.h"

namespace understudy::spu {

/// Raised with every change of this header and of UnitOption. A library that was built with another is refused.
constexpr std::uint32_t unit_plugin_interface = 1;

struct UnitPlugin;
struct UnitPluginHost;

/// An option of a unit with its value, which has been checked: what the chain says, or the default.
struct UnitPluginOption {
  const char* name;
  double number;     ///< of an integer or a number; on or off: 1 or 0; of a range its first
  double last;       ///< of a range; of others as `number`
  const char* text;  ///< of a text, a file or a choice; of others empty. As long as make() runs.
};

/// The unit of one context. Functions are called on the thread that has the context current.
class PluginUnit {
 public:
  virtual ~PluginUnit() = default;
  /// Overrides slots of `table`, which holds the next unit's functions. Called several times, with the same
  /// intent. Slots that are null, commands that the driver lacks, stay null whatever is put into them.
  virtual void fill(DispatchTable& table) = 0;
  /// Whatever was held back must be in the framebuffer when this returns.
  virtual void settle() {}
  /// A frame has ended.
  virtual void frame_ended() {}
  /// The context goes away; no OpenGL call is allowed.
  virtual void abandon() {}

  /// The functions of the unit below: OpenGL is called through these alone. Not in a constructor.
  const DispatchTable& next() const;

 private:
  friend class UnitOfPlugin;
  const UnitPluginHost* host_ = nullptr;
  const void* place_ = nullptr;  ///< in its chain
};

/// What a library is given when it is loaded.
struct UnitPluginHost {
  /// The unit of `plugin` in the chain that is current on this thread. Never null in functions that fill() has
  /// put into a table.
  PluginUnit* (*current)(const UnitPlugin& plugin);
  const DispatchTable& (*next)(const void* place);
};

/// What a library exports.
struct UnitPlugin {
  std::uint32_t interface = unit_plugin_interface;
  std::uint64_t commands = dispatch_table_signature;
  const char* name = nullptr;
  const char* help = nullptr;  ///< one line
  std::span<const UnitOption> options{};
  /// A new unit, which is deleted with its chain.
  PluginUnit* (*make)(std::span<const UnitPluginOption> options) = nullptr;
  const UnitPluginHost* host = nullptr;  ///< set when it is loaded
};

inline const DispatchTable& PluginUnit::next() const {
  return host_->next(place_);
}

/// For functions in a unit's table, which have no `this`: the unit of type T that `plugin` makes.
template <class T>
T& current_unit(const UnitPlugin& plugin) {
  return static_cast<T&>(*plugin.host->current(plugin));
}

}  // namespace understudy::spu

/// Of a definition: UNDERSTUDY_EXPORT_UNIT{.name = …, .help = …, .make = …};
#define UNDERSTUDY_EXPORT_UNIT                                                               \
  extern "C" {                                                                               \
  extern __attribute__((visibility("default"))) understudy::spu::UnitPlugin understudy_unit; \
  }                                                                                          \
  understudy::spu::UnitPlugin understudy_unit
