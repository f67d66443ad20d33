// SPDX-License-Identifier: Apache-2.0
// The attributes of configurations in GLX and EGL, as tables: GLX 1.4, table 3.4; EGL 1.5, table 3.4.
#pragma once

#include <span>

#include "interceptor/remote/configs.h"

namespace understudy::interceptor {

/// How a configuration's value of an attribute is compared with the requested one.
enum class Match {
  at_least,    ///< sizes, in bits or pixels
  exact,       ///< flags and kinds
  all_bits,    ///< masks
  disregarded  ///< no criterion for a configuration, or only for queries
};

struct ConfigAttribute {
  int name;  ///< GLX_DEPTH_SIZE, EGL_DEPTH_SIZE
  Match match;
  int (*value)(const RemoteConfig&);
};

/// Returns false and leaves `value` alone if the table has no such attribute.
bool attribute_of(std::span<const ConfigAttribute> table, const RemoteConfig& config, int name, int* value);

/// Whether the configuration meets a list of alternating names and values that `end` terminates. A value of
/// `any` and a name that the table lacks are ignored. A null list is met by every configuration.
bool meets_all(std::span<const ConfigAttribute> table, const RemoteConfig& config, const int* list, int end,
               int any);

/// The values of attributes that have the same meaning in both interfaces.
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
