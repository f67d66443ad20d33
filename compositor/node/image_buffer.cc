// SPDX-License-Identifier: Apache-2.0
#include "compositor/node/image_buffer.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <stdexcept>
#include <utility>

namespace understudy::compositor {

namespace {

/// Where rank 0 has the file of an image buffer open.
struct Place {
  std::array<char, 40> machine{};  ///< the running kernel's boot id
  std::int64_t process = 0;
  std::int64_t descriptor = -1;
  std::uint64_t device = 0;
  std::uint64_t file = 0;
  std::uint64_t bytes = 0;
};

std::array<char, 40> this_machine() {
  std::array<char, 40> name{};
  const FileDescriptor file(::open("/proc/sys/kernel/random/boot_id", O_RDONLY | O_CLOEXEC));
  if (!file || ::read(file.get(), name.data(), name.size() - 1) <= 0) name = {};
  return name;
}

Place place_of(const ImageBuffer& memory) {
  Place place{.machine = this_machine(),
              .process = ::getpid(),
              .descriptor = memory.fd(),
              .device = 0,
              .file = 0,
              .bytes = memory.bytes()};
  struct stat status {};
  if (::fstat(memory.fd(), &status) != 0) return place;
  place.device = status.st_dev;
  place.file = status.st_ino;
  return place;
}

/// Maps the image buffer; empty if this rank does not reach it (another machine, container or user).
ImageBuffer reached(const Place& place) {
  if (place.machine != this_machine() || place.machine.front() == 0) return {};
  const std::string path = fmt::format("/proc/{}/fd/{}", place.process, place.descriptor);
  // In another container the same number is another process, whose files must not be opened.
  const FileDescriptor found(::open(path.c_str(), O_PATH | O_CLOEXEC));
  struct stat status {};
  if (!found || ::fstat(found.get(), &status) != 0 || status.st_dev != place.device ||
      status.st_ino != place.file)
    return {};
  FileDescriptor file(::open(fmt::format("/proc/self/fd/{}", found.get()).c_str(), O_RDWR | O_CLOEXEC));
  try {
    return ImageBuffer::map(std::move(file), place.bytes);
  } catch (const std::runtime_error&) {
    return {};
  }
}

}  // namespace

void ImageBuffers::share(std::uint64_t client, ImageBuffer given) {
  const bool holds_it = communicator_.rank() == 0;
  Place place = holds_it ? place_of(given) : Place();
  communicator_.broadcast(0, bytes_of(place));
  Kept kept;
  kept.mapped = holds_it ? std::move(given) : gather_ == Gather::direct ? reached(place) : ImageBuffer();
  kept.memory.floats = std::size_t(place.bytes / sizeof(float));
  kept.memory.here = kept.mapped.floats();
  std::uint8_t reaches = gather_ == Gather::direct && !kept.memory.here.empty() ? 1 : 0;
  std::vector<std::uint8_t> all(std::size_t(communicator_.size()));
  communicator_.gather_to_all(bytes_of(reaches), std::as_writable_bytes(std::span(all)));
  kept.memory.reached_by.assign(all.begin(), all.end());
  kept.mapped.close_descriptor();
  memories_.insert_or_assign(client, std::move(kept));
}

const ImageBuffers::Memory& ImageBuffers::of(std::uint64_t client) const {
  static const Memory none;
  const auto found = memories_.find(client);
  return found == memories_.end() ? none : found->second.memory;
}

}  // namespace understudy::compositor
