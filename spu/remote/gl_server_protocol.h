// SPDX-License-Identifier: Apache-2.0
// The messages between an application and a GL server: hello_client and acceptance as with the launcher
// (compositor/service/launcher_protocol.h), then calls, which the GL server answers if they request a reply.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "compositor/service/launcher_protocol.h"
#include "spu/remote/chunks.h"
#include "spu/window_system/window_system.h"

namespace understudy::spu {

enum class GlServerMessage : std::uint16_t {
  calls = 1,  ///< from the application
  answered,   ///< a reply of the kind `answer`
  image,      ///< a reply of the kind `image`
  refined,    ///< exact pixels of an image that was sent before, once the view rests
  last = refined
};

constexpr compositor::Protocol protocol_of(GlServerMessage) {
  return {4, 12, std::uint16_t(GlServerMessage::last)};
}

inline constexpr std::array gl_server_protocols{protocol_of(compositor::LauncherMessage{}),
                                                protocol_of(GlServerMessage{})};

/// The GL server's highest OpenGL versions, as 100 * major + 10 * minor; 0: none.
struct GlServerVersions {
  int core = 0;
  int compatibility = 0;
};

enum class ServerReply : std::uint64_t {
  none,
  answer,  ///< the answer of the last record: call_answer.h
  image,   ///< the last record is a `frame` or `front_shown` event
};

/// Precedes the chunks (chunks.h) of the records (spu/stream/record.h) of one thread and their payload.
struct CallsHead {
  std::uint64_t thread = 0;
  ServerReply reply = ServerReply::none;
  std::uint64_t record_words = 0;
  std::uint64_t payload_words = 0;
};
static_assert(sizeof(CallsHead) == 32);

struct Calls {
  CallsHead head;
  std::span<const std::uint64_t> records;
  std::span<const std::uint64_t> payload;
};

/// The part of a drawable's image that has changed since the last image: `width` x `height` pixels whose upper
/// left corner is at x, y from the upper left. If one of them is 0, nothing has changed.
struct ImageChange {
  std::uint64_t drawable = 0;  ///< its number in the application's calls
  Extent2D extent;             ///< of the whole drawable
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;
  std::span<const std::byte> pixels;  ///< rows from the top; blue, green, red, unused
};

std::vector<std::byte> encode(const GlServerVersions& versions);
/// A message consists of this head and the pixels.
std::vector<std::byte> encode_head(const ImageChange& change);
constexpr std::size_t image_head_bytes = 7 * sizeof(std::uint64_t);

// All of these throw compositor::MalformedMessage.
GlServerVersions decode_versions(std::span<const std::byte> payload);
/// `payload` must be aligned for words. The result refers to memory of `chunks`, valid until the next message.
Calls decode_calls(std::span<const std::byte> payload, ChunkReceiver& chunks);
/// Decodes all but the pixels; `payload` may continue after the head.
ImageChange decode_image_head(std::span<const std::byte> payload);
/// The result refers to memory of `payload`.
ImageChange decode_image(std::span<const std::byte> payload);

}  // namespace understudy::spu
