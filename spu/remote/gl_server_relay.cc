// SPDX-License-Identifier: Apache-2.0
#include "spu/remote/gl_server_relay.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "compositor/relay/jpeg.h"

namespace understudy::spu {

using compositor::Bytes;
using compositor::Clock;
using compositor::Deadline;
using compositor::MalformedMessage;
using compositor::Message;

namespace {

/// For smaller parts the overhead of a JPEG's tables is too large.
constexpr int least_jpeg_pixels = 4096;
constexpr std::size_t pixel_bytes = 4;

bool is_image(const Message& message) {
  return message.type == GlServerMessage::image || message.type == GlServerMessage::refined;
}

}  // namespace

void ViewerRelay::carry_back(Message message) {
  if (is_image(message)) message.payload = decode_travelling_image(message.payload);
  send_here(message);
}

void GlServerRelay::send_image(const Message& message, const ImageChange& change) {
  constexpr auto plain = PixelCoding::plain;
  const std::vector<std::byte> head = encode_head(change);
  const std::array<Bytes, 3> parts = {std::as_bytes(std::span(&plain, 1)), head, change.pixels};
  send_tcp(message, parts);
}

void GlServerRelay::send_jpeg(const Message& message, const ImageChange& change) {
  constexpr auto jpeg = PixelCoding::jpeg;
  const std::vector<std::byte> head = encode_head(change);
  coded_.clear();
  compositor::append_jpeg(change.pixels, change.width, change.height, compositor::JpegPixels::bgrx, quality_,
                          coded_);
  const std::array<Bytes, 3> parts = {std::as_bytes(std::span(&jpeg, 1)), head, coded_};
  send_tcp(message, parts);
}

void GlServerRelay::send_refined(const Message& message, std::uint64_t drawable, Shown& shown) {
  const Part part = std::exchange(shown.lossy, {});
  ImageChange change{.drawable = drawable,
                     .extent = shown.extent,
                     .x = part.left,
                     .y = part.top,
                     .width = part.right - part.left,
                     .height = part.bottom - part.top};
  const std::size_t row = std::size_t(change.width) * pixel_bytes;
  coded_.resize(row * std::size_t(change.height));
  for (int y = 0; y < change.height; ++y) {
    const std::size_t from =
        std::size_t(part.top + y) * std::size_t(shown.extent.width) + std::size_t(part.left);
    std::memcpy(coded_.data() + std::size_t(y) * row, shown.pixels.data() + from * pixel_bytes, row);
  }
  change.pixels = coded_;
  send_image(message, change);
}

void GlServerRelay::keep(Shown& shown, const ImageChange& change) const {
  if (shown.extent != change.extent) {
    shown.extent = change.extent;
    shown.pixels.assign(std::size_t(change.extent.width) * std::size_t(change.extent.height) * pixel_bytes, {});
    shown.lossy = {};
  }
  const std::size_t row = std::size_t(change.width) * pixel_bytes;
  for (int y = 0; y < change.height && row != 0; ++y) {
    const std::size_t to = std::size_t(change.y + y) * std::size_t(change.extent.width) + std::size_t(change.x);
    std::memcpy(shown.pixels.data() + to * pixel_bytes, change.pixels.data() + std::size_t(y) * row, row);
  }
}

void GlServerRelay::carry_out(Message message) {
  if (!is_image(message)) return Relay::carry_out(std::move(message));
  const ImageChange change = decode_image(message.payload);
  if (quality_ == 0) return send_image(message, change);
  last_image_ = Clock::now();
  Shown& shown = shown_[change.drawable];
  keep(shown, change);
  const bool nothing_changed = change.width == 0 || change.height == 0;
  if (nothing_changed && !shown.lossy.empty()) return send_refined(message, change.drawable, shown);
  const bool as_jpeg = change.width * std::int64_t(change.height) >= least_jpeg_pixels &&
                       std::max(change.width, change.height) <= compositor::max_jpeg_extent;
  if (!as_jpeg) return send_image(message, change);
  send_jpeg(message, change);
  const Part part = {change.x, change.y, change.x + change.width, change.y + change.height};
  Part& lossy = shown.lossy;
  lossy = lossy.empty() ? part
                        : Part{std::min(lossy.left, part.left), std::min(lossy.top, part.top),
                               std::max(lossy.right, part.right), std::max(lossy.bottom, part.bottom)};
}

Deadline GlServerRelay::rest_due() const {
  const bool lossy = std::ranges::any_of(shown_, [](const auto& entry) { return !entry.second.lossy.empty(); });
  return lossy ? last_image_ + rest_after : Relay::rest_due();
}

void GlServerRelay::rest() {
  const Message refined{GlServerMessage::refined, 0, {}, {}};
  for (auto& [drawable, shown] : shown_)
    if (!shown.lossy.empty()) send_refined(refined, drawable, shown);
}

}  // namespace understudy::spu
