// SPDX-License-Identifier: Apache-2.0
// A limit of address space (ulimit -v), under which a program that is short of it may crash in the driver.
#pragma once

namespace understudy::interceptor {

/// MiB that the limit leaves to this process; ~0 where there is none.
unsigned long address_space_left();

/// MiB that the core may take from the first context on: 256 MiB, and 160 MiB for each processor that this
/// process may use, whose thread has a stack and finds room for a part of the heap at a multiple of 64 MiB.
unsigned long address_space_needed();

}  // namespace understudy::interceptor
