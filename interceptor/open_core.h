// SPDX-License-Identifier: Apache-2.0
// Opens the core when the first context becomes current, and knows whether there is one.
#pragma once

#include "interceptor/core.h"

namespace understudy::interceptor {

/// The core if it is open and this process is the one that opened it, else null.
const CoreServices* core();

/// True when there will never be a core in this process: switched off by UNDERSTUDY_DISABLE, missing, refusing,
/// or left behind in the parent by fork. Every call then goes straight to the driver.
bool core_is_out();

/// Opens the core unless it is open or out. Says on stderr, once, why there is none.
const CoreServices* open_core();

}  // namespace understudy::interceptor
