// SPDX-License-Identifier: Apache-2.0
#include "volume/file/volume_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>
#include <vector>

#include "volume/cell_lattice.h"
#include "volume/file/file_error.h"
#include "volume/file/series.h"

namespace understudy::volume {

namespace {

void swap_byte_order(std::span<std::byte> bytes, std::size_t scalar) {
  for (std::size_t at = 0; at + scalar <= bytes.size(); at += scalar)
    std::reverse(bytes.begin() + std::ptrdiff_t(at), bytes.begin() + std::ptrdiff_t(at + scalar));
}

/// Names the time step in messages about files with several.
std::string words_on_time_step(const FileDescription& description, const DenseScalars& scalars) {
  return description.time_steps > 1 ? fmt::format(" of time step {}", scalars.time_step) : "";
}

/// If the time steps of a texel are stored together, this much is read at once, but at least one texel's.
constexpr std::size_t piece_bytes = std::size_t(1) << 20;

class DenseVolume : public VolumeFile {
 public:
  /// `bytes`: size of the data from the scalars' offset on that contains the time step.
  DenseVolume(const FileDescription& description, DenseScalars scalars, std::uint64_t bytes)
      : VolumeFile(description),
        scalars_(std::move(scalars)),
        bytes_(bytes),
        scalar_(bytes_per_scalar(description.type)),
        place_(scalars_.steps_together ? scalar_ * std::size_t(description.time_steps) : scalar_) {}

  void read(const TexelBox& box, std::span<std::byte> scalars) override {
    const std::array<int, 3>& size = description().size;
    if (!contains({{0, 0, 0}, size}, box) || scalars.size() != texels_in(box) * scalar_)
      throw FileError(fmt::format("{}: a part was asked for that the volume does not have", path()));
    // Contiguous rows and slices are read at once.
    const bool rows = box.low[0] == 0 && box.high[0] == size[0];
    const bool slices = rows && box.low[1] == 0 && box.high[1] == size[1];
    const int row_step = rows ? box.high[1] - box.low[1] : 1,
              slice_step = slices ? box.high[2] - box.low[2] : 1;
    std::span<std::byte> left = scalars;
    for (int z = box.low[2]; z < box.high[2]; z += slice_step)
      for (int y = box.low[1]; y < box.high[1]; y += row_step) {
        const std::size_t count =
            std::size_t(box.high[0] - box.low[0]) * std::size_t(row_step) * std::size_t(slice_step) * scalar_;
        const std::uint64_t first = number_of({box.low[0], y, z});
        if (place_ == scalar_)
          fetch(first * scalar_, left.first(count));
        else
          fetch_of_places(first, left.first(count));
        left = left.subspan(count);
      }
    if (scalars_.nothing_follows && box.high == size) expect_end();
    if (scalars_.big_endian != (std::endian::native == std::endian::big) && scalar_ > 1)
      swap_byte_order(scalars, scalar_);
  }

  bool approach(const TexelBox& box, std::uint64_t most) override {
    return scalars_.bytes->approach(scalars_.offset + number_of(box.low) * place_, most);
  }
  std::size_t bytes_for_scalar() const override { return place_; }
  std::uint64_t bytes_read() const override { return scalars_.bytes->bytes_from_file(); }
  std::size_t memory_to_read(const TexelBox& /*box*/) const override {
    return place_ == scalar_ ? 0 : std::max(piece_bytes, place_);
  }

 private:
  const std::string& path() const { return scalars_.bytes->path(); }

  /// Index of a scalar, counted from the volume's first one, x fastest.
  std::uint64_t number_of(const std::array<int, 3>& place) const {
    const std::array<int, 3>& size = description().size;
    return (std::uint64_t(place[2]) * std::uint64_t(size[1]) + std::uint64_t(place[1])) *
               std::uint64_t(size[0]) +
           std::uint64_t(place[0]);
  }

  void fetch(std::uint64_t at, std::span<std::byte> to) {
    const std::size_t got = scalars_.bytes->read(scalars_.offset + at, to);
    if (got < to.size())
      throw FileError(fmt::format("{}: truncated: {} bytes of scalars{} were expected, only {} are there; {}",
                                  path(), bytes_, words_on_time_step(description(), scalars_),
                                  got == 0 ? "fewer than " + std::to_string(at + 1) : std::to_string(at + got),
                                  scalars_.advice));
  }

