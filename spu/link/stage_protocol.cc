#include "spu/link/stage_protocol.h"

#include <cstring>

#include "compositor/service/limits.h"
#include "compositor/service/wire.h"

namespace understudy::spu {

using compositor::MalformedMessage;
using compositor::Reader;
using compositor::Writer;

namespace {

constexpr int max_version = 1000;

}  // namespace

std::vector<std::byte> encode(const StageVersions& versions) {
  Writer out;
  out.integer(versions.core);
  out.integer(versions.compatibility);
  return out.bytes();
}

StageVersions decode_versions(std::span<const std::byte> payload) {
  Reader in("versions of a stage", payload);
  StageVersions versions;
  versions.core = in.small("core", 0, max_version);
  versions.compatibility = in.small("compatibility", 0, max_version);
  in.end();
  return versions;
}

Calls decode_calls(std::span<const std::byte> payload, ChunkReceiver& chunks) {
  Calls calls;
  if (payload.size() < sizeof calls.head) throw MalformedMessage("calls: shorter than their head");
  std::memcpy(&calls.head, payload.data(), sizeof calls.head);
  if (calls.head.reply > StageReply::picture) throw MalformedMessage("calls: want a reply of no kind");
  constexpr std::uint64_t most = compositor::limits::max_stage_message_bytes / sizeof(std::uint64_t);
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

std::vector<std::byte> encode_head(const PictureChange& change) {
  Writer out;
  out.integer(std::int64_t(change.drawable));
  for (const int value :
       {change.extent.width, change.extent.height, change.x, change.y, change.width, change.height})
    out.integer(value);
  return out.bytes();
}

PictureChange decode_picture_head(std::span<const std::byte> payload) {
  if (payload.size() < picture_head_bytes) throw MalformedMessage("picture: shorter than its head");
  Reader in("picture", payload.first(picture_head_bytes));
  constexpr int most = compositor::limits::max_viewport_extent;
  PictureChange change;
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

PictureChange decode_picture(std::span<const std::byte> payload) {
  PictureChange change = decode_picture_head(payload);
  change.pixels = payload.subspan(picture_head_bytes);
  if (change.pixels.size() != std::size_t(change.width) * std::size_t(change.height) * 4)
    throw MalformedMessage("picture: not as many pixels as announced");
  return change;
}

}  // namespace understudy::spu
