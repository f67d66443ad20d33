// SPDX-License-Identifier: Apache-2.0
// Opens the core when the first context becomes current, and records whether there is one.
#pragma once

#include "interceptor/core.h"

namespace understudy::interceptor {

/// The core if this process has opened it, otherwise null.
const CoreServices* core();

/// True if this process will never have a core: disabled by UNDERSTUDY_DISABLE, missing, refusing, or left
/// behind in the parent by fork. Every call then goes directly to the driver.
bool core_is_out();

/// Opens the core unless it is open or out. If that fails, logs the reason on stderr, once.
const CoreServices* open_core();

}  // namespace understudy::interceptor