  /// Reads the time step's scalar of each place from `first` on.
  void fetch_of_places(std::uint64_t first, std::span<std::byte> to) {
    const std::size_t in_all = to.size() / scalar_;
    const std::size_t at_once = std::max<std::size_t>(1, std::min(piece_bytes / place_, in_all));
    std::vector<std::byte> piece(at_once * place_);
    for (std::size_t done = 0; done < in_all;) {
      const std::size_t places = std::min(at_once, in_all - done);
      fetch((first + done) * place_, std::span(piece).first(places * place_));
      for (std::size_t i = 0; i < places; ++i)
        std::copy_n(piece.data() + i * place_ + std::size_t(scalars_.time_step) * scalar_, scalar_,
                    to.data() + (done + i) * scalar_);
      done += places;
    }
  }

  void expect_end() {
    // For a plain file, the length was checked when it was opened.
    if (scalars_.bytes->size()) return;
    std::byte one_more{};
    if (scalars_.bytes->read(scalars_.offset + bytes_, {&one_more, 1}) > 0)
      throw FileError(fmt::format("{}: more than the expected {} bytes of scalars are there; {}", path(),
                                  bytes_, scalars_.advice));
  }

  DenseScalars scalars_;
  std::uint64_t bytes_;
  std::size_t scalar_;  ///< bytes
  std::size_t place_;   ///< bytes from one scalar of the time step to the next
};

}  // namespace

std::uint64_t checked_bytes(const std::array<std::int64_t, 3>& size, ScalarType type, const std::string& path) {
  std::uint64_t bytes = bytes_per_scalar(type);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (size[axis] < 1 || size[axis] > max_axis_texels)
      throw FileError(
          fmt::format("{}: {} scalars along axis {}, not 1 to {}; check the size, or cut the volume", path,
                      size[axis], axis, max_axis_texels));
    bytes *= std::uint64_t(size[axis]);  // 2^45 at most
  }
  return bytes;
}

int checked_time_steps(std::int64_t steps, const std::string& path) {
  if (steps < 1 || steps > std::int64_t(max_time_steps))
    throw FileError(fmt::format("{}: its header speaks of {} time steps, not 1 to {}; get the file again", path,
                                steps, max_time_steps));
  return int(steps);
}

void check_time_step(int step, int steps, const std::string& path) {
  if (step < 0 || step >= steps)
    throw FileError(
        fmt::format("{}: there is no time step {} in it; it holds {}, counted from 0", path, step, steps));
}

int checked_channel(std::optional<int> chosen, std::int64_t channels, const std::string& path) {
  if (channels > 1 && !chosen)
    throw FileError(
        fmt::format("{}: it has {} channels; choose one: --channel 0 to {}", path, channels, channels - 1));
  if (chosen.value_or(0) < 0 || chosen.value_or(0) >= channels)
    throw FileError(
        fmt::format("{}: there is no channel {} in it; it has {}, counted from 0", path, *chosen, channels));
  return chosen.value_or(0);
}

double believable_spacing(double spacing) {
  constexpr double smallest = 1e-30, largest = 1e30;
  spacing = std::abs(spacing);
  return spacing >= smallest && spacing <= largest ? spacing : 1.0;
}

std::unique_ptr<VolumeFile> dense_volume(const FileDescription& description, DenseScalars scalars) {
  const std::string& path = scalars.bytes->path();
  const std::array<int, 3>& size = description.size;
  const std::uint64_t one_step = checked_bytes({size[0], size[1], size[2]}, description.type, path);
  const std::uint64_t all_steps = one_step * std::uint64_t(description.time_steps);  // 2^62 at most
  check_time_step(scalars.time_step, description.time_steps, path);
  const std::optional<std::uint64_t> there = scalars.bytes->size();
  const std::uint64_t found = there.value_or(0) - std::min(scalars.offset, there.value_or(0));
  const auto fail = [&](const char* what, std::uint64_t expected, std::uint64_t present,
                        const std::string& of) {
    throw FileError(fmt::format("{}: {}{} bytes of scalars{} were expected, {} are there; {}", path, what,
                                expected, of, present, scalars.advice));
  };
  if (scalars.at_end) {
    if (found < all_steps) fail("truncated: ", all_steps, found, "");
    scalars.offset += found - all_steps;
  }
  const std::uint64_t before = scalars.steps_together ? 0 : std::uint64_t(scalars.time_step) * one_step;
  const std::uint64_t bytes = scalars.steps_together ? all_steps : one_step;
  scalars.offset += before;
  if (there) {
    const std::uint64_t present = *there - std::min(scalars.offset, *there);
    if (present < bytes) fail("truncated: ", bytes, present, words_on_time_step(description, scalars));
    if (present > bytes && scalars.nothing_follows) fail("", bytes, present, "");
  }
  return std::make_unique<DenseVolume>(description, std::move(scalars), bytes);
}

}  // namespace understudy::volume
