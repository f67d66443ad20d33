// SPDX-License-Identifier: Apache-2.0
// Relays between viewers and GL servers (compositor/transport/tcp/relay.h). What they add is JPEG: with a
// quality in the client's request, images travel as JPEG while frames follow each other, and what was lost of
// them comes as it is once the view rests: with a frame that changes nothing, or when there was none for
// rest_after.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <vector>

#include "compositor/transport/tcp/relay.h"
#include "spu/remote/travelling_image.h"

namespace understudy::spu {

constexpr std::chrono::milliseconds rest_after{150};

/// Beside the viewer.
class ViewerRelay : public compositor::Relay {
 public:
  using Relay::Relay;

 protected:
  void carry_back(compositor::Message message) override;
};

/// Beside the GL server.
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
  /// What a drawable shows, to the last bit.
  struct Shown {
    Extent2D extent;
    std::vector<std::byte> pixels;
    Part lossy;  ///< what the viewer has of it is a JPEG
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
