// SPDX-License-Identifier: Apache-2.0
// Settings of the ranks of a node group, as understudy-node takes them on its command line.
#pragma once

#include <string>
#include <vector>

namespace understudy::launcher {

struct NodeChoices {
  std::string exchange = "auto";  ///< algorithm that composites partial images
  std::string pixels = "float";   ///< format of the pixels that ranks exchange
  std::string gather = "direct";  ///< how the parts of an image reach the viewer
  std::string overlap = "auto";   ///< whether images are composited while they are drawn
  std::string packed = "auto";    ///< whether pixels are packed before they are sent
  std::string backend = "cpu";    ///< what casts the rays
  std::string gpu_memory = "auto";
  std::string sort = "auto";       ///< whether ranks divide volumes or images
  std::string partition = "auto";  ///< how a volume is partitioned among nodes that divide it
  std::string balance = "off";     ///< load balancing between nodes
  std::vector<std::string> data;   ///< folders that clients may load volumes from
  bool any_file = false;           ///< clients are commands of this user and may load any file
  int image_ms = 0;                ///< time limit of one image; 0: as long as its client waits

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
