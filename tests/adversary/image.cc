// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/image.h"

#include <fstream>
#include <stdexcept>
#include <string>

namespace adversary {

Image read_image(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  Image image;
  for (std::string word; file >> word && word != "ENDHDR";) {
    if (word == "WIDTH") file >> image.width;
    if (word == "HEIGHT") file >> image.height;
  }
  file.get();
  image.rgba.resize(std::size_t{4} * image.width * image.height);
  file.read(reinterpret_cast<char*>(image.rgba.data()), static_cast<std::streamsize>(image.rgba.size()));
  if (!file || image.rgba.empty()) throw std::runtime_error("cannot read the image " + path.string());
  return image;
}

}  // namespace adversary
