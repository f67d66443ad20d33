// SPDX-License-Identifier: Apache-2.0
// What GLX and EGL ask of a configuration, as tables: GLX 1.4, table 3.4; EGL 1.5, table 3.4.
#pragma once

#include <span>

#include "interceptor/remote/configs.h"

namespace understudy::interceptor {

/// When a configuration has what an application wants of one attribute.
enum class Match {
  at_least,    ///< sizes, in bits or pixels
  exact,       ///< flags and kinds
  all_bits,    ///< masks
  disregarded  ///< says nothing of a configuration, or is for asking only
};

struct ConfigAttribute {
  int name;  ///< GLX_DEPTH_SIZE, EGL_DEPTH_SIZE
  Match match;
  int (*value)(const RemoteConfig&);
};

/// Returns false where the table has no such attribute, and leaves `value` alone.
bool attribute_of(std::span<const ConfigAttribute> table, const RemoteConfig& config, int name, int* value);

/// Names and values in turn, up to `end`. `any` as a value asks for nothing, as does a name that the table
/// lacks. A null list asks for nothing at all.
bool meets_all(std::span<const ConfigAttribute> table, const RemoteConfig& config, const int* list, int end,
               int any);

/// The attributes that both interfaces have under the same meaning.
namespace config_value {

constexpr int zero(const RemoteConfig&) {
  return 0;
}

constexpr int one(const RemoteConfig&) {
  return 1;
}

constexpr int buffer_bits(const RemoteConfig& config) {
  return 24 + config.alpha;
}

constexpr int colour_bits(const RemoteConfig&) {
  return 8;
}

constexpr int alpha_bits(const RemoteConfig& config) {
  return config.alpha;
}

constexpr int depth_bits(const RemoteConfig& config) {
  return config.depth;
}

constexpr int stencil_bits(const RemoteConfig& config) {
  return config.stencil;
}

constexpr int samples(const RemoteConfig& config) {
  return config.samples;
}

constexpr int sample_buffers(const RemoteConfig& config) {
  return config.samples > 0 ? 1 : 0;
}

constexpr int id(const RemoteConfig& config) {
  return config.id;
}

constexpr int visual(const RemoteConfig& config) {
  return static_cast<int>(config.visual);
}

int largest_side(const RemoteConfig&);
int largest_area(const RemoteConfig&);

}  // namespace config_value

}  // namespace understudy::interceptor
