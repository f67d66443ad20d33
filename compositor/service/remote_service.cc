// SPDX-License-Identifier: Apache-2.0
#include "compositor/service/remote_service.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <optional>
#include <type_traits>

#include "compositor/rendered.h"
#include "compositor/service/image_buffer.h"
#include "compositor/service/integral_parts.h"
#include "compositor/service/load_protocol.h"
#include "compositor/service/loading_service.h"
#include "compositor/service/request_message.h"
#include "compositor/service/sent_pre_integration_tables.h"
#include "compositor/service/service_protocols.h"
#include "compositor/transport/connection.h"
#include "compositor/transport/peer.h"
#include "volume/request.h"

namespace understudy::compositor {

namespace {

using std::chrono::milliseconds;

class RemoteRenderService : public LoadingService {
 public:
  RemoteRenderService(std::string address, const Patience& patience)
      : address_(std::move(address)), patience_(patience) {
    const Deadline deadline = Clock::now() + patience_.connect;
    try {
      connection_.emplace(connect_to(address_, deadline), service_protocols);
    } catch (const ForeignListener& error) {
      throw ServiceLost(error.what(), "another user listens where the render nodes should");
    } catch (const std::runtime_error& error) {
      throw ServiceLost(
          fmt::format("{}: start the launcher again; the application draws by itself", error.what()));
    }
    const Message accepted = conversation([&] {
      try {
        connection_->send(LauncherMessage::hello_client, ++sequence_, Bytes{}, deadline);
      } catch (const ConnectionLost&) {
        // A launcher that turns applications away does not read their hello, and has sent the reason.
      }
      if (!wait_until_ready(connection_->fd(), POLLIN, deadline))
        throw ConnectionLost(fmt::format("was not there within {} ms", patience_.connect.count()));
      return connection_->receive(Clock::now() + patience_.reply);
    });
    if (accepted.type == LauncherMessage::refused)
      conversation([&] { throw ConnectionLost("cannot serve: " + decode_text(accepted.payload)); });
    if (accepted.type != LauncherMessage::accepted) lose("answered out of turn");
    ranks_ = conversation([&] { return decode_hello(accepted.payload).ranks; });
  }

  void begin_volume(const volume::VolumeDescription& volume) override {
    give_up_posted();
    post(NodeMessage::begin_volume, encode(volume));
  }

  std::vector<RankLoad> begin_load(const LoadRequest& wanted) override {
    return load(LoadMessage::load_volume, encode(wanted));
  }
  std::vector<RankLoad> continue_load(volume::VolumeId id) override {
    return load(LoadMessage::continue_load, encode_id(id));
  }

  std::vector<std::uint64_t> histogram(volume::VolumeId id, const volume::HistogramBins& bins) override {
    give_up_posted();
    const Message reply = request(LoadMessage::histogram, encode(HistogramQuestion{id, bins}), patience_.reply,
                                  LoadMessage::counted);
    auto counts = conversation([&] { return decode_histogram(reply.payload); });
    if (counts.size() != std::size_t(bins.count)) lose("counted by other bins than were asked for");
    return counts;
  }

  void begin_change(volume::VolumeId id, std::uint64_t version) override {
    give_up_posted();
    post(NodeMessage::begin_change, encode(Change{id, version}));
  }

