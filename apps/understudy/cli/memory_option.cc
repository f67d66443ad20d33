// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/cli/memory_option.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "apps/understudy/launch/byte_size.h"
#include "compositor/service/client_limits.h"

namespace understudy::launcher {
namespace {

constexpr std::uint64_t no_limit = std::numeric_limits<std::uint64_t>::max();

/// Memory of a rank without a volume: program, MPI, threads.
constexpr std::uint64_t resident_bytes = std::uint64_t(40) << 20;
/// Address space that these take, which is much larger.
constexpr std::uint64_t address_bytes = std::uint64_t(1) << 30;
/// Bytes per pixel of an image, of its copies on their way to rank 0, and of the state of each ray.
constexpr std::uint64_t bytes_of_pixel = 64;
/// For pre-integration tables, and images that are compared to choose settings.
constexpr std::uint64_t bytes_of_settings = std::uint64_t(64) << 20;

/// Returns the address space left for a volume under the process's limit, which ranks inherit.
std::uint64_t addresses_for_volume() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return no_limit;
  const std::uint64_t all = limit.rlim_cur;
  return std::max(all / 4, all - std::min(all, address_bytes));
}

/// Returns a rank's share of the available memory. A quarter stays free for other programs,
/// and for the file's pages.
std::uint64_t share_of_machine(int ranks) {
  const std::uint64_t available = compositor::available_memory();
  const std::uint64_t usable = compositor::usable_memory();
  const std::uint64_t bytes = available == 0 ? usable : std::min(available, usable);
  return bytes / 4 * 3 / std::uint64_t(ranks);
}

}  // namespace

void add_memory_option(CLI::App& subcommand, std::string& memory, const std::string& what) {
  subcommand
      .add_option("--memory", memory,
                  what +
                      "; in bytes, or with K, M, G or T; auto (default): three quarters of the memory "
                      "available on this machine, shared by its ranks, within `ulimit -v`")
      ->transform(CLI::Validator(to_byte_size, "", "size"))
      ->type_name("BYTES|auto");
}

VolumeMemory memory_for_volume(const std::string& memory, int ranks, bool ranks_are_here, std::size_t pixels,
                               bool tries_settings) {
  if (memory == "auto") {
    if (!ranks_are_here) return {no_limit, false};
    const std::uint64_t share = share_of_machine(ranks), addresses = addresses_for_volume();
    return {std::min(share, addresses), addresses != no_limit};
  }
  const std::uint64_t without_volume =
      resident_bytes + bytes_of_pixel * pixels + (tries_settings ? bytes_of_settings : 0);
  const std::uint64_t bytes = byte_size(memory);
  if (bytes <= without_volume)
    throw std::invalid_argument(
        fmt::format("--memory {}M is less than a rank takes without a volume; give more than {}M", bytes >> 20U,
                    (without_volume >> 20U) + 1));
  return {bytes - without_volume, true};
}

}  // namespace understudy::launcher
