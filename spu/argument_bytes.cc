#include "spu/argument_bytes.h"

#include "dispatch/call_shape.h"
#include "spu/stream/extent.h"
#include "spu/stream/pixels.h"

namespace understudy::spu {
namespace {

std::optional<std::size_t> picture_bytes(const ImageArguments& image, const std::uint64_t* words) {
  if (image.width == no_argument || image.format == no_argument || image.type == no_argument) return {};
  PictureShape shape;
  shape.width = GLsizei(words[image.width]);
  if (image.height != no_argument) shape.height = GLsizei(words[image.height]);
  if (image.depth != no_argument) shape.depth = GLsizei(words[image.depth]);
  shape.format = GLenum(words[image.format]);
  shape.type = GLenum(words[image.type]);
  shape.dimensions = image.depth != no_argument ? 3 : 2;
  return picture_extent(shape, tight_pixels);
}

}  // namespace

std::optional<std::size_t> argument_bytes(CallId call, std::size_t parameter, const std::uint64_t* words) {
  if (words[parameter] == 0) return 0;
  const CallShape& shape = call_shape(call);
  switch (shape.parameters()[parameter].rule) {
    case ExtentRule::image:
    case ExtentRule::image_out:
      return picture_bytes(shape.image, words);
    default:
      return pointee_bytes(call, parameter, words);
  }
}

std::uint64_t call_bytes(CallId call, const std::uint64_t* words) {
  std::uint64_t bytes = 0;
  const std::span<const ParameterShape> parameters = call_shape(call).parameters();
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (parameters[i].pointer > 0) bytes += argument_bytes(call, i, words).value_or(0);
  }
  return bytes;
}

}  // namespace understudy::spu
