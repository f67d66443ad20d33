// SPDX-License-Identifier: Apache-2.0
// Address-space limit (ulimit -v): a program that runs out of address space may crash in the driver.
#pragma once

namespace understudy::interceptor {

/// MiB of address space that the limit leaves to this process; ~0 without a limit.
unsigned long address_space_left();

/// MiB that the core may map from the first context on: 256, and 160 for each processor that this process may
/// use (the stack of its thread, and a heap arena that the C library aligns to 64 MiB).
unsigned long address_space_needed();

}  // namespace understudy::interceptor
