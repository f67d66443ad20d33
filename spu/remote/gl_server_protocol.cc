// SPDX-License-Identifier: Apache-2.0
#include "spu/remote/gl_server_protocol.h"

#include <cstring>

#include "compositor/service/limits.h"
#include "compositor/transport/wire.h"

namespace understudy::spu {

using compositor::MalformedMessage;
using compositor::Reader;
using compositor::Writer;

namespace {

constexpr int max_version = 1000;

}  // namespace

std::vector<std::byte> encode(const GlServerVersions& versions) {
  Writer out;
  out.integer(versions.core);
  out.integer(versions.compatibility);
  return out.bytes();
}

GlServerVersions decode_versions(std::span<const std::byte> payload) {
  Reader in("versions of a GL server", payload);
  GlServerVersions versions;
  versions.core = in.small("core", 0, max_version);
  versions.compatibility = in.small("compatibility", 0, max_version);
  in.end();
  return versions;
}

Calls decode_calls(std::span<const std::byte> payload, ChunkReceiver& chunks) {
  Calls calls;
  if (payload.size() < sizeof calls.head) throw MalformedMessage("calls: shorter than their head");
  std::memcpy(&calls.head, payload.data(), sizeof calls.head);
  if (calls.head.reply > ServerReply::image) throw MalformedMessage("calls: want a reply of no kind");
  constexpr std::uint64_t most = compositor::limits::max_gl_server_message_bytes / sizeof(std::uint64_t);
  if (calls.head.record_words > most || calls.head.payload_words > most - calls.head.record_words ||
      payload.size() % sizeof(std::uint64_t) != 0) {
    throw MalformedMessage("calls: more words than any application sends at once");
  }
  const std::uint64_t announced = calls.head.record_words + calls.head.payload_words;
  const std::span<const std::uint64_t> words =
      chunks.receive({reinterpret_cast<const std::uint64_t*>(payload.data() + sizeof calls.head),
                      (payload.size() - sizeof calls.head) / sizeof(std::uint64_t)},
                     announced);
  if (words.size() != announced) throw MalformedMessage("calls: fewer words than announced");
  calls.records = words.first(calls.head.record_words);
  calls.payload = words.subspan(calls.head.record_words);
  return calls;
}

std::vector<std::byte> encode_head(const ImageChange& change) {
  Writer out;
  out.integer(std::int64_t(change.drawable));
  for (const int value :
       {change.extent.width, change.extent.height, change.x, change.y, change.width, change.height})
    out.integer(value);
  return out.bytes();
}

ImageChange decode_image_head(std::span<const std::byte> payload) {
  if (payload.size() < image_head_bytes) throw MalformedMessage("image: shorter than its head");
  Reader in("image", payload.first(image_head_bytes));
  constexpr int most = compositor::limits::max_viewport_extent;
  ImageChange change;
  change.drawable = in.word("drawable");
  change.extent.width = in.small("extent.width", 0, most);
  change.extent.height = in.small("extent.height", 0, most);
  change.x = in.small("x", 0, change.extent.width);
  change.y = in.small("y", 0, change.extent.height);
  change.width = in.small("width", 0, change.extent.width - change.x);
  change.height = in.small("height", 0, change.extent.height - change.y);
  if (std::uint64_t(change.extent.width) * std::uint64_t(change.extent.height) >
      compositor::limits::max_window_pixels)
    in.fail("extent", "is larger than windows are");
  return change;
}

ImageChange decode_image(std::span<const std::byte> payload) {
  ImageChange change = decode_image_head(payload);
  change.pixels = payload.subspan(image_head_bytes);
  if (change.pixels.size() != std::size_t(change.width) * std::size_t(change.height) * 4)
    throw MalformedMessage("image: not as many pixels as announced");
  return change;
}

}  // namespace understudy::spu
