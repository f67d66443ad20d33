// SPDX-License-Identifier: Apache-2.0
// The GLX attributes of a configuration.
#pragma once

#include "interceptor/remote/configs.h"

namespace understudy::interceptor {

/// Returns Success, or GLX_BAD_ATTRIBUTE for an attribute that GLX 1.4 does not define.
int glx_attribute_of(const RemoteConfig& config, int attribute, int* value);

/// Whether glXChooseFBConfig returns the configuration for this list of attributes, which None ends.
bool meets_glx(const RemoteConfig& config, const int* attributes);

}  // namespace understudy::interceptor
