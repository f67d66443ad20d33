// SPDX-License-Identifier: Apache-2.0
// Runs the bundled viewer on a scene of the study, and other programs that the study needs.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/understudy/study/scene.h"

namespace understudy::launcher::study {

std::filesystem::path viewer_program();

/// Returns the command that runs the viewer off screen on `scene`, which hand_out_to() has written to `folder`;
/// further options may be appended.
std::vector<std::string> viewer_command(const Scene& scene, const std::filesystem::path& folder);

/// Writes the scene's texels and description to the files that viewer_command() refers to.
/// Throws std::runtime_error.
void hand_out_to(const std::filesystem::path& folder, const Scene& scene);

/// The description of the scene, which apps/bench/vtk_mappers.py reads.
std::filesystem::path description_in(const std::filesystem::path& folder);

/// Runs a program to its end and returns both outputs, which are stored in `log`. OpenGL renders in software,
/// as everywhere in a study. Throws std::runtime_error with the end of the program's output.
std::string output_of(std::vector<std::string> arguments, const std::filesystem::path& log);

}  // namespace understudy::launcher::study