  void add_texels(volume::VolumeId id, std::span<const volume::TexelBox> boxes,
                  std::span<const std::byte> texels) override {
    std::size_t count = 0;
    for (const volume::TexelBox& box : boxes) count += volume::texels_in(box);
    if (count == 0 || texels.size() % count != 0)
      throw RequestRefused(fmt::format("{} bytes are not {} texels of volume {}", texels.size(), count, id));
    const std::size_t texel = texels.size() / count;
    Texels message{id, {}, texels.first(0)};
    const auto send = [&] {
      if (message.boxes.empty()) return;
      static constexpr std::array<std::byte, 8> padding{};
      const auto head = encode_texels_head(message);
      const std::array<Bytes, 3> parts{head, message.texels,
                                       Bytes(padding).first((8 - message.texels.size() % 8) % 8)};
      post(NodeMessage::add_texels, parts);
      texels = texels.subspan(message.texels.size());
      message = {id, {}, texels.first(0)};
    };
    for (const volume::TexelBox& box : boxes) {
      const std::size_t slice_bytes =
          volume::texels_in({box.low, {box.high[0], box.high[1], box.low[2] + 1}}) * texel;
      if (slice_bytes > limits::max_slice_bytes)
        throw RequestRefused(
            fmt::format("a slice of {} bytes is over the limit of {}", slice_bytes, limits::max_slice_bytes));
      for (int z = box.low[2]; z < box.high[2];) {
        // As many slices as still fit into the message, but at least one into an empty message.
        const std::size_t room = limits::max_slice_range_bytes -
                                 std::min<std::size_t>(limits::max_slice_range_bytes, message.texels.size());
        const std::size_t fits =
            std::max<std::size_t>(room / std::max<std::size_t>(1, slice_bytes), message.boxes.empty() ? 1 : 0);
        if (fits == 0 || message.boxes.size() == limits::max_boxes_per_message) {
          send();
          continue;
        }
        const int end = z + int(std::min(fits, std::size_t(box.high[2] - z)));
        const std::size_t bytes = message.texels.size() + slice_bytes * std::size_t(end - z);
        message.boxes.push_back({{box.low[0], box.low[1], z}, {box.high[0], box.high[1], end}});
        message.texels = texels.first(bytes);
        z = end;
      }
    }
    send();
  }

  void end_volume(volume::VolumeId id) override {
    request(NodeMessage::end_volume, encode_id(id), patience_.reply);
  }

  void forget_volume(volume::VolumeId id) override {
    give_up_posted();
    request(NodeMessage::forget_volume, encode_id(id), patience_.reply);
  }

  Rendered render(const volume::RenderRequest& wanted) override {
    give_up_posted();
    make_room(wanted.window);
    std::optional<int> table_at;
    if (const auto* pairs = std::get_if<volume::PreIntegrationTable>(&wanted.classification))
      table_at = place_of(*pairs);
    const Message reply =
        request(NodeMessage::render, encode(wanted, table_at), patience_.render, NodeMessage::rendered);
    const RenderedReply rendered = conversation([&] { return decode_rendered(reply.payload); });
    const std::size_t floats = 4 * rendered.rect.pixels();
    // An empty image need not lie in the window.
    if (floats > image_.floats().size() ||
        (floats > 0 && intersection(rendered.rect, wanted.window) != rendered.rect))
      lose("answered with an image that does not fit the window");
    return {{rendered.rect, image_.floats().first(floats)}, rendered.counts, false, rendered.lossy};
  }

  std::vector<volume::PixelIntegral> integrals(const volume::RenderRequest& wanted,
                                               std::span<const volume::Pixel> pixels, double most_ms) override {
    give_up_posted();
    const Message reply = request(NodeMessage::integrals, encode(wanted, pixels, most_ms), patience_.render,
                                  NodeMessage::integrated);
    auto integrals = conversation([&] { return decode_integrals(reply.payload); });
    if (integrals.size() > pixels.size()) lose("answered with more pixels than were asked for");
    return integrals;
  }

  int nodes() const override { return ranks_; }

 private:
  std::vector<RankLoad> load(MessageType type, const std::vector<std::byte>& payload) {
    give_up_posted();
    const Message reply = request(type, payload, patience_.load, LoadMessage::loading);
    return conversation([&] { return decode_loads(reply.payload); });
  }

  // Returns the table's place on the nodes; sends the table if they do not have it.
  int place_of(const volume::PreIntegrationTable& pairs) {
    if (const std::optional<int> place = pre_integration_tables_.find(pairs)) return *place;
    const int place = pre_integration_tables_.make_place();
    request(NodeMessage::pre_integration_table, encode(KeptPreIntegrationTable{place, pairs}), patience_.reply);
    pre_integration_tables_.put(place, pairs);
    return place;
  }

