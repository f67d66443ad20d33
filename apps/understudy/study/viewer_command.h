// SPDX-License-Identifier: Apache-2.0
// The bundled viewer on a scene of the study, and how programs beside the study are run.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/understudy/study/scene.h"

namespace understudy::launcher::study {

std::filesystem::path viewer_program();

/// The viewer off screen on `scene`, which has been handed out into `folder` (hand_out_to()); further options
/// may follow.
std::vector<std::string> viewer_command(const Scene& scene, const std::filesystem::path& folder);

/// Writes the scene's texels and description where viewer_command() looks for them. Throws std::runtime_error.
void hand_out_to(const std::filesystem::path& folder, const Scene& scene);

/// What of the scene apps/bench/vtk_mappers.py reads.
std::filesystem::path description_in(const std::filesystem::path& folder);

/// Runs to the end and returns what was written to both outputs, which passes through `log`. OpenGL is drawn by
/// the processor, here as everywhere in a study. Throws std::runtime_error with the program's last words.
std::string output_of(std::vector<std::string> arguments, const std::filesystem::path& log);

}  // namespace understudy::launcher::study
