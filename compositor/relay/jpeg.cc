// SPDX-License-Identifier: Apache-2.0
#include "compositor/relay/jpeg.h"

#include <turbojpeg.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>

#include "compositor/transport/wire.h"

namespace understudy::compositor {

namespace {

struct Destroy {
  void operator()(tjhandle handle) const { ::tjDestroy(handle); }
};
using Handle = std::unique_ptr<std::remove_pointer_t<tjhandle>, Destroy>;

constexpr int full_colour_quality = 90;

int format_of(JpegPixels format) {
  switch (format) {
    case JpegPixels::bgrx:
      return TJPF_BGRA;
    case JpegPixels::rgbx:
      return TJPF_RGBA;
    case JpegPixels::rgb:
      return TJPF_RGB;
    default:
      return TJPF_GRAY;
  }
}

int subsampling_of(JpegPixels format, int quality) {
  if (format == JpegPixels::gray) return TJSAMP_GRAY;
  return quality >= full_colour_quality ? TJSAMP_444 : TJSAMP_420;
}

const unsigned char* jpeg_bytes(std::span<const std::byte> bytes) {
  return reinterpret_cast<const unsigned char*>(bytes.data());
}

}  // namespace

void append_jpeg(std::span<const std::byte> pixels, int width, int height, JpegPixels format, int quality,
                 std::vector<std::byte>& to) {
  const Handle handle(::tjInitCompress());
  const int subsampling = subsampling_of(format, quality);
  const std::size_t before = to.size();
  unsigned long size = ::tjBufSize(width, height, subsampling);
  to.resize(before + size);
  auto* out = reinterpret_cast<unsigned char*>(to.data() + before);
  if (!handle || ::tjCompress2(handle.get(), jpeg_bytes(pixels), width, 0, height, format_of(format), &out,
                               &size, subsampling, quality, TJFLAG_NOREALLOC | TJFLAG_FASTDCT) != 0)
    throw std::runtime_error(std::string("no JPEG image can be made: ") + ::tjGetErrorStr2(handle.get()));
  to.resize(before + size);
}

void read_jpeg(std::span<const std::byte> jpeg, int width, int height, JpegPixels format,
               std::span<std::byte> to) {
  const Handle handle(::tjInitDecompress());
  int its_width = 0;
  int its_height = 0;
  int subsampling = 0;
  int colours = 0;
  const bool read =
      handle &&
      ::tjDecompressHeader3(handle.get(), jpeg_bytes(jpeg), jpeg.size(), &its_width, &its_height, &subsampling,
                            &colours) == 0 &&
      its_width == width && its_height == height &&
      ::tjDecompress2(handle.get(), jpeg_bytes(jpeg), jpeg.size(), reinterpret_cast<unsigned char*>(to.data()),
                      width, 0, height, format_of(format),
                      TJFLAG_FASTDCT | TJFLAG_STOPONWARNING | TJFLAG_LIMITSCANS) == 0;
  if (!read) throw MalformedMessage("image: no JPEG image of its size");
}

}  // namespace understudy::compositor
