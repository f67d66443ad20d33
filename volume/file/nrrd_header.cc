// SPDX-License-Identifier: Apache-2.0
#include "volume/file/nrrd_header.h"

#include <fmt/format.h>

namespace understudy::volume {
namespace {

const char* name_of(TexelType type) {
  switch (type) {
    case TexelType::u16:
      return "unsigned short";
    case TexelType::f32:
      return "float";
    default:
      return "unsigned char";
  }
}

}  // namespace

std::string nrrd_header(const std::array<int, 3>& size, TexelType type, const std::string& data) {
  const bool colours = type == TexelType::rgba8;
  return fmt::format(
      "NRRD0004\n"
      "type: {}\n"
      "dimension: {}\n"
      "sizes: {}{} {} {}\n"
      "kinds: {}domain domain domain\n"
      "endian: little\n"
      "encoding: raw\n"
      "data file: {}\n",
      name_of(type), colours ? 4 : 3, colours ? "4 " : "", size[0], size[1], size[2],
      colours ? "RGBA-color " : "", data);
}

}  // namespace understudy::volume
