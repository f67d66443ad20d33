// SPDX-License-Identifier: Apache-2.0
#include "compositor/exchange/wake_up.h"

#include <linux/futex.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <ctime>
#include <system_error>

namespace understudy::compositor {

/// On a cache line of its own, so that a rank that reads its slot does not slow down the others. Zero bytes are
/// a slot at rest.
struct alignas(64) WakeUp::Slot {
  std::atomic<std::uint32_t> notified;
  std::atomic<std::uint32_t> sleepers;
};
static_assert(std::atomic<std::uint32_t>::is_always_lock_free && sizeof(std::atomic<std::uint32_t>) == 4,
              "the kernel looks at the number itself");

FileDescriptor WakeUp::make_memory(int count) {
  FileDescriptor memory(::memfd_create("understudy wake-ups", MFD_CLOEXEC));
  if (!memory || ::ftruncate(memory.get(), off_t(count * sizeof(Slot))) != 0)
    throw std::system_error(errno, std::generic_category(), "no memory for the ranks' wake-ups");
  return memory;
}

WakeUp::WakeUp(const FileDescriptor& memory, int count, int mine) : mine_(mine) {
  void* const mapped =
      ::mmap(nullptr, count * sizeof(Slot), PROT_READ | PROT_WRITE, MAP_SHARED, memory.get(), 0);
  if (mapped == MAP_FAILED)
    throw std::system_error(errno, std::generic_category(), "the ranks' wake-ups cannot be mapped");
  slots_ = {static_cast<Slot*>(mapped), std::size_t(count)};
}

WakeUp::~WakeUp() {
  ::munmap(slots_.data(), slots_.size_bytes());
}

std::uint32_t WakeUp::notified() const {
  return slots_[std::size_t(mine_)].notified.load();
}

void WakeUp::sleep(std::uint32_t notified, std::chrono::microseconds most) {
  Slot& slot = slots_[std::size_t(mine_)];
  const timespec patience{most.count() / 1'000'000, most.count() % 1'000'000 * 1000};
  ++slot.sleepers;
  // Returns at once if the number has changed already.
  ::syscall(SYS_futex, &slot.notified, FUTEX_WAIT, notified, &patience, nullptr, 0);
  --slot.sleepers;
}

void WakeUp::notify(int slot) {
  Slot& other = slots_[std::size_t(slot)];
  ++other.notified;
  if (other.sleepers.load() > 0) ::syscall(SYS_futex, &other.notified, FUTEX_WAKE, 1, nullptr, nullptr, 0);
}

}  // namespace understudy::compositor
