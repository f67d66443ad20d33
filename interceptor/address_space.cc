// SPDX-License-Identifier: Apache-2.0
#include "interceptor/address_space.h"

#include <fcntl.h>
#include <sched.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <unistd.h>

namespace understudy::interceptor {
namespace {

constexpr unsigned long mebibyte = 1UL << 20;
constexpr unsigned long unlimited = ~0UL;

/// Pages mapped by this process: the first number in /proc/self/statm.
unsigned long mapped_pages() {
  char text[32] = {};
  const int file = open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
  if (file < 0) return 0;
  const ssize_t length = read(file, text, sizeof text - 1);
  close(file);
  return length > 0 ? strtoul(text, nullptr, 10) : 0;
}

}  // namespace

unsigned long address_space_left() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return unlimited;
  const unsigned long mapped = mapped_pages() * static_cast<unsigned long>(sysconf(_SC_PAGESIZE));
  return mapped < limit.rlim_cur ? (limit.rlim_cur - mapped) / mebibyte : 0;
}

unsigned long address_space_needed() {
  cpu_set_t allowed;
  // More processors than the set can hold make the call fail; then all online processors count.
  const long processors =
      sched_getaffinity(0, sizeof allowed, &allowed) == 0 ? CPU_COUNT(&allowed) : sysconf(_SC_NPROCESSORS_ONLN);
  return 256 + 160 * static_cast<unsigned long>(processors > 0 ? processors : 1);
}

}  // namespace understudy::interceptor
