#include "compositor/exchange/bells.h"

#include <linux/futex.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <ctime>
#include <system_error>

namespace understudy::compositor {

/// A cache line of its own, so that a rank that looks at its bell disturbs no other. Zero is a bell at rest.
struct alignas(64) Bells::Bell {
  std::atomic<std::uint32_t> rung;
  std::atomic<std::uint32_t> sleepers;
};
static_assert(std::atomic<std::uint32_t>::is_always_lock_free && sizeof(std::atomic<std::uint32_t>) == 4,
              "the kernel looks at the number itself");

FileDescriptor Bells::make_memory(int count) {
  FileDescriptor memory(::memfd_create("understudy bells", MFD_CLOEXEC));
  if (!memory || ::ftruncate(memory.get(), off_t(count * sizeof(Bell))) != 0)
    throw std::system_error(errno, std::generic_category(), "no memory for the ranks' bells");
  return memory;
}

Bells::Bells(const FileDescriptor& memory, int count, int mine) : mine_(mine) {
  void* const mapped =
      ::mmap(nullptr, count * sizeof(Bell), PROT_READ | PROT_WRITE, MAP_SHARED, memory.get(), 0);
  if (mapped == MAP_FAILED)
    throw std::system_error(errno, std::generic_category(), "the ranks' bells cannot be mapped");
  bells_ = {static_cast<Bell*>(mapped), std::size_t(count)};
}

Bells::~Bells() {
  ::munmap(bells_.data(), bells_.size_bytes());
}

std::uint32_t Bells::rung() const {
  return bells_[std::size_t(mine_)].rung.load();
}

void Bells::sleep(std::uint32_t rung, std::chrono::microseconds most) {
  Bell& bell = bells_[std::size_t(mine_)];
  const timespec patience{most.count() / 1'000'000, most.count() % 1'000'000 * 1000};
  ++bell.sleepers;
  // Returns at once when the number is another one already.
  ::syscall(SYS_futex, &bell.rung, FUTEX_WAIT, rung, &patience, nullptr, 0);
  --bell.sleepers;
}

void Bells::ring(int bell) {
  Bell& other = bells_[std::size_t(bell)];
  ++other.rung;
  if (other.sleepers.load() > 0) ::syscall(SYS_futex, &other.rung, FUTEX_WAKE, 1, nullptr, nullptr, 0);
}

}  // namespace understudy::compositor
