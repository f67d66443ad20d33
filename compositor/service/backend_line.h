// SPDX-License-Identifier: Apache-2.0
// How lines of the nodes' log begin that say who casts the rays, and why.
#pragma once

namespace understudy::compositor {

constexpr const char* backend_line = "backend: ";

}  // namespace understudy::compositor
