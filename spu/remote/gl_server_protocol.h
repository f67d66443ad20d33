// SPDX-License-Identifier: Apache-2.0
// What an application and a GL server say to each other: hello_client and acceptance as at the launcher
// (compositor/service/launcher_protocol.h), then calls, to which the GL server replies where it says so.
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
  answered,   ///< a reply
  image,      ///< the other
  refined,    ///< pixels of an image that came before, as they are: the view rests
  last = refined
};

constexpr compositor::Protocol protocol_of(GlServerMessage) {
  return {4, 12, std::uint16_t(GlServerMessage::last)};
}

inline constexpr std::array gl_server_protocols{protocol_of(compositor::LauncherMessage{}),
                                                protocol_of(GlServerMessage{})};

/// The highest OpenGL versions that the GL server can make contexts of, as 100 * major + 10 * minor; 0: none.
struct GlServerVersions {
  int core = 0;
  int compatibility = 0;
};

enum class ServerReply : std::uint64_t {
  none,
  answer,  ///< of the last record: call_answer.h
  image,   ///< the last record is a `frame` or `front_shown` event
};

/// Before the chunks (chunks.h) that make the records (spu/stream/record.h) of one thread, and their payload.
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

/// What changed of a drawable's image since the last one: `width` x `height` pixels whose upper left corner
/// is at x, y from the upper left. Nothing changed where one of them is 0.
struct ImageChange {
  std::uint64_t drawable = 0;  ///< as the application's calls number it
  Extent2D extent;             ///< of the drawable
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;
  std::span<const std::byte> pixels;  ///< rows from the top; blue, green, red, unused
};

std::vector<std::byte> encode(const GlServerVersions& versions);
/// The message is this, then the pixels.
std::vector<std::byte> encode_head(const ImageChange& change);
constexpr std::size_t image_head_bytes = 7 * sizeof(std::uint64_t);

// All of these throw compositor::MalformedMessage.
GlServerVersions decode_versions(std::span<const std::byte> payload);
/// `payload` must be aligned for words; what comes back lies in `chunks`, until the next message.
Calls decode_calls(std::span<const std::byte> payload, ChunkReceiver& chunks);
/// Without pixels; `payload` may go on behind the head.
ImageChange decode_image_head(std::span<const std::byte> payload);
/// What comes back leads into `payload`.
ImageChange decode_image(std::span<const std::byte> payload);

}  // namespace understudy::spu
