// SPDX-License-Identifier: Apache-2.0
// What EGL says of a configuration.
#pragma once

#include "interceptor/remote/configs.h"

namespace understudy::interceptor {

/// Returns false for an attribute that EGL 1.5 does not know.
bool egl_attribute_of(const RemoteConfig& config, int attribute, int* value);

/// Whether eglChooseConfig takes it for this list of attributes and values, which EGL_NONE ends.
bool meets_egl(const RemoteConfig& config, const int* attributes);

}  // namespace understudy::interceptor
