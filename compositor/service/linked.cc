#include "compositor/service/linked.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <optional>
#include <type_traits>

#include "compositor/service/connection.h"
#include "compositor/service/image_memory.h"
#include "compositor/service/protocol.h"

namespace understudy::compositor {

namespace {

using std::chrono::milliseconds;

class LinkedService : public RenderService {
 public:
  LinkedService(std::string address, const Patience& patience)
      : address_(std::move(address)), patience_(patience) {
    const Deadline deadline = Clock::now() + patience_.connect;
    try {
      connection_.emplace(connect_to(address_, deadline));
    } catch (const std::runtime_error& error) {
      throw ServiceLost(
          fmt::format("{}: start the launcher again; the application draws by itself", error.what()));
    }
    const Message welcome = conversation([&] {
      connection_->send(MessageType::hello_client, ++sequence_, Bytes{}, deadline);
      if (!wait_until_ready(connection_->fd(), POLLIN, deadline))
        throw ConnectionLost(fmt::format("was not there within {} ms", patience_.connect.count()));
      return connection_->receive(Clock::now() + patience_.reply);
    });
    if (welcome.type == MessageType::refused)
      conversation([&] { throw ConnectionLost("cannot serve: " + decode_text(welcome.payload)); });
    if (welcome.type != MessageType::welcome) lose("answered out of turn");
    ranks_ = conversation([&] { return decode_hello(welcome.payload).ranks; });
  }

  void begin_volume(const volume::VolumeDescription& volume) override {
    request(MessageType::begin_volume, encode(volume), patience_.reply);
  }

  void add_slices(volume::VolumeId id, int first_slice, int slices,
                  std::span<const std::byte> texels) override {
    if (slices <= 0 || texels.size() % std::size_t(slices) != 0)
      throw RequestRefused(fmt::format("{} bytes are not {} slices of volume {}", texels.size(), slices, id));
    const std::size_t slice_bytes = texels.size() / std::size_t(slices);
    if (slice_bytes > limits::max_slice_bytes)
      throw RequestRefused(
          fmt::format("a slice of {} bytes is over the limit of {}", slice_bytes, limits::max_slice_bytes));
    const int together = int(std::clamp<std::uint64_t>(
        limits::max_slab_bytes / std::max<std::size_t>(1, slice_bytes), 1, std::uint64_t(slices)));
    for (int done = 0; done < slices; done += together) {
      const int now = std::min(together, slices - done);
      const Slices slab{id, first_slice + done, now,
                        texels.subspan(std::size_t(done) * slice_bytes, std::size_t(now) * slice_bytes)};
      static constexpr std::array<std::byte, 8> padding{};
      const auto head = encode_slices_head(slab);
      const std::array<Bytes, 3> parts{head, slab.texels,
                                       Bytes(padding).first((8 - slab.texels.size() % 8) % 8)};
      request(MessageType::add_slices, parts, patience_.reply);
    }
  }

  void end_volume(volume::VolumeId id) override {
    request(MessageType::end_volume, encode_id(id), patience_.reply);
  }

  void forget_volume(volume::VolumeId id) override {
    request(MessageType::forget_volume, encode_id(id), patience_.reply);
  }

  Rendered render(const volume::RenderRequest& wanted) override {
    make_room(wanted.window);
    const Message reply = request(MessageType::render, encode(wanted), patience_.render, MessageType::rendered);
    const RenderedReply rendered = conversation([&] { return decode_rendered(reply.payload); });
    const std::size_t floats = 4 * rendered.rect.pixels();
    // An empty picture needs no place in the window.
    if (floats > image_.floats().size() ||
        (floats > 0 && intersection(rendered.rect, wanted.window) != rendered.rect))
      lose("answered with a picture that does not fit the window");
    return {{rendered.rect, image_.floats().first(floats)}, rendered.counts};
  }

  int nodes() const override { return ranks_; }

 private:
  // Pictures never get larger than the window, so the memory is made once per size of window.
  void make_room(const volume::Rect& window) {
    if (window.pixels() > limits::max_window_pixels)
      throw RequestRefused(fmt::format("a picture of {} pixels is over the limit of {}", window.pixels(),
                                       limits::max_window_pixels));
    const std::uint64_t bytes = window.pixels() * 4 * sizeof(float);
    if (bytes <= image_.bytes()) return;
    image_ = {};  // the old one goes first: the picture in it is given up by this call
    ImageMemory fresh;
    try {
      fresh = ImageMemory::create(bytes);
    } catch (const std::runtime_error& error) {
      throw RequestRefused(error.what());
    }
    const std::vector<std::byte> size = encode_size(bytes);
    const Bytes payload(size);
    request(MessageType::image_memory, {&payload, 1}, patience_.reply, MessageType::done, fresh.fd());
    fresh.close_descriptor();
    image_ = std::move(fresh);  // both sides have it
  }

  Message request(MessageType type, const std::vector<std::byte>& payload, milliseconds patience,
                  MessageType expected = MessageType::done) {
    const Bytes part(payload);
    return request(type, {&part, 1}, patience, expected);
  }

  // One request and its one reply.
  Message request(MessageType type, std::span<const Bytes> parts, milliseconds patience,
                  MessageType expected = MessageType::done, int attach = -1) {
    if (!connection_) throw ServiceLost(lost_);
    if (::getpid() != process_)
      throw ServiceLost("the link to the node group belongs to the process before fork()");
    Message reply = conversation([&] {
      connection_->send(type, ++sequence_, parts, Clock::now() + patience_.send, attach);
      return connection_->receive(Clock::now() + patience);
    });
    if (reply.sequence != sequence_) lose("answered another request");
    if (reply.type == MessageType::refused)
      throw RequestRefused(conversation([&] { return decode_text(reply.payload); }));
    if (reply.type != expected) lose("answered out of turn");
    return reply;
  }

  // Whatever goes wrong while talking ends the conversation for good: a late answer must not be taken for the
  // next.
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
  int ranks_ = 0;
  pid_t process_ = ::getpid();
  ImageMemory image_;
};

}  // namespace

std::unique_ptr<RenderService> linked_service(const std::string& address, const Patience& patience) {
  return std::make_unique<LinkedService>(address, patience);
}

std::unique_ptr<RenderService> linked_service(const std::string& address, int patience_ms) {
  Patience patience;
  patience.connect = milliseconds(patience_ms);
  return linked_service(address, patience);
}

}  // namespace understudy::compositor
