// SPDX-License-Identifier: Apache-2.0
// What other programs show of a scene, and how long they take: the bundled viewer, bare, whose slices OpenGL
// blends in eight bits, and VTK's two volume mappers, where they are installed. All get the same texels, table,
// camera and number of samples a voxel. Their errors are of colour alone: not every image tells opacity.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "apps/understudy/study/measure.h"

namespace understudy::launcher::study {

class OtherPrograms {
 public:
  /// Works in `folder`, which it makes, and removes in the end. Looks for the programs.
  explicit OtherPrograms(std::filesystem::path folder);
  OtherPrograms(const OtherPrograms&) = delete;
  OtherPrograms& operator=(const OtherPrograms&) = delete;
  ~OtherPrograms();

  /// Why this one cannot be measured here, and what to install; nothing when it can.
  std::optional<std::string> absence(Scheme scheme) const;

  /// `rays` gets what was compared, with the reference's opacity. Throws std::runtime_error with the program's
  /// last words.
  Point measure(const Scene& scene, const Setting& setting, Scene::Rays& rays) const;

 private:
  struct Drawn;

  Drawn bare_viewer(const Scene& scene) const;
  Drawn vtk(const Scene& scene, const char* mapper) const;

  std::filesystem::path folder_;
  std::map<Scheme, std::string> absent_;
};

}  // namespace understudy::launcher::study
