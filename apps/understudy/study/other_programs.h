// SPDX-License-Identifier: Apache-2.0
// Measures images and times of other programs: the bundled viewer without Understudy, whose slices OpenGL
// blends in eight bits, and VTK's two volume mappers, if installed. All get the same texels, transfer function,
// camera and number of samples per voxel. Errors are of colour only, because some images lack opacity.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "apps/understudy/study/measure.h"

namespace understudy::launcher::study {

class OtherPrograms {
 public:
  /// Works in `folder`, which it creates and finally removes. Checks which programs are available.
  explicit OtherPrograms(std::filesystem::path folder);
  OtherPrograms(const OtherPrograms&) = delete;
  OtherPrograms& operator=(const OtherPrograms&) = delete;
  ~OtherPrograms();

  /// Returns why this program cannot be measured here, and what to install; nothing if it can.
  std::optional<std::string> absence(Scheme scheme) const;

  /// Returns the compared rays in `rays`, with the reference's opacity. Throws std::runtime_error with the
  /// end of the program's output.
  Point measure(const Scene& scene, const Setting& setting, Scene::Rays& rays) const;

 private:
  struct Drawn;

  Drawn bare_viewer(const Scene& scene) const;
  Drawn vtk(const Scene& scene, const char* mapper) const;

  std::filesystem::path folder_;
  std::map<Scheme, std::string> absent_;
};

}  // namespace understudy::launcher::study
