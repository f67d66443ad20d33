// SPDX-License-Identifier: Apache-2.0
// A test program that makes networks must not touch the machine's: it continues in namespaces of its own, for
// network, mounts, host name and processes. What it leaves there, the kernel removes when the first process of
// the namespaces ends.
#pragma once

#include <string>

namespace hosts {

/// Returns in a child process in new namespaces, with its own shared memory and a proc file system that shows
/// only its processes; or, if this is not allowed, outside of them with the reason. The calling process waits
/// for the child and exits with its status, or with 1 if the machine's networks have changed.
std::string enter_own_namespaces();

}  // namespace hosts
