// The messages between an application, the launcher and a node group.
//
// One message: a header, then `payload_bytes` of fields as in wire.h. An application sends a request and waits
// for its one reply before the next request. Pictures do not travel in messages: they lie in memory that the
// application made and whose descriptor it passed along (image_memory).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "compositor/service/wire.h"
#include "volume/request.h"

namespace understudy::compositor {

constexpr std::uint32_t protocol_magic = 0x59445355;  ///< "USDY"
constexpr std::uint16_t protocol_version = 3;         ///< grows with every change of a message

enum class MessageType : std::uint16_t {
  // to the launcher, and from it to a node group
  hello_client = 1,
  hello_nodes,  ///< payload: Hello
  client,       ///< attached: the connection of an application
  // from an application to rank 0
  image_memory,  ///< attached: sealed memory for the pictures that follow; payload: its size
  begin_volume,
  add_slices,
  end_volume,
  forget_volume,
  render,
  // replies
  welcome,  ///< payload: Hello
  done,
  rendered,
  refused,  ///< payload: the reason
  last = refused
};

struct MessageHeader {
  std::uint32_t magic = protocol_magic;
  std::uint16_t version = protocol_version;
  MessageType type{};
  std::uint64_t payload_bytes = 0;
  std::uint64_t sequence = 0;  ///< a reply repeats that of its request
};
static_assert(sizeof(MessageHeader) == 24);

/// Throws MalformedMessage unless magic, version and type are ours and the payload is no longer than
/// `max_payload`.
void check(const MessageHeader& header, std::uint64_t max_payload);

struct Hello {
  int ranks = 0;
};

struct Slices {
  volume::VolumeId volume = 0;
  int first_slice = 0;
  int slices = 0;
  std::span<const std::byte> texels;  ///< seen in place in the decoded bytes
};

/// A picture that lies at the beginning of the image memory.
struct RenderedReply {
  volume::Rect rect;
  volume::FrameCounts counts;
};

std::vector<std::byte> encode(const Hello& hello);
std::vector<std::byte> encode(const volume::VolumeDescription& volume);
/// Everything but the texels, which follow (and, after them, zeros up to a multiple of eight bytes).
std::vector<std::byte> encode_slices_head(const Slices& slices);
std::vector<std::byte> encode(const volume::RenderRequest& request);
std::vector<std::byte> encode(const RenderedReply& reply);
std::vector<std::byte> encode_id(volume::VolumeId id);
std::vector<std::byte> encode_size(std::uint64_t bytes);
std::vector<std::byte> encode_text(const std::string& text);  ///< cut at limits::max_text_bytes

// All of these throw MalformedMessage. What comes back keeps within limits.h.
Hello decode_hello(std::span<const std::byte> payload);
volume::VolumeDescription decode_volume(std::span<const std::byte> payload);
Slices decode_slices(std::span<const std::byte> payload);
volume::RenderRequest decode_request(std::span<const std::byte> payload);
RenderedReply decode_rendered(std::span<const std::byte> payload);
volume::VolumeId decode_id(std::span<const std::byte> payload);
std::uint64_t decode_size(std::span<const std::byte> payload);
std::string decode_text(std::span<const std::byte> payload);

}  // namespace understudy::compositor
