// SPDX-License-Identifier: Apache-2.0
#include "volume/file/slices/dicom_places.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <tuple>
#include <utility>

#include "volume/file/file_error.h"
#include "volume/file/volume_file.h"

namespace understudy::volume {

namespace {

// Directions are written with six digits.
constexpr double least_cosine = 0.9999;
// Relative to the usual distance: tolerates rounding by scanners, but no missing slice.
constexpr double most_uneven = 0.1;
// In pixels. Slices closer than this, and closer than `rounded`, are at the same place; rows that are shifted
// by less than `most_shifted` count as aligned.
constexpr double same_place = 0.1;
constexpr double most_shifted = 0.5;
// In mm: positions are written with at least two decimals.
constexpr double rounded = 1e-2;

std::string name_in(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

bool is_same(double a, double b) {
  constexpr double relative = 1e-3;
  return std::abs(a - b) <= relative * std::max(a, b);
}

void check_alike(const DicomFiles& files) {
  const DicomHeader& first = *files.front();
  for (const auto& file : files) {
    if (!file->trouble.empty()) fail_dicom(file->path, file->trouble);
    if (file->size != first.size || file->type != first.type)
      fail_dicom(file->path,
                 fmt::format("it has {} x {} pixels of {}, where {} has {} x {} of {}; put images of one "
                             "size and type into a folder of their own",
                             file->size[0], file->size[1], name_of(file->type), name_in(first.path),
                             first.size[0], first.size[1], name_of(first.type)));
    if (!is_same(file->spacing[0], first.spacing[0]) || !is_same(file->spacing[1], first.spacing[1]))
      fail_dicom(file->path,
                 fmt::format("its pixels lie {:.4g} x {:.4g} mm apart, those of {} {:.4g} x {:.4g}; put "
                             "images of one reconstruction into a folder of their own",
                             file->spacing[0], file->spacing[1], name_in(first.path), first.spacing[0],
                             first.spacing[1]));
    const std::optional<DicomPlane>& plane = first.frames.front().plane;
    const bool same_way = std::ranges::all_of(file->frames, [&](const DicomFrame& frame) {
      return frame.plane.has_value() == plane.has_value() &&
             (!plane || (dot(frame.plane->rows, plane->rows) >= least_cosine &&
                         dot(frame.plane->columns, plane->columns) >= least_cosine));
    });
    if (!same_way)
      fail_dicom(file->path, fmt::format("it lies in another plane than {}; put slices of one direction into a "
                                         "folder of their own",
                                         name_in(first.path)));
  }
}

/// Sort key of several images at one place.
auto order_of(const DicomImage& image) {
  return std::tie(image.file->order, image.header().time, image.frame);
}

/// All images, each at a place of its own.
std::vector<DicomPlace> images_of(const DicomFiles& files) {
  std::vector<DicomPlace> images;
  for (const auto& file : files)
    for (int frame = 0; frame < int(file->frames.size()); ++frame) images.push_back({0, {{file, frame}}});
  return images;
}

/// Without planes: sorts by number, but frames that are declared to follow each other in time share one place.
std::vector<DicomPlace> places_by_number(DicomFiles files) {
  std::ranges::stable_sort(files, {}, [](const auto& file) { return file->order.back(); });
  std::vector<DicomPlace> places;
  for (DicomPlace& image : images_of(files)) {
    const DicomImage& one = image.images.front();
    if (one.frame > 0 && one.file->frames_are_times)
      places.back().images.push_back(one);
    else
      places.push_back(std::move(image));
  }
  return places;
}

void check_beside(const std::vector<DicomPlace>& places, double most) {
  const DicomPlane& first = *places.front().images.front().plane();
  for (const DicomPlace& place : places)
    for (const DicomImage& image : place.images) {
      const Vec3 way = subtract(image.plane()->position, first.position);
      const double shift = std::max(std::abs(dot(way, first.rows)), std::abs(dot(way, first.columns)));
      if (shift > most)
        fail_dicom(
            image.file->path,
            fmt::format("its rows begin {:.3g} mm beside those of {}: the gantry was tilted, or slices of "
                        "several stacks lie in this series; resample it first (dcm2niix does)",
                        shift, name_in(places.front().images.front().file->path)));
    }
}

void check_counts(const std::vector<DicomPlace>& places) {
  std::map<std::size_t, std::size_t> places_of_count;
  for (const DicomPlace& place : places) ++places_of_count[place.images.size()];
  const std::size_t steps =
      std::ranges::max_element(places_of_count, {}, [](const auto& entry) { return entry.second; })->first;
  for (const DicomPlace& place : places) {
    const DicomHeader& file = *place.images.front().file;
    if (place.images.size() != steps)
      fail_dicom(file.path,
                 fmt::format("{} images lie where it lies, {} elsewhere; files of this series are missing "
                             "or double",
                             place.images.size(), steps));
    for (std::size_t i = 1; i < place.images.size(); ++i) {
      const DicomImage &before = place.images[i - 1], &image = place.images[i];
      if (before.file != image.file &&
          (before.file->image == image.file->image || order_of(before) == order_of(image)))
        fail_dicom(
            image.file->path,
            fmt::format("it lies where {} lies, and nothing says which of them comes first; remove what is "
                        "double from the folder",
                        name_in(before.file->path)));
    }
  }
}

void check_distances(const std::vector<DicomPlace>& places) {
  std::vector<double> distances;
  for (std::size_t i = 1; i < places.size(); ++i) distances.push_back(places[i].along - places[i - 1].along);
  if (distances.empty()) return;
  std::vector<double> sorted = distances;
  const auto middle = sorted.begin() + std::ptrdiff_t(sorted.size() / 2);
  std::ranges::nth_element(sorted, middle);
  for (std::size_t i = 0; i < distances.size(); ++i)
    if (!(std::abs(distances[i] - *middle) <=
          std::max(most_uneven * *middle, std::min(rounded, 0.5 * *middle))))
      fail_dicom(
          places[i + 1].images.front().file->path,
          fmt::format("it lies {:.3g} mm behind {}, where other slices lie {:.3g} mm apart: slices are missing "
                      "or do not belong together; complete the series",
                      distances[i], name_in(places[i].images.front().file->path), *middle));
}

}  // namespace

std::vector<DicomPlace> places_of(DicomFiles files) {
  check_alike(files);
  const DicomHeader& first = *files.front();
  if (!first.frames.front().plane) {
    std::vector<DicomPlace> places = places_by_number(std::move(files));
    check_counts(places);
    return places;
  }
  const Vec3 normal = first.frames.front().plane->normal;
  const double pixel = std::min(first.spacing[0], first.spacing[1]);
  std::vector<DicomPlace> images = images_of(files);
  for (DicomPlace& image : images) image.along = dot(image.images.front().plane()->position, normal);
  std::ranges::stable_sort(images, {}, &DicomPlace::along);
  std::vector<DicomPlace> places;
  for (DicomPlace& image : images) {
    if (places.empty() || image.along - places.back().along > std::min(rounded, same_place * pixel))
      places.push_back({image.along, {}});
    places.back().images.push_back(std::move(image.images.front()));
  }
  for (DicomPlace& place : places)
    std::ranges::stable_sort(place.images,
                             [](const auto& a, const auto& b) { return order_of(a) < order_of(b); });
  check_beside(places, std::max(rounded, most_shifted * pixel));
  check_counts(places);
  check_distances(places);
  return places;
}

double distance_of(const std::vector<DicomPlace>& places) {
  const DicomImage& first = places.front().images.front();
  if (places.size() < 2 || !first.plane()) return first.file->spacing[2];
  return believable_spacing((places.back().along - places.front().along) / double(places.size() - 1));
}

}  // namespace understudy::volume
