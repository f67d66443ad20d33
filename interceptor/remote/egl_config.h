// SPDX-License-Identifier: Apache-2.0
// The EGL attributes of a configuration.
#pragma once

#include "interceptor/remote/configs.h"

namespace understudy::interceptor {

/// Returns false for an attribute that EGL 1.5 does not define.
bool egl_attribute_of(const RemoteConfig& config, int attribute, int* value);

/// Whether eglChooseConfig returns the configuration for this list of attributes, which EGL_NONE ends.
bool meets_egl(const RemoteConfig& config, const int* attributes);

}  // namespace understudy::interceptor
