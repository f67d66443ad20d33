// SPDX-License-Identifier: Apache-2.0
// The bundled viewer with a volume that is drawn quickly.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/clients/command_test.h"

namespace attacks {

/// Command line of the viewer; creates the volume, 24^3 bytes, at `volume`.
inline clients::Words small_viewer(const std::filesystem::path& volume, int frames = 3) {
  constexpr int edge = 24;
  std::string texels;
  for (int i = 0; i < edge * edge * edge; ++i) texels.push_back(char(i % 251));
  std::ofstream(volume, std::ios::binary) << texels;
  const std::string size = std::to_string(edge);
  return {(clients::programs / "understudy-viewer").string(),
          volume.string(),
          "--size",
          size,
          size,
          size,
          "--type",
          "u8",
          "--offscreen",
          "--frames",
          std::to_string(frames),
          "--orbit",
          "5",
          "--window-size",
          "96",
          "96"};
}

}  // namespace attacks
