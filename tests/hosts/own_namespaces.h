// SPDX-License-Identifier: Apache-2.0
// A test program that makes networks must not touch the machine's: it goes on in namespaces of its own, for
// network, mounts, host name and processes. Whatever it leaves there, the kernel removes with its first
// process.
#pragma once

#include <string>

namespace hosts {

/// Returns in a child in new namespaces, with shared memory of its own and a proc file system that knows its
/// processes only; or, where this is not allowed, outside of them with the reason. The process that called
/// waits for the child, and ends as it did, or with 1 when the machine's networks are not what they were.
std::string enter_own_namespaces();

}  // namespace hosts
