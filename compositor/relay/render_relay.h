// SPDX-License-Identifier: Apache-2.0
// Relays between applications and node groups. The image buffer has one half at each end: the application's
// own, and one that the server's relay makes for the nodes. An image is sent as numbers (packed as between
// nodes where that is faster, or narrower: ConnectionRequest::pixels), or as JPEG while requests differ. Images
// that must be exact (RenderRequest::exact) are sent as floats, packed or not.
//
// After the payload of a `rendered` message come the coding (ImageCoding) and the bytes of its image.
#pragma once

#include <memory>

#include "compositor/relay/packing_choice.h"
#include "compositor/service/image_buffer.h"
#include "compositor/transport/tcp/relay.h"
#include "volume/rect.h"

namespace understudy::compositor {

enum class ImageCoding : std::uint8_t {
  floats,  ///< unchanged
  packed,  ///< exchange/pixel_numbers.h
  jpeg,    ///< relay/jpeg.h: colours, and alpha as a second image
  last = jpeg
};

/// The relay beside the application.
class ApplicationRelay : public Relay {
 public:
  using Relay::Relay;

 protected:
  bool needs_whole(const MessageType& type) const override;
  void carry_out(Message message) override;
  void carry_back(Message message) override;

 private:
  /// The image buffer, which one direction sets and the other writes to.
  std::atomic<std::shared_ptr<ImageBuffer>> memory_;
};

/// The relay beside the nodes.
class NodesRelay : public Relay {
 public:
  NodesRelay(Connection& here, TcpConnection& tcp, const ConnectionRequest& connection_request)
      : Relay(here, tcp), connection_request_(connection_request) {}

 protected:
  bool needs_whole(const MessageType& type) const override;
  void carry_out(Message message) override;
  void carry_back(Message message) override;

 private:
  bool repeats(Bytes request);
  ImageCoding coding_of(const volume::Rect& rect);
  Bytes coded(std::span<const float> pixels, int width, ImageCoding coding, Layout layout);

  ConnectionRequest connection_request_;
  std::atomic<std::shared_ptr<ImageBuffer>> memory_;
  std::vector<std::size_t> last_requests_;  ///< hashes, the latest last
  // Of the image that is being rendered:
  std::atomic<bool> exact_ = false;    ///< it must be sent as floats
  std::atomic<bool> repeats_ = false;  ///< its view rests: it is not sent as JPEG
  std::vector<std::byte> coded_;
  PackingChoice packing_;
};

/// Reads a `rendered` message as it is sent: writes its image to the beginning of `memory`, and returns the
/// part of `payload` that the nodes wrote. Throws MalformedMessage.
Bytes take_image(Bytes payload, std::span<float> memory);

/// Appends `pixels`, RGBA and premultiplied, to `to`; packed in `layout`.
void encode_image(std::span<const float> pixels, int width, ImageCoding coding, Layout layout, int jpeg_quality,
                  std::vector<std::byte>& to);
/// The inverse. Throws MalformedMessage if `from` holds another number of pixels.
void decode_image(std::span<const std::byte> from, ImageCoding coding, Layout layout, int width,
                  std::span<float> to);

}  // namespace understudy::compositor
