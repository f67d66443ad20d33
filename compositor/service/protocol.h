// The messages between an application, the launcher and a node group.
//
// One message: a header, then `payload_bytes` of fields as in wire.h. An application sends a request and waits
// for its one reply before the next request. Images do not travel in messages: they lie in memory that the
// application made and whose descriptor it passed along (image_buffer).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "compositor/service/wire.h"
#include "volume/frame_counts.h"
#include "volume/request.h"

namespace understudy::compositor {

constexpr std::uint32_t protocol_magic = 0x59445355;  ///< "USDY"
constexpr std::uint16_t protocol_version = 11;        ///< grows with every change of a message

enum class MessageType : std::uint16_t {
  // to the launcher, and from it to a node group
  hello_client = 1,
  hello_nodes,  ///< payload: Hello
  client,       ///< attached: the connection of an application
  // from an application to rank 0
  image_buffer,  ///< attached: sealed memory for the images that follow; payload: its size
  begin_volume,
  begin_change,
  add_texels,
  end_volume,
  forget_volume,
  pre_integration_table,
  render,
  // replies
  accepted,  ///< payload: Hello
  done,
  rendered,
  refused,  ///< payload: the reason
  // volumes that the nodes read from files (load_protocol.h)
  load_volume,    ///< from an application to rank 0
  continue_load,  ///< the same
  loading,        ///< the reply to both
  // how often values occur in one (load_protocol.h)
  histogram,  ///< from an application to rank 0
  counted,    ///< the reply
  // what pixels would show without a step (integral_parts.h)
  integrals,   ///< from an application to rank 0
  integrated,  ///< the reply
  // from rank 0 to the launcher, once a second
  alive,  ///< payload: Alive
  // between an application and a GL server, which makes its OpenGL calls (spu/remote/gl_server_protocol.h)
  calls,     ///< from the application
  answered,  ///< a reply
  image,     ///< the other
  refined,   ///< pixels of an image that came before, as they are: the view rests
  // between the two ends of a connection over TCP
  line_alive,  ///< said by who has nothing else to say
  last = line_alive
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

/// How long rank 0 has been at a request whose application has gone; limits::max_unwanted_ms if longer.
struct Alive {
  int unwanted_ms = 0;
};

struct Change {
  volume::VolumeId volume = 0;
  std::uint64_t version = 0;
};

struct Texels {
  volume::VolumeId volume = 0;
  std::vector<volume::TexelBox> boxes;  ///< none is empty
  std::span<const std::byte> texels;    ///< of one box after the other; seen in place in the decoded bytes
};

/// A table that the requests that follow may name by its place.
struct KeptPreIntegrationTable {
  int place = 0;  ///< below limits::max_kept_pre_integration_tables
  volume::PreIntegrationTable table;
};

/// An image that lies at the beginning of the image buffer.
struct RenderedReply {
  volume::Rect rect;
  volume::FrameCounts counts;
};

std::vector<std::byte> encode(const Hello& hello);
std::vector<std::byte> encode(const Alive& alive);
std::vector<std::byte> encode(const volume::VolumeDescription& volume);
/// Everything but the texels, which follow (and, after them, zeros up to a multiple of eight bytes).
std::vector<std::byte> encode_texels_head(const Texels& texels);
std::vector<std::byte> encode(const Change& change);
std::vector<std::byte> encode(const KeptPreIntegrationTable& kept);
/// With `table_at`, a pre-integration table is not written but named by the place that it was sent to.
std::vector<std::byte> encode(const volume::RenderRequest& request, std::optional<int> table_at = {});
std::vector<std::byte> encode(const RenderedReply& reply);
std::vector<std::byte> encode_id(volume::VolumeId id);
std::vector<std::byte> encode_size(std::uint64_t bytes);
std::vector<std::byte> encode_text(const std::string& text);  ///< cut at limits::max_text_bytes

// All of these throw MalformedMessage. What comes back keeps within limits.h.
Hello decode_hello(std::span<const std::byte> payload);
Alive decode_alive(std::span<const std::byte> payload);
volume::VolumeDescription decode_volume(std::span<const std::byte> payload);
Change decode_change(std::span<const std::byte> payload);
Texels decode_texels(std::span<const std::byte> payload);
KeptPreIntegrationTable decode_pre_integration_table(std::span<const std::byte> payload);
/// `kept` by their places; where there is none its edge is 0.
volume::RenderRequest decode_request(std::span<const std::byte> payload,
                                     std::span<const volume::PreIntegrationTable> kept = {});
RenderedReply decode_rendered(std::span<const std::byte> payload);
volume::VolumeId decode_id(std::span<const std::byte> payload);
std::uint64_t decode_size(std::span<const std::byte> payload);
std::string decode_text(std::span<const std::byte> payload);

}  // namespace understudy::compositor