  // Images never exceed the window, so the memory is made once per window size.
  void make_room(const volume::Rect& window) {
    if (window.pixels() > limits::max_window_pixels)
      throw RequestRefused(fmt::format("an image of {} pixels is over the limit of {}", window.pixels(),
                                       limits::max_window_pixels));
    const std::uint64_t bytes = window.pixels() * 4 * sizeof(float);
    if (bytes <= image_.bytes()) return;
    image_ = {};  // first: this call invalidates the image in the old one
    ImageBuffer fresh;
    try {
      fresh = ImageBuffer::create(bytes);
    } catch (const std::runtime_error& error) {
      throw RequestRefused(error.what());
    }
    const std::vector<std::byte> size = encode_size(bytes);
    const Bytes payload(size);
    request(NodeMessage::image_buffer, {&payload, 1}, patience_.reply, NodeMessage::done, fresh.fd());
    fresh.close_descriptor();
    image_ = std::move(fresh);  // both sides have it
  }

  Message request(MessageType type, const std::vector<std::byte>& payload, milliseconds patience,
                  MessageType expected = NodeMessage::done) {
    const Bytes part(payload);
    return request(type, {&part, 1}, patience, expected);
  }

  // Sends one request and receives its reply.
  Message request(MessageType type, std::span<const Bytes> parts, milliseconds patience,
                  MessageType expected = NodeMessage::done, int attach = -1) {
    send(type, parts, attach);
    return reply(patience, expected);
  }

  // Sends a request whose reply is received before the next request: the caller prepares that meanwhile.
  void post(MessageType type, const std::vector<std::byte>& payload) {
    const Bytes part(payload);
    post(type, {&part, 1});
  }
  void post(MessageType type, std::span<const Bytes> parts) {
    send(type, parts);
    posted_ = true;
  }

  void send(MessageType type, std::span<const Bytes> parts, int attach = -1) {
    require_connection();
    settle_posted();
    conversation([&] { connection_->send(type, ++sequence_, parts, patience_.send, attach); });
  }

  void require_connection() const {
    if (!connection_) throw ServiceLost(lost_);
    if (::getpid() != process_)
      throw ServiceLost("the connection to the node group belongs to the process before fork()");
  }

  void settle_posted() {
    if (!posted_) return;
    require_connection();
    posted_ = false;
    reply(patience_.reply, NodeMessage::done);
  }

  // If sending a volume was broken off, a refusal of that volume is ignored.
  void give_up_posted() {
    try {
      settle_posted();
    } catch (const RequestRefused&) {
    }
  }

  Message reply(milliseconds patience, MessageType expected) {
    Message reply = conversation([&] { return connection_->receive(Clock::now() + patience); });
    if (reply.sequence != sequence_) lose("answered another request");
    if (reply.type == LauncherMessage::refused)
      throw RequestRefused(conversation([&] { return decode_text(reply.payload); }));
    if (reply.type != expected) lose("answered out of turn");
    return reply;
  }

  // Any error ends the connection for good: a late reply must not be taken for the next one.
  template <class Talk>
  std::invoke_result_t<Talk> conversation(Talk talk) {
    try {
      return talk();
    } catch (const ConnectionLost& error) {
      lose(error.what());
    } catch (const MalformedMessage& error) {
      lose(fmt::format("sent what cannot be believed ({})", error.what()));
    }
  }

  [[noreturn]] void lose(const std::string& what) {
    connection_.reset();
    lost_ = fmt::format("the node group at '{}' {}; the application draws by itself", address_, what);
    throw ServiceLost(lost_);
  }

  std::string address_;
  Patience patience_;
  std::optional<Connection> connection_;
  std::string lost_;
  std::uint64_t sequence_ = 0;
  bool posted_ = false;  // the reply to the last request has not been received yet
  int ranks_ = 0;
  pid_t process_ = ::getpid();
  ImageBuffer image_;
  SentPreIntegrationTables pre_integration_tables_;
};

}  // namespace

std::unique_ptr<RenderService> remote_render_service(const std::string& address, const Patience& patience) {
  return std::make_unique<RemoteRenderService>(address, patience);
}

std::unique_ptr<LoadingService> remote_loading_service(const std::string& address, const Patience& patience) {
  return std::make_unique<RemoteRenderService>(address, patience);
}

std::unique_ptr<RenderService> remote_render_service(const std::string& address, int patience_ms) {
  Patience patience;
  patience.connect = milliseconds(patience_ms);
  return remote_render_service(address, patience);
}

}  // namespace understudy::compositor
