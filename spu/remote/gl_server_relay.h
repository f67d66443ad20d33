// SPDX-License-Identifier: Apache-2.0
// Relays between viewers and GL servers (compositor/transport/tcp/relay.h), which add JPEG compression: if the
// client's request contains a quality, images are sent as JPEG while frames follow each other. Once the view
// rests, the lossy pixels are sent again exactly: with a frame that changes nothing, or when there was no frame
// for rest_after.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <vector>

#include "compositor/transport/tcp/relay.h"
#include "spu/remote/travelling_image.h"

namespace understudy::spu {

constexpr std::chrono::milliseconds rest_after{150};

/// Runs beside the viewer.
class ViewerRelay : public compositor::Relay {
 public:
  using Relay::Relay;

 protected:
  void carry_back(compositor::Message message) override;
};

/// Runs beside the GL server.
class GlServerRelay : public compositor::Relay {
 public:
  GlServerRelay(compositor::Connection& here, compositor::TcpConnection& tcp,
                const compositor::ConnectionRequest& connection_request)
      : Relay(here, tcp), quality_(connection_request.jpeg_quality) {}

 protected:
  bool needs_whole(const compositor::MessageType&) const override { return true; }
  void carry_out(compositor::Message message) override;
  compositor::Deadline rest_due() const override;
  void rest() override;

 private:
  struct Part {
    int left = 0;
    int top = 0;
    int right = 0;
    int bottom = 0;
    bool empty() const { return left >= right || top >= bottom; }
  };
  /// The exact pixels that a drawable shows.
  struct Shown {
    Extent2D extent;
    std::vector<std::byte> pixels;
    Part lossy;  ///< the part that the viewer has received as JPEG
  };

  void keep(Shown& shown, const ImageChange& change) const;
  void send_image(const compositor::Message& message, const ImageChange& change);
  void send_jpeg(const compositor::Message& message, const ImageChange& change);
  void send_refined(const compositor::Message& message, std::uint64_t drawable, Shown& shown);

  int quality_;
  std::map<std::uint64_t, Shown> shown_;
  compositor::Deadline last_image_{};
  std::vector<std::byte> coded_;
};

}  // namespace understudy::spu
