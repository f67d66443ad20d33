// Opens the body when the first context becomes current, and knows whether there is one.
#pragma once

#include "interceptor/body.h"

namespace understudy::interceptor {

/// The body if it is open and this process is the one that opened it, else null.
const BodyServices* body();

/// True when there will never be a body in this process: switched off by UNDERSTUDY_DISABLE, missing, refusing,
/// or left behind in the parent by fork. Every call then goes straight to the driver.
bool body_is_out();

/// Opens the body unless it is open or out. Says on stderr, once, why there is none.
const BodyServices* open_body();

}  // namespace understudy::interceptor
