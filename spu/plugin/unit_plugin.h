// SPDX-License-Identifier: Apache-2.0
// A stream processing unit that is built outside this project: a shared library that `--chain` names. This
// header is all that it needs; docs/new-spu.md shows how to write one.
//
// The library exports one UnitPlugin under the name `understudy_unit` (UNDERSTUDY_EXPORT_UNIT). It calls no
// function of Understudy by name, only through pointers, so that it can be loaded both by the launcher, which
// inspects its options, and by the library in the viewer's process.
#pragma once

#include <cstdint>
#include <span>

#include "dispatch/signature.h"
#include "dispatch/table.h"
#include "spu/unit_options.h"

namespace understudy::spu {

/// Incremented with every change of this header or of UnitOption; libraries with another value are refused.
constexpr std::uint32_t unit_plugin_interface = 1;

struct UnitPlugin;
struct UnitPluginHost;

/// An option of a unit with its checked value from the chain, or the default.
struct UnitPluginOption {
  const char* name;
  double number;     ///< an integer or number; 1 or 0 for on or off; the first value of a range
  double last;       ///< the last value of a range; otherwise as `number`
  const char* text;  ///< a text, file or choice, otherwise empty; valid while make() runs
};

/// The unit of one context. Functions are called on the thread that has the context current.
class PluginUnit {
 public:
  virtual ~PluginUnit() = default;
  /// Overrides slots of `table`, which holds the next unit's functions. Called several times, and must do the
  /// same each time. Slots that are null (commands that the driver lacks) stay null whatever is stored in them.
  virtual void fill(DispatchTable& table) = 0;
  /// On return, everything that was held back is in the framebuffer.
  virtual void settle() {}
  /// A frame has ended.
  virtual void frame_ended() {}
  /// The context is being destroyed; no OpenGL call is allowed.
  virtual void abandon() {}

  /// The functions of the unit below, the only way to call OpenGL. Not usable in a constructor.
  const DispatchTable& next() const;

 private:
  friend class UnitOfPlugin;
  const UnitPluginHost* host_ = nullptr;
  const void* place_ = nullptr;  ///< the unit of the chain that forwards to this one
};

/// Provided to a library when it is loaded.
struct UnitPluginHost {
  /// The unit of `plugin` in the chain that is current on this thread. Never null in functions that fill() has
  /// stored in a table.
  PluginUnit* (*current)(const UnitPlugin& plugin);
  const DispatchTable& (*next)(const void* place);
};

/// The structure that a library exports.
struct UnitPlugin {
  std::uint32_t interface = unit_plugin_interface;
  std::uint64_t commands = dispatch_table_signature;
  const char* name = nullptr;
  const char* help = nullptr;  ///< one line
  std::span<const UnitOption> options{};
  /// Creates a unit, which is deleted with its chain.
  PluginUnit* (*make)(std::span<const UnitPluginOption> options) = nullptr;
  const UnitPluginHost* host = nullptr;  ///< set when the library is loaded
};

inline const DispatchTable& PluginUnit::next() const {
  return host_->next(place_);
}

/// For functions in a unit's table, which have no `this`: the unit of type T that `plugin` has created.
template <class T>
T& current_unit(const UnitPlugin& plugin) {
  return static_cast<T&>(*plugin.host->current(plugin));
}

}  // namespace understudy::spu

/// Starts a definition: UNDERSTUDY_EXPORT_UNIT{.name = …, .help = …, .make = …};
#define UNDERSTUDY_EXPORT_UNIT                                                               \
  extern "C" {                                                                               \
  extern __attribute__((visibility("default"))) understudy::spu::UnitPlugin understudy_unit; \
  }                                                                                          \
  understudy::spu::UnitPlugin understudy_unit
