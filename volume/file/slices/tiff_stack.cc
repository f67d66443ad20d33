// SPDX-License-Identifier: Apache-2.0
#include "volume/file/slices/tiff_stack.h"

#include <fmt/format.h>

#include <optional>
#include <utility>

#include "volume/file/file_error.h"
#include "volume/file/slices/slice_images.h"
#include "volume/file/slices/tiff_image.h"

namespace understudy::volume {

namespace {

class PagesOfFile : public SliceImages {
 public:
  PagesOfFile(std::unique_ptr<TiffFile> file, int time_step, int channel)
      : file_(std::move(file)), time_step_(time_step), channel_(channel) {}

  void read(int z, std::span<std::byte> scalars) override { file_->read(z, time_step_, channel_, scalars); }
  std::uint64_t bytes_read() const override { return file_->bytes_read(); }
  /// A strip or tile, compressed and decoded.
  std::size_t memory_to_read() const override { return 2 * file_->header().piece_bytes; }

 private:
  std::unique_ptr<TiffFile> file_;
  int time_step_;
  int channel_;
};

class FilesOfStack : public SliceImages {
 public:
  FilesOfStack(std::vector<std::string> files, TiffHeader first, const ReadableFiles& readable)
      : files_(std::move(files)), first_(std::move(first)), readable_(readable) {}

  void read(int z, std::span<std::byte> scalars) override {
    TiffFile file(files_[std::size_t(z)], readable_);
    const TiffHeader& header = file.header();
    if (header.size != first_.size || header.type != first_.type || header.slices != 1 ||
        header.time_steps != 1 || header.channels != 1)
      throw FileError(
          fmt::format("{}: TIFF: {} slices of {} x {} pixels of {}, where {} has one of {} x {} of {}; put "
                      "slices of one size "
                      "and type into a folder of their own",
                      header.path, header.slices, header.size[0], header.size[1], name_of(header.type),
                      first_.path, first_.size[0], first_.size[1], name_of(first_.type)));
    file.read(0, 0, 0, scalars);
    bytes_read_ += file.bytes_read();
  }
  std::uint64_t bytes_read() const override { return bytes_read_; }
  std::size_t memory_to_read() const override { return 2 * first_.piece_bytes; }

 private:
  std::vector<std::string> files_;
  TiffHeader first_;
  ReadableFiles readable_;
  std::uint64_t bytes_read_ = 0;
};

}  // namespace

std::unique_ptr<VolumeFile> open_tiff(const std::string& path, const FileHints& hints,
                                      const ReadableFiles& readable) {
  auto file = std::make_unique<TiffFile>(path, readable);
  const TiffHeader& header = file->header();
  FileDescription description;
  description.size = {header.size[0], header.size[1], header.slices};
  description.spacing = header.spacing;
  description.type = header.type;
  description.time_steps = header.time_steps;
  description.channels = header.channels;
  check_time_step(hints.time_step, header.time_steps, path);
  const int channel = checked_channel(hints.channel, header.channels, path);
  return volume_of_slices(description, std::make_unique<PagesOfFile>(std::move(file), hints.time_step, channel),
                          path);
}

std::unique_ptr<VolumeFile> open_tiff_stack(const std::string& folder, std::vector<std::string> files,
                                            const ReadableFiles& readable) {
  const TiffHeader first = TiffFile(files.front(), readable).header();
  if (first.slices != 1 || first.time_steps != 1 || first.channels != 1)
    throw FileError(
        fmt::format("{}: TIFF: {} slices lie in this file, which is one of {} in its folder; name the "
                    "file instead of the folder",
                    first.path, first.slices, files.size()));
  FileDescription description;
  checked_bytes({first.size[0], first.size[1], std::int64_t(files.size())}, first.type, folder);
  description.size = {first.size[0], first.size[1], int(files.size())};
  description.spacing = {first.spacing[0], first.spacing[1], first.spacing[2]};
  description.type = first.type;
  return volume_of_slices(description, std::make_unique<FilesOfStack>(std::move(files), first, readable),
                          folder);
}

}  // namespace understudy::volume
