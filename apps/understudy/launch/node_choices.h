// SPDX-License-Identifier: Apache-2.0
// How the ranks of a node group go about their work, as understudy-node takes it on its command line.
#pragma once

#include <string>
#include <vector>

namespace understudy::launcher {

struct NodeChoices {
  std::string exchange = "auto";  ///< how partial images become one
  std::string pixels = "float";   ///< what travels between ranks
  std::string gather = "direct";  ///< how the parts of an image come to the viewer
  std::string overlap = "auto";   ///< whether images are composited while they are drawn
  std::string packed = "auto";    ///< whether pixels are packed for their way
  std::string backend = "cpu";    ///< who casts rays
  std::string gpu_memory = "auto";
  std::string sort = "auto";       ///< whether ranks divide volumes or images
  std::string partition = "auto";  ///< where nodes that divide a volume cut it
  std::string balance = "off";     ///< who gets how much of a volume
  std::vector<std::string> data;   ///< folders that clients may load volumes from
  bool any_file = false;           ///< clients are this user's own commands
  int image_ms = 0;                ///< that one image may take; 0: as long as its client waits

  std::vector<std::string> words() const {
    std::vector<std::string> all{"--exchange", exchange,      "--pixels",     pixels,      "--gather",
                                 gather,       "--packed",    packed,         "--overlap", overlap,
                                 "--backend",  backend,       "--gpu-memory", gpu_memory,  "--sort",
                                 sort,         "--partition", partition,      "--balance", balance};
    for (const std::string& folder : data) all.insert(all.end(), {"--data", folder});
    if (any_file) all.emplace_back("--any-file");
    all.insert(all.end(), {"--image-time", std::to_string(image_ms)});
    return all;
  }
};

}  // namespace understudy::launcher
