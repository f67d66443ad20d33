// SPDX-License-Identifier: Apache-2.0
// Results of a study so far, in files: study.json is read when a study is continued;
// study.csv has one row per setting.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "apps/understudy/study/measure.h"
#include "apps/understudy/study/optimization_study.h"

namespace understudy::launcher::study {

struct SceneResults {
  std::string name;
  std::string shows;
  std::string volume;
  std::array<int, 3> size{};
  int rays = 0;  ///< over all cameras
  double reference_seconds = 0;
  Stiffness stiffness;
  std::vector<Point> points;
  /// Maps of the errors of settings, by the setting's name; files beside study.json.
  std::map<std::string, std::string> error_maps;
  /// Why other programs were not measured, by the scheme's name.
  std::map<std::string, std::string> absent;
  std::vector<Saving> savings;  ///< empty: not measured

  const Point* find(const Setting& setting) const;
};

struct Results {
  int edge = 0;    ///< edge of the images, in pixels
  int stride = 0;  ///< every stride-th pixel is compared
  std::vector<SceneResults> scenes;
};

/// Reads the results of an earlier study in this folder, with images of the same size; empty if there is none.
Results read_results(const std::filesystem::path& folder, int edge, int stride);

/// Throws std::runtime_error that names the file.
void write_results(const std::filesystem::path& folder, const Results& results);

/// For example "pre-integrated, step 0.5".
std::string text_of(const Setting& setting);

}  // namespace understudy::launcher::study
