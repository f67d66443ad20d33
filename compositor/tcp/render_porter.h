// Porters between applications and node groups. The memory in which a picture is left has one half at each end:
// the application's own, and one that the server's porter makes for the nodes. A picture travels as numbers
// (packed as between nodes where that is faster, or narrower: LinkWishes::pixels), or as a JPEG picture while
// requests differ.
//
// Behind the payload of a `rendered` message stand how its picture is written (PictureCoding) and its bytes.
#pragma once

#include <memory>

#include "compositor/service/image_memory.h"
#include "compositor/tcp/porter.h"

namespace understudy::compositor {

enum class PictureCoding : std::uint8_t {
  floats,  ///< as they are
  packed,  ///< exchange/pixel_numbers.h
  jpeg,    ///< tcp/jpeg.h: colours, and alpha as another picture
  last = jpeg
};

/// Beside the application.
class ApplicationPorter : public Porter {
 public:
  using Porter::Porter;

 protected:
  void carry_out(Message message) override;
  void carry_home(Message message) override;

 private:
  /// A picture's memory, which the one direction learns of and the other writes to.
  std::atomic<std::shared_ptr<ImageMemory>> memory_;
};

/// Beside the nodes.
class NodesPorter : public Porter {
 public:
  NodesPorter(Connection& here, TcpLink& link, const LinkWishes& wishes)
      : Porter(here, link), wishes_(wishes) {}

 protected:
  void carry_out(Message message) override;
  void carry_home(Message message) override;

 private:
  PictureCoding coding_of(std::size_t pixels) const;

  LinkWishes wishes_;
  std::atomic<std::shared_ptr<ImageMemory>> memory_;
  std::vector<std::byte> last_request_;
  std::atomic<bool> repeats_ = false;  ///< the last request is the one before: its picture is sent without loss
  std::vector<std::byte> coded_;
  double packed_seconds_per_byte_ = 0.5e-9;
  double packed_ratio_ = 0.5;
};

/// A `rendered` message as it travels: leaves its picture at the beginning of `memory`, and returns the part of
/// `payload` that the nodes wrote. Throws MalformedMessage.
Bytes take_picture(Bytes payload, std::span<float> memory);

/// Writes `pixels`, RGBA and premultiplied, in the layout.
void encode_picture(std::span<const float> pixels, int width, PictureCoding coding, Layout layout,
                    int jpeg_quality, std::vector<std::byte>& to);
/// The other way. Throws MalformedMessage where `from` holds another number of pixels.
void decode_picture(std::span<const std::byte> from, PictureCoding coding, Layout layout, int width,
                    std::span<float> to);

}  // namespace understudy::compositor
