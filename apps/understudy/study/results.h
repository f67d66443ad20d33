// SPDX-License-Identifier: Apache-2.0
// What a study has found so far, in files: study.json is read again by a study that goes on, study.csv has a
// row a setting.
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
  int rays = 0;  ///< of all cameras
  double reference_seconds = 0;
  Stiffness stiffness;
  std::vector<Point> points;
  /// Images of where a setting is wrong, by the setting's name; files beside study.json.
  std::map<std::string, std::string> error_maps;
  /// Why other programs have no point here, by the scheme's name.
  std::map<std::string, std::string> absent;
  std::vector<Saving> savings;  ///< empty: not measured here

  const Point* find(const Setting& setting) const;
};

struct Results {
  int edge = 0;    ///< of the images, in pixels
  int stride = 0;  ///< every so manieth pixel is compared
  std::vector<SceneResults> scenes;
};

/// Of an earlier study in this folder with images of the same size; nothing where there is none.
Results read_results(const std::filesystem::path& folder, int edge, int stride);

/// Throws std::runtime_error naming the file.
void write_results(const std::filesystem::path& folder, const Results& results);

/// "pre-integrated, step 0.5"
std::string text_of(const Setting& setting);

}  // namespace understudy::launcher::study
