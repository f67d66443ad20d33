// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/program/facts.h"

#include <array>
#include <string_view>

namespace understudy::spu::program {
namespace {

std::string_view word(SourceKind kind) {
  switch (kind) {
    case SourceKind::texel:
      return "texel of";
    case SourceKind::varying:
      return "varying";
    case SourceKind::attribute:
      return "attribute";
    case SourceKind::uniform:
      return "uniform";
    case SourceKind::uniform_block:
      return "uniform buffer member";
    case SourceKind::storage_buffer:
      return "storage buffer member";
    case SourceKind::image:
      return "image";
    case SourceKind::texture_size:
      return "size of texture";
    case SourceKind::atomic_counter:
      return "atomic counter";
    case SourceKind::undefined:
      return "undefined";
    case SourceKind::unknown:
      return "result of";
    default:
      return "";
  }
}

std::string component_text(const Source& source) {
  static constexpr std::string_view letters = "xyzw";
  if (source.components == 1) return {};
  if (source.components <= 4 && source.rows == source.components)
    return std::string(".") + letters[std::size_t(source.component)];
  return "[" + std::to_string(source.component / source.rows) + "][" +
         std::to_string(source.component % source.rows) + "]";
}

}  // namespace

std::string text(const Source& source) {
  switch (source.kind) {
    case SourceKind::iteration:
      return "the number of a loop's iteration";
    case SourceKind::derivative:
      return "neighbouring pixels";
    case SourceKind::noise:
      return "noise";
    default:
      break;
  }
  const bool quoted = source.kind == SourceKind::texel || source.kind == SourceKind::texture_size;
  std::string text(word(source.kind));
  if (!text.empty()) text += ' ';
  text += quoted ? "'" + source.name + "'" : source.name;
  return text + component_text(source);
}

std::string text(const SamplerType& type) {
  static constexpr std::array<std::string_view, 3> prefixes = {"", "i", "u"};
  static constexpr std::array<std::string_view, 7> shapes = {"1D", "2D", "3D", "Cube", "2DRect", "Buffer", ""};
  std::string text(prefixes[std::size_t(type.texels)]);
  text += "sampler";
  text += shapes[std::size_t(type.shape)];
  if (type.multisample) text += "MS";
  if (type.array) text += "Array";
  if (type.shadow) text += "Shadow";
  return text;
}

}  // namespace understudy::spu::program
