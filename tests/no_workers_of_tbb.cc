// SPDX-License-Identifier: Apache-2.0
// For tests under ThreadSanitizer. TBB's library is not instrumented: of tasks that its workers take, it is
// seen what they read and write, but not what hands them over and waits for them. So whoever asks for tasks
// does them all, and threads of ours are left.
#include <tbb/global_control.h>

namespace {

// Never destroyed: at the end of a program TBB makes workers to see them end.
const auto& no_workers = *new tbb::global_control(tbb::global_control::max_allowed_parallelism, 1);

}  // namespace
