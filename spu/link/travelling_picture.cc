#include "spu/link/travelling_picture.h"

#include <algorithm>
#include <cstring>

#include "compositor/service/wire.h"
#include "compositor/tcp/jpeg.h"

namespace understudy::spu {

using compositor::MalformedMessage;

std::vector<std::byte> decode_travelling_picture(std::span<const std::byte> payload) {
  PixelCoding coding{};
  if (payload.size() < sizeof coding) throw MalformedMessage("picture: shorter than its head");
  std::memcpy(&coding, payload.data(), sizeof coding);
  payload = payload.subspan(sizeof coding);
  if (coding == PixelCoding::plain) return {payload.begin(), payload.end()};
  if (coding > PixelCoding::last) throw MalformedMessage("picture: written in no way that is known");
  const PictureChange change = decode_picture_head(payload);
  std::vector<std::byte> picture(picture_head_bytes +
                                 std::size_t(change.width) * std::size_t(change.height) * 4);
  std::copy_n(payload.begin(), picture_head_bytes, picture.begin());
  compositor::read_jpeg(payload.subspan(picture_head_bytes), change.width, change.height,
                        compositor::JpegPixels::bgrx, std::span(picture).subspan(picture_head_bytes));
  return picture;
}

}  // namespace understudy::spu
