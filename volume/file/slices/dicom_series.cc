// SPDX-License-Identifier: Apache-2.0
#include "volume/file/slices/dicom_series.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
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
#include "volume/file/slices/slice_images.h"
#include "volume/matrix.h"

namespace understudy::volume {

namespace {

// Normals are written with six digits.
constexpr double least_cosine = 0.9999;
// Of the usual distance: what scanners round, and what a missing slice is far beyond.
constexpr double most_uneven = 0.1;
// In mm; positions are written with two digits behind the point at least.
constexpr double same_place = 1e-2;

/// One frame of a file.
struct Image {
  std::shared_ptr<const DicomHeader> file;
  int frame = 0;
  std::size_t order = 0;  ///< among all of the series, by the numbers of files and frames

  const DicomFrame& header() const { return file->frames[std::size_t(frame)]; }
  const std::optional<DicomPlane>& plane() const { return header().plane; }
};

/// Images that lie at one place along the normal, in the order of their numbers.
struct Place {
  double along = 0;  ///< in mm
  std::vector<Image> images;
};

std::string name_in(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

using Files = std::vector<std::shared_ptr<const DicomHeader>>;
using Series = std::map<std::string, Files>;

/// By Series Instance UID.
Series series_in(std::span<const std::string> files, const ReadableFiles& readable) {
  Series found;
  for (const std::string& file : files) {
    if (std::optional<DicomHeader> header = dicom_header(file, readable))
      found[header->series].push_back(std::make_shared<const DicomHeader>(std::move(*header)));
  }
  return found;
}

/// Lists what there is to choose from.
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

Files chosen_series(const std::string& folder, Series series, const std::string& chosen) {
  if (series.empty())
    fail_dicom(folder, "there is no image in it; give the folder of a series, or a file of one");
  if (chosen.empty()) {
    if (series.size() > 1) fail_to_choose(folder, series);
    return std::move(series.begin()->second);
  }
  for (auto& [uid, in_it] : series)
    if (std::ranges::any_of(in_it, [&](const auto& file) { return name_in(file->path) == name_in(chosen); }))
      return std::move(in_it);
  fail_dicom(chosen, "holds no image; give a file of a series of images");
}

void check_alike(const Files& files) {
  const DicomHeader& first = *files.front();
  for (const auto& file : files) {
    if (file->size != first.size || file->type != first.type)
      fail_dicom(file->path,
                 fmt::format("it has {} x {} pixels of {}, where {} has {} x {} of {}; put images of one "
                             "size and type into a folder of their own",
                             file->size[0], file->size[1], name_of(file->type), name_in(first.path),
                             first.size[0], first.size[1], name_of(first.type)));
    const std::optional<DicomPlane>& plane = first.frames.front().plane;
    const bool same_way = std::ranges::all_of(file->frames, [&](const DicomFrame& frame) {
      return frame.plane.has_value() == plane.has_value() &&
             (!plane || dot(frame.plane->normal, plane->normal) >= least_cosine);
    });
    if (!same_way)
      fail_dicom(file->path,
                 fmt::format("it lies in another plane than {}; put slices of one direction into a folder "
                             "of their own",
                             name_in(first.path)));
  }
}

/// From first to last. Without planes each image has a place of its own, by the number of its file.
std::vector<Place> places_of(Files files) {
  std::ranges::stable_sort(files, {}, [](const auto& file) { return file->instance; });
  std::vector<Place> images;
  for (const auto& file : files)
    for (int frame = 0; frame < int(file->frames.size()); ++frame)
      images.push_back({0, {{file, frame, images.size()}}});
  const std::optional<DicomPlane> first = images.front().images.front().plane();
  if (!first) return images;
  for (Place& image : images) image.along = dot(image.images.front().plane()->position, first->normal);
  std::ranges::sort(images, {}, &Place::along);
  std::vector<Place> places;
  for (Place& image : images) {
    if (places.empty() || image.along - places.back().along > same_place) places.push_back({image.along, {}});
    places.back().images.push_back(std::move(image.images.front()));
  }
  for (Place& place : places) std::ranges::sort(place.images, {}, &Image::order);
  return places;
}

/// How many images each place has.
std::size_t time_steps_of(const std::vector<Place>& places, const std::string& folder) {
  const std::size_t steps = places.front().images.size();
  for (const Place& place : places)
    if (place.images.size() != steps)
      fail_dicom(place.images.front().file->path,
                 fmt::format("{} images lie where it lies, {} elsewhere; files of {} are missing or double",
                             place.images.size(), steps, folder));
  return steps;
}

/// In mm. Throws where slices do not lie evenly.
double distance_of(const std::vector<Place>& places) {
  const Image& first = places.front().images.front();
  if (places.size() < 2 || !first.plane()) return first.file->spacing[2];
  std::vector<double> distances;
  for (std::size_t i = 1; i < places.size(); ++i) distances.push_back(places[i].along - places[i - 1].along);
  std::vector<double> sorted = distances;
  const auto middle = sorted.begin() + std::ptrdiff_t(sorted.size() / 2);
  std::ranges::nth_element(sorted, middle);
  for (std::size_t i = 0; i < distances.size(); ++i)
    if (std::abs(distances[i] - *middle) > most_uneven * *middle)
      fail_dicom(
          places[i + 1].images.front().file->path,
          fmt::format("it lies {:.3g} mm behind {}, where other slices lie {:.3g} mm apart: slices are missing "
                      "or do not belong together; complete the series",
                      distances[i], name_in(places[i].images.front().file->path), *middle));
  return (places.back().along - places.front().along) / double(places.size() - 1);
}

class DicomSlices : public SliceImages {
 public:
  /// `as_values`: they mean their values differently, which are therefore computed, as floats.
  DicomSlices(std::vector<Image> images, bool as_values, const ReadableFiles& readable)
      : images_(std::move(images)), as_values_(as_values), readable_(readable) {}

  void read(int z, std::span<std::byte> scalars) override {
    const Image& image = images_[std::size_t(z)];
    if (!open_ || open_->path() != image.file->path) open_.emplace(*image.file, readable_);
    bytes_read_ += image.file->file_bytes / image.file->frames.size();
    if (!as_values_) return open_->read(image.frame, scalars);
    std::vector<std::byte> stored(stored_bytes());
    open_->read(image.frame, stored);
    compute_values(image, stored, scalars);
  }

  /// Of a file with several frames, the share of those that were decoded.
  std::uint64_t bytes_read() const override { return bytes_read_; }
  /// What the decoder makes of an image; and all compressed frames of a file, or one.
  std::size_t memory_to_read() const override {
    return 2 * stored_bytes() + std::size_t(images_.front().file->file_bytes);
  }

 private:
  std::size_t stored_bytes() const {
    const DicomHeader& file = *images_.front().file;
    return std::size_t(file.size[0]) * std::size_t(file.size[1]) * bytes_per_scalar(file.type);
  }

  static void compute_values(const Image& image, std::span<const std::byte> stored,
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

  std::vector<Image> images_;
  bool as_values_;
  ReadableFiles readable_;
  std::optional<DicomFrames> open_;
  std::uint64_t bytes_read_ = 0;
};

}  // namespace

std::unique_ptr<VolumeFile> open_dicom_series(const std::string& folder, std::span<const std::string> files,
                                              const std::string& chosen, int time_step,
                                              const ReadableFiles& readable) {
  Files series = chosen_series(folder, series_in(files, readable), chosen);
  const std::string& path = chosen.empty() ? folder : chosen;
  check_alike(series);
  const std::vector<Place> places = places_of(std::move(series));
  FileDescription description;
  description.time_steps = checked_time_steps(std::int64_t(time_steps_of(places, folder)), path);
  check_time_step(time_step, description.time_steps, path);
  std::vector<Image> images;
  images.reserve(places.size());
  for (const Place& place : places) images.push_back(place.images[std::size_t(time_step)]);
  const DicomHeader& first = *images.front().file;
  const DicomFrame& meaning = images.front().header();
  const bool alike = std::ranges::all_of(images, [&](const Image& image) {
    return image.header().slope == meaning.slope && image.header().intercept == meaning.intercept;
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
