// SPDX-License-Identifier: Apache-2.0
#include "spu/remote/travelling_image.h"

#include <algorithm>
#include <cstring>

#include "compositor/relay/jpeg.h"
#include "compositor/transport/wire.h"

namespace understudy::spu {

using compositor::MalformedMessage;

std::vector<std::byte> decode_travelling_image(std::span<const std::byte> payload) {
  PixelCoding coding{};
  if (payload.size() < sizeof coding) throw MalformedMessage("image: shorter than its head");
  std::memcpy(&coding, payload.data(), sizeof coding);
  payload = payload.subspan(sizeof coding);
  if (coding == PixelCoding::plain) return {payload.begin(), payload.end()};
  if (coding > PixelCoding::last) throw MalformedMessage("image: written in no way that is known");
  const ImageChange change = decode_image_head(payload);
  std::vector<std::byte> image(image_head_bytes + std::size_t(change.width) * std::size_t(change.height) * 4);
  std::copy_n(payload.begin(), image_head_bytes, image.begin());
  compositor::read_jpeg(payload.subspan(image_head_bytes), change.width, change.height,
                        compositor::JpegPixels::bgrx, std::span(image).subspan(image_head_bytes));
  return image;
}

}  // namespace understudy::spu
