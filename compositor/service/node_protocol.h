// SPDX-License-Identifier: Apache-2.0
// The messages between an application and a node group, and their protocol.
//
// An application sends a request and waits for its one reply before it sends the next request. Images are not
// sent in messages: they lie in memory that the application made and whose descriptor it passed along
// (image_buffer). Render requests: request_message.h. Volumes that nodes read from files: load_protocol.h.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "compositor/transport/message.h"
#include "volume/frame_counts.h"
#include "volume/rect.h"
#include "volume/texel_box.h"
#include "volume/volume_id.h"

namespace understudy::volume {
struct VolumeDescription;
}

namespace understudy::compositor {

enum class NodeMessage : std::uint16_t {
  // from an application to rank 0
  image_buffer = 1,  ///< attached: sealed memory for the images that follow; payload: its size
  begin_volume,
  begin_change,
  add_texels,
  end_volume,
  forget_volume,
  pre_integration_table,
  render,
  integrals,  ///< what pixels would show with ever smaller steps (integral_parts.h)
  // replies, beside LauncherMessage::refused
  done,
  rendered,
  integrated,
  last = integrated
};

constexpr Protocol protocol_of(NodeMessage) {
  return {2, 17, std::uint16_t(NodeMessage::last)};
}

struct Change {
  volume::VolumeId volume = 0;
  std::uint64_t version = 0;
};

struct Texels {
  volume::VolumeId volume = 0;
  std::vector<volume::TexelBox> boxes;  ///< none is empty
  std::span<const std::byte> texels;    ///< of one box after the other; a view of the decoded bytes
};

/// An image, at the beginning of the image buffer.
struct RenderedReply {
  volume::Rect rect;
  volume::FrameCounts counts;
  bool lossy = false;  ///< a relay has sent it as JPEG, because its view moved
};

std::vector<std::byte> encode(const volume::VolumeDescription& volume);
/// Encodes all but the texels, which follow (and, after them, zeros up to a multiple of eight bytes).
std::vector<std::byte> encode_texels_head(const Texels& texels);
std::vector<std::byte> encode(const Change& change);
std::vector<std::byte> encode(const RenderedReply& reply);
std::vector<std::byte> encode_id(volume::VolumeId id);
std::vector<std::byte> encode_size(std::uint64_t bytes);

// All of these throw MalformedMessage. Decoded values are within limits.h.
volume::VolumeDescription decode_volume(std::span<const std::byte> payload);
Change decode_change(std::span<const std::byte> payload);
Texels decode_texels(std::span<const std::byte> payload);
RenderedReply decode_rendered(std::span<const std::byte> payload);
volume::VolumeId decode_id(std::span<const std::byte> payload);
std::uint64_t decode_size(std::span<const std::byte> payload);

}  // namespace understudy::compositor
