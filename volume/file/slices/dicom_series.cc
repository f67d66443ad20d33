// SPDX-License-Identifier: Apache-2.0
#include "volume/file/slices/dicom_series.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "volume/file/file_error.h"
#include "volume/file/scalar_dispatch.h"
#include "volume/file/slices/dicom_image.h"
#include "volume/file/slices/dicom_places.h"
#include "volume/file/slices/slice_images.h"

namespace understudy::volume {

namespace {

using Series = std::map<std::string, DicomFiles>;

/// Groups files by Series Instance UID.
Series series_in(const DicomFiles& files) {
  Series found;
  for (const auto& header : files) found[header->series].push_back(header);
  return found;
}

/// Throws a FileError that lists the available series.
[[noreturn]] void fail_to_choose(const std::string& folder, const Series& series) {
  constexpr std::size_t most_listed = 20;
  std::string list;
  std::size_t listed = 0;
  for (const auto& [uid, in_it] : series)
    if (listed++ < most_listed)
      list +=
          fmt::format("\n  {}, {} files: {}", in_it.front()->description, in_it.size(), in_it.front()->path);
  fail_dicom(folder,
             fmt::format("images of {} series lie in this folder; give a file of the one that is meant:{}",
                         series.size(), list));
}

DicomFiles chosen_series(const std::string& folder, Series series, const std::string& chosen) {
  if (series.empty())
    fail_dicom(folder, "there is no image in it; give the folder of a series, or a file of one");
  if (chosen.empty()) {
    if (series.size() > 1) fail_to_choose(folder, series);
    return std::move(series.begin()->second);
  }
  for (auto& [uid, in_it] : series)
    if (std::ranges::any_of(in_it, [&](const auto& file) {
          return std::filesystem::path(file->path).filename() == std::filesystem::path(chosen).filename();
        }))
      return std::move(in_it);
  fail_dicom(chosen, "holds no image; give a file of a series of images");
}

class DicomSlices : public SliceImages {
 public:
  /// `as_values`: the images' rescaling differs, so their values are computed, as floats.
  DicomSlices(std::vector<DicomImage> images, bool as_values, const ReadableFiles& readable)
      : images_(std::move(images)), as_values_(as_values), readable_(readable) {}

  void read(int z, std::span<std::byte> scalars) override {
    const DicomImage& image = images_[std::size_t(z)];
    if (!open_ || open_->path() != image.file->path) open_.emplace(*image.file, readable_);
    bytes_read_ += image.file->file_bytes / image.file->frames.size();
    if (!as_values_) return open_->read(image.frame, scalars);
    std::vector<std::byte> stored(pixels() * bytes_per_scalar(image.file->type));
    open_->read(image.frame, stored);
    compute_values(image, stored, scalars);
  }

  /// For a file with several frames, in proportion to the decoded frames.
  std::uint64_t bytes_read() const override { return bytes_read_; }
  /// JPEG 2000: image, tile and copy, with four bytes per pixel each; and the largest compressed file.
  std::size_t memory_to_read() const override {
    constexpr std::size_t bytes_of_pixel = 16;
    std::uint64_t largest = 0;
    for (const DicomImage& image : images_) largest = std::max(largest, image.file->file_bytes);
    return bytes_of_pixel * pixels() + std::size_t(largest);
  }

 private:
  std::size_t pixels() const {
    const DicomHeader& file = *images_.front().file;
    return std::size_t(file.size[0]) * std::size_t(file.size[1]);
  }

  static void compute_values(const DicomImage& image, std::span<const std::byte> stored,
                             std::span<std::byte> values) {
    with_sample_type(image.file->type, [&]<typename Scalar>(Scalar) {
      for (std::size_t i = 0; i < stored.size() / sizeof(Scalar); ++i) {
        Scalar scalar;
        std::memcpy(&scalar, stored.data() + i * sizeof scalar, sizeof scalar);
        const float value = float(image.header().intercept + image.header().slope * double(scalar));
        std::memcpy(values.data() + i * sizeof value, &value, sizeof value);
      }
    });
  }

  std::vector<DicomImage> images_;
  bool as_values_;
  ReadableFiles readable_;
  std::optional<DicomFrames> open_;
  std::uint64_t bytes_read_ = 0;
};

}  // namespace

std::unique_ptr<VolumeFile> open_dicom_series(const std::string& folder, std::span<const std::string> files,
                                              const std::string& chosen, int time_step,
                                              const ReadableFiles& readable, DicomHeaders& headers) {
  const std::vector<DicomPlace> places =
      places_of(chosen_series(folder, series_in(headers.of(files, readable)), chosen));
  const std::string& path = chosen.empty() ? folder : chosen;
  FileDescription description;
  description.time_steps = checked_time_steps(std::int64_t(places.front().images.size()), path);
  check_time_step(time_step, description.time_steps, path);
  std::vector<DicomImage> images;
  images.reserve(places.size());
  for (const DicomPlace& place : places) images.push_back(place.images[std::size_t(time_step)]);
  const DicomHeader& first = *images.front().file;
  const DicomFrame& meaning = images.front().header();
  // If all time steps have the same rescaling, scalars stay as stored; otherwise values are computed.
  const bool alike = std::ranges::all_of(places, [&](const DicomPlace& place) {
    return std::ranges::all_of(place.images, [&](const DicomImage& image) {
      return image.header().slope == meaning.slope && image.header().intercept == meaning.intercept;
    });
  });
  description.type = alike ? first.type : ScalarType::f32;
  if (alike) {
    description.scale = meaning.slope;
    description.offset = meaning.intercept;
  }
  checked_bytes({first.size[0], first.size[1], std::int64_t(images.size())}, description.type, path);
  description.size = {first.size[0], first.size[1], int(images.size())};
  description.spacing = {first.spacing[0], first.spacing[1], distance_of(places)};
  return volume_of_slices(description, std::make_unique<DicomSlices>(std::move(images), !alike, readable),
                          path);
}

}  // namespace understudy::volume
