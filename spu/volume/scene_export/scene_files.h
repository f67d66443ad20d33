// SPDX-License-Identifier: Apache-2.0
// The files of an exported scene: texels (NRRD), colour map (ParaView), image (PFM), and the scene itself
// (JSON), which is written last.
#pragma once

#include <optional>
#include <string>

#include "compositor/scene/exported_scene.h"
#include "spu/volume/presentation/save_frames.h"
#include "spu/volume/texture/texels.h"

namespace understudy::spu {

constexpr int max_exported_scenes = 16;  ///< of one run

/// Names in the folder of the scenes.
struct SceneFiles {
  std::string scene;
  std::string header;
  std::string texels;
  std::string colour_map;
  std::string image;
  std::string alpha;
};

/// The first scene's files have no number in their names.
SceneFiles scene_files(int number);

/// The processes of a run share `folder`: a hidden file there marks each number that one of them has taken.
/// `run` is the launcher's folder for the run, whose name tells runs apart; without a launcher (empty), every
/// process is alone. Returns false if another process has the number. Removes the scene and the colour map that
/// an earlier run has left under the number: whatever fails later, they are not taken for those of this run.
/// Throws volume::FileError if they cannot be removed; then the number is not taken.
bool claim_scene(const std::string& folder, const std::string& run, int number);
/// Removes the mark, when the run is over; returns whether there was one.
bool withdraw_claim(const std::string& folder, const std::string& run, int number);

/// Writes the files of a number that was claimed, each completely or not at all. Throws what the writers and
/// `source` throw; then there is no scene file. Throws volume::FileError before a file exceeds the process's
/// limit for files, which would end the application by a signal.
void write_scene(const std::string& folder, const SceneFiles& files, compositor::ExportedScene scene,
                 TexelSource& source, const FloatMaps& image);

}  // namespace understudy::spu
