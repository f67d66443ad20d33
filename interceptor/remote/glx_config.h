// SPDX-License-Identifier: Apache-2.0
// What GLX says of a configuration.
#pragma once

#include "interceptor/remote/configs.h"

namespace understudy::interceptor {

/// Success, or GLX_BAD_ATTRIBUTE for an attribute that GLX 1.4 does not know.
int glx_attribute_of(const RemoteConfig& config, int attribute, int* value);

/// Whether glXChooseFBConfig takes it for this list of attributes and values, which None ends.
bool meets_glx(const RemoteConfig& config, const int* attributes);

}  // namespace understudy::interceptor
