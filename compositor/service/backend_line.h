// SPDX-License-Identifier: Apache-2.0
// The beginning of lines in the nodes' log that state which backend casts the rays, and why.
#pragma once

namespace understudy::compositor {

constexpr const char* backend_line = "backend: ";

}  // namespace understudy::compositor
