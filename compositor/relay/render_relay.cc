// SPDX-License-Identifier: Apache-2.0
#include "compositor/relay/render_relay.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <string_view>

#include "compositor/exchange/pixel_numbers.h"
#include "compositor/relay/jpeg.h"
#include "compositor/service/limits.h"
#include "compositor/service/request_message.h"
#include "compositor/service/service_protocols.h"

namespace understudy::compositor {

namespace {

/// Smaller images are not worth a JPEG's tables.
constexpr std::size_t least_jpeg_pixels = 4096;
/// A viewer that shows several volumes requests their images in turn.
constexpr std::size_t remembered_requests = 4;

struct ImageHead {
  std::uint32_t reply_bytes = 0;  ///< of the message as the nodes made it
  ImageCoding coding = ImageCoding::floats;
  Layout layout = Layout::rgba32f;
  std::uint16_t unused = 0;
};
static_assert(sizeof(ImageHead) == 8);

std::vector<std::byte> to_bytes(std::span<const float> pixels) {
  std::vector<std::byte> bytes(pixels.size());
  std::ranges::transform(pixels, bytes.begin(),
                         [](float value) { return std::byte(std::clamp(value, 0.0F, 1.0F) * 255 + 0.5F); });
  return bytes;
}

void encode_jpegs(std::span<const float> pixels, int width, int quality, std::vector<std::byte>& to) {
  const int height = int(pixels.size() / 4) / width;
  const std::vector<std::byte> colours = to_bytes(pixels);
  std::vector<std::byte> alphas(pixels.size() / 4);
  for (std::size_t i = 0; i < alphas.size(); ++i) alphas[i] = colours[4 * i + 3];
  const std::size_t begin = to.size();
  to.resize(begin + sizeof(std::uint64_t));
  append_jpeg(colours, width, height, JpegPixels::rgbx, quality, to);
  const std::uint64_t colour_bytes = to.size() - begin - sizeof(std::uint64_t);
  std::memcpy(to.data() + begin, &colour_bytes, sizeof colour_bytes);
  append_jpeg(alphas, width, height, JpegPixels::gray, quality, to);
}

void decode_jpegs(std::span<const std::byte> from, int width, std::span<float> to) {
  const int height = int(to.size() / 4) / width;
  std::uint64_t colour_bytes = 0;
  if (from.size() < sizeof colour_bytes) throw MalformedMessage("image: shorter than its head");
  std::memcpy(&colour_bytes, from.data(), sizeof colour_bytes);
  from = from.subspan(sizeof colour_bytes);
  if (colour_bytes > from.size()) throw MalformedMessage("image: shorter than it says");
  std::vector<std::byte> colours(to.size());
  std::vector<std::byte> alphas(to.size() / 4);
  read_jpeg(from.first(colour_bytes), width, height, JpegPixels::rgbx, colours);
  read_jpeg(from.subspan(colour_bytes), width, height, JpegPixels::gray, alphas);
  for (std::size_t i = 0; i < to.size(); ++i)
    to[i] = float(std::to_integer<int>(i % 4 == 3 ? alphas[i / 4] : colours[i])) / 255;
}

/// Both ends keep the memory for the next images, without its descriptor.
std::shared_ptr<ImageBuffer> shared(ImageBuffer memory) {
  memory.close_descriptor();
  return std::make_shared<ImageBuffer>(std::move(memory));
}

std::span<float> room_for(const RenderedReply& reply, std::span<float> memory) {
  const std::size_t floats = 4 * reply.rect.pixels();
  if (floats > memory.size()) throw MalformedMessage("image: larger than the memory for images");
  return memory.first(floats);
}

}  // namespace

void encode_image(std::span<const float> pixels, int width, ImageCoding coding, Layout layout, int jpeg_quality,
                  std::vector<std::byte>& to) {
  const std::size_t begin = to.size();
  switch (coding) {
    case ImageCoding::floats:
      to.insert(to.end(), std::as_bytes(pixels).begin(), std::as_bytes(pixels).end());
      break;
    case ImageCoding::packed: {
      LastPixel last{};
      to.resize(begin + most_packed_bytes(pixels.size() / 4));
      to.resize(begin + pack_pixels(pixels, layout, last, to.data() + begin));
      break;
    }
    case ImageCoding::jpeg:
      encode_jpegs(pixels, width, jpeg_quality, to);
      break;
  }
}

void decode_image(std::span<const std::byte> from, ImageCoding coding, Layout layout, int width,
                  std::span<float> to) {
  switch (coding) {
    case ImageCoding::floats:
      if (from.size() != to.size_bytes()) throw MalformedMessage("image: not as many pixels as announced");
      std::memcpy(to.data(), from.data(), from.size());
      break;
    case ImageCoding::packed: {
      LastPixel last{};
      if (from.empty() || unpack_pixels(from, layout, last, to) != from.size())
        throw MalformedMessage("image: not as many packed pixels as announced");
      break;
    }
    case ImageCoding::jpeg:
      decode_jpegs(from, width, to);
      break;
  }
}

Bytes take_image(Bytes payload, std::span<float> memory) {
  ImageHead head;
  if (payload.size() < sizeof head) throw MalformedMessage("image: shorter than its head");
  std::memcpy(&head, payload.data(), sizeof head);
  if (head.reply_bytes > payload.size() - sizeof head || head.coding > ImageCoding::last ||
      head.layout > Layout::rgba8)
    throw MalformedMessage("image: written in no way that is known");
  const Bytes reply = payload.subspan(sizeof head, head.reply_bytes);
  const RenderedReply rendered = decode_rendered(reply);
  const std::span<float> room = room_for(rendered, memory);
  const Bytes image = payload.subspan(sizeof head + head.reply_bytes);
  if (room.empty() && !image.empty()) throw MalformedMessage("image: of no pixels, with some");
  if (!room.empty()) decode_image(image, head.coding, head.layout, rendered.rect.width, room);
  return reply;
}

bool ApplicationRelay::needs_whole(const MessageType& type) const {
  return type == NodeMessage::image_buffer;
}

void ApplicationRelay::carry_out(Message message) {
  if (message.type == NodeMessage::image_buffer)
    memory_ = shared(ImageBuffer::map(std::move(message.attached), decode_size(message.payload)));
  Relay::carry_out(std::move(message));
}

void ApplicationRelay::carry_back(Message message) {
  if (message.type != NodeMessage::rendered) return Relay::carry_back(std::move(message));
  const std::shared_ptr<ImageBuffer> memory = memory_;
  send_here(message, take_image(message.payload, memory ? memory->floats() : std::span<float>()));
}

void NodesRelay::carry_back(Message message) {
  if (message.type == LauncherMessage::hello_nodes) throw MalformedMessage("wants to be the nodes");
  if (message.type == NodeMessage::render) {
    exact_ = asks_for_exact_image(message.payload);
    repeats_ = connection_request_.jpeg_quality > 0 && repeats(message.payload);
  }
  if (message.type != NodeMessage::image_buffer) return Relay::carry_back(std::move(message));
  const std::uint64_t bytes = decode_size(message.payload);
  if (bytes > limits::max_window_pixels * 4 * sizeof(float))
    throw MalformedMessage("asks for more memory for images than any window needs");
  ImageBuffer memory = ImageBuffer::create(bytes);
  send_here(message, memory.fd());
  memory_ = shared(std::move(memory));
}

/// Returns whether the request is among the last ones, and remembers it as the latest. Another request with the
/// same hash would only be answered without loss.
bool NodesRelay::repeats(Bytes request) {
  const std::string_view text(reinterpret_cast<const char*>(request.data()), request.size());
  const std::size_t hash = std::hash<std::string_view>()(text);
  const auto known = std::ranges::find(last_requests_, hash);
  if (known != last_requests_.end()) {
    std::rotate(known, known + 1, last_requests_.end());
    return true;
  }
  if (last_requests_.size() == remembered_requests) last_requests_.erase(last_requests_.begin());
  last_requests_.push_back(hash);
  return false;
}

ImageCoding NodesRelay::coding_of(const volume::Rect& rect) {
  if (rect.empty()) return ImageCoding::floats;
  const bool fits = std::max(rect.width, rect.height) <= max_jpeg_extent && rect.pixels() >= least_jpeg_pixels;
  if (connection_request_.jpeg_quality > 0 && fits && !exact_ && !repeats_) return ImageCoding::jpeg;
  if (connection_request_.pixels != Layout::rgba32f && !exact_) return ImageCoding::packed;
  return packing_.pays(line_bytes_per_second()) ? ImageCoding::packed : ImageCoding::floats;
}

/// Returns a view of the encoded image, valid until the next call.
Bytes NodesRelay::coded(std::span<const float> pixels, int width, ImageCoding coding, Layout layout) {
  if (coding == ImageCoding::floats) return std::as_bytes(pixels);
  const auto start = Clock::now();
  coded_.clear();
  encode_image(pixels, width, coding, layout, connection_request_.jpeg_quality, coded_);
  const std::chrono::duration<double> took = Clock::now() - start;
  if (coding == ImageCoding::packed && layout == Layout::rgba32f)
    packing_.packed(took.count(), pixels.size_bytes(), coded_.size());
  return coded_;
}

bool NodesRelay::needs_whole(const MessageType& type) const {
  return type == NodeMessage::rendered;
}

void NodesRelay::carry_out(Message message) {
  if (message.type != NodeMessage::rendered) return Relay::carry_out(std::move(message));
  RenderedReply rendered = decode_rendered(message.payload);
  const std::shared_ptr<ImageBuffer> memory = memory_;
  const std::span<const float> pixels = room_for(rendered, memory ? memory->floats() : std::span<float>());
  ImageHead head;
  head.coding = coding_of(rendered.rect);
  head.layout = exact_ ? Layout::rgba32f : connection_request_.pixels;
  rendered.lossy = head.coding == ImageCoding::jpeg;
  const std::vector<std::byte> reply = encode(rendered);
  head.reply_bytes = std::uint32_t(reply.size());
  const std::array<Bytes, 3> parts = {std::as_bytes(std::span(&head, 1)), reply,
                                      coded(pixels, rendered.rect.width, head.coding, head.layout)};
  send_tcp(message, parts);
}

}  // namespace understudy::compositor
