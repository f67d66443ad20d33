#include "compositor/node/node.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <exception>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "compositor/crop.h"
#include "compositor/node/clients.h"
#include "compositor/node/compositing.h"
#include "compositor/node/image_buffer.h"
#include "compositor/node/opaque_tiles.h"
#include "compositor/node/overlap.h"
#include "compositor/node/rebalancer.h"
#include "compositor/service.h"
#include "compositor/service/integral_parts.h"
#include "compositor/service/limits.h"
#include "compositor/service/load_protocol.h"
#include "compositor/service/loads.h"
#include "compositor/service/protocol.h"
#include "compositor/service/rank_renderer.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/request.h"

namespace understudy::compositor {

namespace {

enum class Step : std::uint32_t { end, forget_client, share_memory, request, texels };

// What rank 0 broadcasts before anything else. A request's payload follows as the application sent it; of
// texels their boxes follow, and then to each rank what it shows of them.
struct Order {
  Step step = Step::end;
  MessageType type{};
  std::uint64_t client = 0;
  std::uint64_t payload_bytes = 0;
  volume::VolumeId volume = 0;
  std::uint64_t boxes = 0;
  bool overlapped = false;  ///< an image is composited while it is drawn
};

// What every rank tells every other about its part in a request.
struct Outcome {
  bool refused = false;
  volume::Rect footprint;
  volume::FrameCounts counts;
  std::uint32_t control_messages = 0;  ///< of opaque tiles, to every rank behind
  std::uint64_t control_message_count = 0, control_bytes = 0;
  RankLoad load;
};

using Reason = std::array<char, limits::max_text_bytes>;  // ends with a zero

// This rank's, with what others want to know only of the first that refused.
struct OwnOutcome : Outcome {
  Reason reason{};

  void refuse(const char* why) {
    refused = true;
    std::strncpy(reason.data(), why, reason.size() - 1);
  }
};

class Node {
 public:
  Node(Communicator& communicator, const ExchangeSettings& exchange,
       const volume::BrickRendererFactory& make_renderer, const BalanceSettings& balance,
       const volume::ReadableFiles& files, const ClientLimits& limits)
      : communicator_(communicator),
        renderer_(communicator.rank(), communicator.size(), make_renderer, limits),
        loads_(renderer_, communicator.rank(), files),
        memories_(communicator, exchange.gather),
        compositing_(communicator, exchange),
        overlap_(exchange.overlap) {
    if (balance.balance != Balance::off && communicator.size() > 1)
      rebalancer_.emplace(communicator, renderer_, balance);
  }

  bool lead(const std::string& control_path, std::chrono::milliseconds stall_patience);
  void follow();

 private:
  void forget_client(std::uint64_t client);
  void request(Clients& clients, Clients::Request request);
  std::vector<Outcome> texels(const Order& order, std::span<volume::TexelBox> boxes, Bytes here);
  bool make_room(std::uint64_t bytes);
  bool receive_payload(const Order& order, std::span<std::byte> here);
  void receive_shares(VolumeKey key, std::span<const volume::TexelBox> boxes);
  void send_shares(VolumeKey key, std::span<const volume::TexelBox> boxes, Bytes texels);
  std::vector<Outcome> perform(const Order& order, Bytes payload);
  void begin_image(std::uint64_t client);
  void draw(OwnOutcome& mine);
  void draw_in_bands(OwnOutcome& mine);
  void clear_hidden(std::vector<Outcome>& outcomes);
  std::vector<Outcome> agree(const OwnOutcome& mine, const std::optional<VolumeKey>& filling);
  std::optional<volume::Rect> composite(const std::vector<Outcome>& outcomes, volume::FrameCounts& counts);
  std::vector<volume::PixelIntegral> compose_integrals();
  std::vector<std::uint64_t> sum_histograms();

  Communicator& communicator_;
  RankRenderer renderer_;
  Loads loads_;
  std::optional<Rebalancer> rebalancer_;  // where there is something to balance
  ImageBuffers memories_;
  Compositing compositing_;
  OverlapChoice overlap_;  // rank 0's word counts
  /// By application, and there by place.
  std::map<std::uint64_t, std::array<volume::PreIntegrationTable, limits::max_kept_pre_integration_tables>>
      pre_integration_tables_;
  std::vector<std::byte> payload_space_;  // the same size on all ranks but 0
  std::size_t room_ = 0;                  // that size, known to rank 0 too
  Reason reason_{};                       // of the last refusal
  std::vector<volume::TexelBox> shares_;  // of the texels in hand, this rank's
  // Of the render request in hand.
  VolumeKey rendered_;
  volume::RenderRequest request_;
  ImageTask task_;
  std::vector<volume::Rect> footprints_;  // by rank: what it could show at most
  volume::Rect whole_;                    // what all of them could
  volume::FrameCounts travelled_;         // while the image was drawn
  volume::Image image_;
  std::uint32_t images_ = 0;  // that were asked for, this one too
  std::optional<OpaqueTiles> opaque_tiles_;
  // Of the integrals in hand, this rank's parts; as many elements as pixels were asked for.
  std::vector<IntegralPart> integrals_;
  std::vector<Rank> integral_order_;
  std::size_t integrated_ = 0;            // the first of them are known
  std::vector<std::uint64_t> histogram_;  // in hand, of this rank's cells
};

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

bool is_load(MessageType type) {
  return type == MessageType::load_volume || type == MessageType::continue_load;
}

const Outcome* first_refusal(const std::vector<Outcome>& outcomes) {
  const auto found = std::ranges::find_if(outcomes, &Outcome::refused);
  return found == outcomes.end() ? nullptr : &*found;
}

// Adds up what the ranks did; the time is the slowest rank's.
volume::FrameCounts sum(const std::vector<Outcome>& outcomes) {
  volume::FrameCounts total;
  for (const Outcome& outcome : outcomes) {
    const volume::FrameCounts& counts = outcome.counts;
    total.rays += counts.rays;
    total.rays_terminated += counts.rays_terminated;
    total.samples += counts.samples;
    total.samples_taken += counts.samples_taken;
    total.samples_hidden += counts.samples_hidden;
    total.dominated_samples += counts.dominated_samples;
    total.blocks += counts.blocks;
    total.blocks_empty += counts.blocks_empty;
    total.nodes_idle += outcome.footprint.empty();
    total.render_ms = std::max(total.render_ms, counts.render_ms);
  }
  return total;
}

bool Node::lead(const std::string& control_path, std::chrono::milliseconds stall_patience) {
  std::optional<Clients> clients;
  try {
    clients.emplace(control_path, communicator_.size(), stall_patience);
  } catch (const std::runtime_error& error) {
    fmt::print(stderr, "understudy-node: no launcher: {}\n", error.what());
  }
  while (clients) {
    Clients::Event event = clients->next();
    if (std::holds_alternative<Clients::Ended>(event)) break;
    if (auto* asked = std::get_if<Clients::Request>(&event)) {
      request(*clients, std::move(*asked));
    } else if (auto* given = std::get_if<Clients::MemoryGiven>(&event)) {
      Order order{.step = Step::share_memory, .client = given->client};
      communicator_.broadcast(0, bytes_of(order));
      memories_.share(order.client, std::move(given->memory));
    } else {
      Order order{.step = Step::forget_client, .client = std::get<Clients::Departed>(event).client};
      communicator_.broadcast(0, bytes_of(order));
      forget_client(order.client);
    }
  }
  Order order{.step = Step::end};
  communicator_.broadcast(0, bytes_of(order));
  return clients.has_value();
}

void Node::follow() {
  for (;;) {
    Order order;
    communicator_.broadcast(0, bytes_of(order));
    if (order.step == Step::end) return;
    if (order.step == Step::forget_client) {
      forget_client(order.client);
      continue;
    }
    if (order.step == Step::share_memory) {
      memories_.share(order.client, {});
      continue;
    }
    if (order.step == Step::texels) {
      std::vector<volume::TexelBox> boxes(order.boxes);
      texels(order, boxes, {});
      continue;
    }
    if (!receive_payload(order, {})) continue;
    const std::vector<Outcome> outcomes = perform(order, Bytes(payload_space_).first(order.payload_bytes));
    if (first_refusal(outcomes)) continue;
    if (order.type == MessageType::render && !order.overlapped) {
      volume::FrameCounts counts;
      composite(outcomes, counts);
    }
    if (order.type == MessageType::integrals) compose_integrals();
    if (order.type == MessageType::histogram) sum_histograms();
  }
}

void Node::forget_client(std::uint64_t client) {
  loads_.forget_client(client);
  if (rebalancer_) rebalancer_->forget_client(client);
  renderer_.forget_client(client);
  memories_.forget_client(client);
  pre_integration_tables_.erase(client);
}

// Memory for that much of a payload. False, on all ranks, when one of them has none.
bool Node::make_room(std::uint64_t bytes) {
  // All ranks have seen the same orders, so they agree on when there must be more room; only then they must
  // also agree on whether there is.
  if (bytes <= room_) return true;
  std::uint8_t fits = 1;
  try {
    if (communicator_.rank() != 0) payload_space_.resize(bytes);
  } catch (const std::bad_alloc&) {
    fits = 0;
  }
  std::vector<std::uint8_t> all(std::size_t(communicator_.size()));
  communicator_.gather_to_all(bytes_of(fits), std::as_writable_bytes(std::span(all)));
  if (std::ranges::count(all, 0) > 0) return false;
  room_ = bytes;
  return true;
}

// Broadcasts the payload that is `here` on rank 0. False, on all ranks, when one of them has no room for it.
bool Node::receive_payload(const Order& order, std::span<std::byte> here) {
  if (!make_room(order.payload_bytes)) return false;
  communicator_.broadcast(
      0, communicator_.rank() == 0 ? here : std::span(payload_space_).first(order.payload_bytes));
  return true;
}

// Texels that are `here` on rank 0 go to the ranks that show them.
std::vector<Outcome> Node::texels(const Order& order, std::span<volume::TexelBox> boxes, Bytes here) {
  communicator_.broadcast(0, std::as_writable_bytes(boxes));
  const VolumeKey key{order.client, order.volume};
  OwnOutcome mine;
  try {
    renderer_.check_texels(key, boxes, order.payload_bytes);
  } catch (const std::exception& error) {
    mine.refuse(error.what());  // on all ranks
    return agree(mine, key);
  }
  if (!make_room(order.payload_bytes)) {
    mine.refuse("a node has no memory left for this message");
    return agree(mine, key);
  }
  try {
    if (communicator_.rank() == 0) {
      send_shares(key, boxes, here);
    } else {
      receive_shares(key, boxes);
    }
    if (rebalancer_) rebalancer_->texels_changed(key, renderer_.description(key), boxes);
    renderer_.add_texels(key, shares_, payload_space_);
  } catch (const RequestRefused& error) {
    mine.refuse(error.what());
  }
  return agree(mine, key);
}

std::size_t bytes_of_boxes(std::span<const volume::TexelBox> boxes, std::size_t bytes_per_texel) {
  std::size_t texels = 0;
  for (const volume::TexelBox& box : boxes) texels += volume::texels_in(box);
  return texels * bytes_per_texel;
}

void Node::receive_shares(VolumeKey key, std::span<const volume::TexelBox> boxes) {
  shares_ = renderer_.shares(key, boxes, communicator_.rank());
  const std::size_t bytes = bytes_of_boxes(shares_, renderer_.bytes_per_texel(key));
  if (bytes == 0) return;
  const Incoming share{0, std::span(payload_space_).first(bytes)};
  communicator_.transfer({}, {&share, 1});
}

void Node::send_shares(VolumeKey key, std::span<const volume::TexelBox> boxes, Bytes texels) {
  const std::size_t texel = renderer_.bytes_per_texel(key);
  std::vector<std::vector<std::byte>> packed(std::size_t(communicator_.size()));
  std::vector<Outgoing> outgoing;
  for (Rank rank = 0; rank < communicator_.size(); ++rank) {
    const std::vector<volume::TexelBox> shares = renderer_.shares(key, boxes, rank);
    std::vector<std::byte>& bytes = packed[std::size_t(rank)];
    bytes.resize(bytes_of_boxes(shares, texel));
    std::span<std::byte> room(bytes);
    Bytes left = texels;
    auto share = shares.begin();
    for (const volume::TexelBox& box : boxes) {
      if (share != shares.end() && volume::contains(box, *share)) {
        volume::copy_texels(*share, texel, box, left, *share, room);
        room = room.subspan(bytes_of_boxes({&*share, 1}, texel));
        ++share;
      }
      left = left.subspan(bytes_of_boxes({&box, 1}, texel));
    }
    if (rank == 0) {
      shares_ = shares;
    } else if (!bytes.empty()) {
      outgoing.push_back({rank, bytes});
    }
  }
  communicator_.transfer(outgoing, {});
  payload_space_ = std::move(packed[0]);
}

void Node::request(Clients& clients, Clients::Request request) {
  if (request.message.type == MessageType::add_texels) {
    Texels message;
    try {
      message = decode_texels(request.message.payload);
    } catch (const MalformedMessage& error) {
      return clients.reply(request, MessageType::refused, encode_text(error.what()));
    }
    Order order{.step = Step::texels,
                .type = request.message.type,
                .client = request.client,
                .payload_bytes = message.texels.size(),
                .volume = message.volume,
                .boxes = message.boxes.size()};
    communicator_.broadcast(0, bytes_of(order));
    const std::vector<Outcome> outcomes = texels(order, message.boxes, message.texels);
    if (first_refusal(outcomes))
      return clients.reply(request, MessageType::refused, encode_text(reason_.data()));
    return clients.reply(request, MessageType::done, {});
  }
  const auto start = Clock::now();
  Order order{
      .step = Step::request,
      .type = request.message.type,
      .client = request.client,
      .payload_bytes = request.message.payload.size(),
      .overlapped = request.message.type == MessageType::render && communicator_.size() > 1 && overlap_.next()};
  communicator_.broadcast(0, bytes_of(order));
  if (!receive_payload(order, request.message.payload))
    return clients.reply(request, MessageType::refused,
                         encode_text("a node has no memory left for this message"));

  const std::vector<Outcome> outcomes = perform(order, request.message.payload);
  if (first_refusal(outcomes)) return clients.reply(request, MessageType::refused, encode_text(reason_.data()));
  if (is_load(order.type)) {
    std::vector<RankLoad> loads;
    loads.reserve(outcomes.size());
    for (const Outcome& outcome : outcomes) loads.push_back(outcome.load);
    return clients.reply(request, MessageType::loading, encode(loads));
  }
  if (order.type == MessageType::integrals)
    return clients.reply(request, MessageType::integrated, encode(compose_integrals()));
  if (order.type == MessageType::histogram)
    return clients.reply(request, MessageType::counted, encode_histogram(sum_histograms()));
  if (order.type != MessageType::render) return clients.reply(request, MessageType::done, {});

  RenderedReply rendered;
  volume::FrameCounts& counts = rendered.counts;
  counts = sum(outcomes);
  std::optional<volume::Rect> rect = whole_;
  if (order.overlapped) {
    counts.bytes_exchanged += travelled_.bytes_exchanged;
    counts.messages += travelled_.messages;
    counts.composite_ms = std::max(0.0, milliseconds_since(start) - counts.render_ms);
  } else {
    const auto drawn = Clock::now();
    rect = composite(outcomes, counts);
    counts.composite_ms = milliseconds_since(drawn);
  }
  if (!rect)
    return clients.reply(request, MessageType::refused, encode_text("there is no image buffer for this image"));
  compositing_.add_cost_of_whole_windows(task_, memories_.of(task_.client), counts);
  overlap_.took(order.overlapped, counts.samples, milliseconds_since(start), counts.composite_ms);
  rendered.rect = *rect;
  clients.reply(request, MessageType::rendered, encode(rendered));
}

// This rank's part of a request, and what became of the parts of all ranks.
std::vector<Outcome> Node::perform(const Order& order, Bytes payload) {
  OwnOutcome mine;
  std::optional<VolumeKey> filling;  // the volume whose texels this order concerns
  if (order.type == MessageType::render) compositing_.prepare();
  try {
    switch (order.type) {
      case MessageType::begin_volume: {
        const volume::VolumeDescription description = decode_volume(payload);
        filling = VolumeKey{order.client, description.id};
        loads_.forget(*filling);
        if (rebalancer_) rebalancer_->forget(*filling);
        renderer_.begin(order.client, description);
        break;
      }
      case MessageType::begin_change: {
        const Change change = decode_change(payload);
        filling = VolumeKey{order.client, change.volume};
        renderer_.begin_change(*filling, change.version);
        break;
      }
      case MessageType::end_volume:
        filling = VolumeKey{order.client, decode_id(payload)};
        // A slice range's worth of memory is not needed again soon.
        payload_space_ = {};
        room_ = 0;
        renderer_.end(*filling);
        break;
      case MessageType::forget_volume: {
        const VolumeKey key{order.client, decode_id(payload)};
        loads_.forget(key);
        if (rebalancer_) rebalancer_->forget(key);
        renderer_.forget(key);
        break;
      }
      case MessageType::load_volume: {
        const LoadRequest load = decode_load_request(payload);
        filling = VolumeKey{order.client, load.volume.id};
        if (rebalancer_) rebalancer_->forget(*filling);
        loads_.begin(*filling, load);
        mine.load = loads_.figures(*filling);
        break;
      }
      case MessageType::continue_load: {
        const VolumeKey key{order.client, decode_id(payload)};
        if (loads_.knows(key)) filling = key;
        loads_.read_on(key);
        mine.load = loads_.figures(key);
        break;
      }
      case MessageType::pre_integration_table: {
        KeptPreIntegrationTable kept = decode_pre_integration_table(payload);
        pre_integration_tables_[order.client][std::size_t(kept.place)] = std::move(kept.table);
        break;
      }
      case MessageType::render: {
        ++images_;
        opaque_tiles_.reset();
        const auto decode = [&] { return decode_request(payload, pre_integration_tables_[order.client]); };
        request_ = rebalancer_ ? rebalancer_->before_image(order.client, decode) : decode();
        begin_image(order.client);
        if (!order.overlapped) draw(mine);
        break;
      }
      case MessageType::integrals: {
        const IntegralQuestion question = decode_integral_question(payload);
        integral_order_ = renderer_.visibility_order(order.client, question.request);
        integrals_ = renderer_.integrals(order.client, question.request, question.pixels, question.most_ms);
        integrated_ = integrals_.size();
        integrals_.resize(question.pixels.size());
        break;
      }
      case MessageType::histogram: {
        const HistogramQuestion question = decode_histogram_question(payload);
        histogram_ = renderer_.histogram({order.client, question.volume}, question.bins);
        break;
      }
      default:
        throw MalformedMessage("an application does not send this type of message");
    }
  } catch (const std::exception& error) {
    mine.refuse(error.what());
  }
  if (order.overlapped) draw_in_bands(mine);
  std::vector<Outcome> outcomes = agree(mine, filling);
  if (order.type == MessageType::render && !first_refusal(outcomes)) clear_hidden(outcomes);
  if (order.type == MessageType::render && !first_refusal(outcomes)) loads_.drew(rendered_, mine.counts);
  if (rebalancer_ && order.type == MessageType::render && !first_refusal(outcomes)) {
    std::vector<RankWork> work;
    work.reserve(outcomes.size());
    for (const Outcome& outcome : outcomes)
      work.push_back({outcome.counts.render_ms, outcome.counts.samples_taken});
    rebalancer_->after_image(rendered_, work);
  }
  const auto done = [](const Outcome& outcome) { return !outcome.refused && outcome.load.done(); };
  if (is_load(order.type) && std::ranges::all_of(outcomes, done)) loads_.complete(*filling);
  return outcomes;
}

// What all ranks know of the image before they draw it.
void Node::begin_image(std::uint64_t client) {
  renderer_.begin_image();
  rendered_ = {client, request_.volume};
  task_ = {client,
           request_.op,
           intersection(request_.window, request_.viewport),
           compositing_.layout(request_.may_travel_as_halves),
           request_.optimizations.footprints,
           renderer_.visibility_order(client, request_)};
  footprints_ = renderer_.footprints(client, request_);
  whole_ = task_.window;
  if (!task_.only_footprints) return;
  whole_ = {};
  for (const volume::Rect& footprint : footprints_) whole_ = bounding(whole_, footprint);
}

void Node::draw(OwnOutcome& mine) {
  if (communicator_.size() > 1 && task_.only_footprints && volume::can_occlude(request_))
    opaque_tiles_.emplace(communicator_, images_, request_, task_.order, footprints_);
  image_ = renderer_.render(task_.client, request_, mine.counts, opaque_tiles_ ? &*opaque_tiles_ : nullptr);
  mine.footprint = image_.rect;
  if (!opaque_tiles_) return;
  mine.control_messages = opaque_tiles_->tell_rest();
  mine.control_message_count = opaque_tiles_->messages();
  mine.control_bytes = opaque_tiles_->bytes();
}

// Whatever becomes of this rank's part, the others wait for its word on every band until all have given up.
void Node::draw_in_bands(OwnOutcome& mine) {
  const ImageBuffers::Memory& memory = memories_.of(task_.client);
  if (!mine.refused && 4 * whole_.pixels() > memory.floats)
    mine.refuse("there is no image buffer for this image");
  if (mine.refused) return refuse_to_draw(communicator_);
  travelled_ = {};
  const auto draw_band = [&](const volume::Rect& band) -> std::optional<volume::Image> {
    if (mine.refused) return std::nullopt;
    try {
      volume::FrameCounts counts;
      volume::Image image = renderer_.render(task_.client, request_, counts, nullptr, band);
      mine.footprint = bounding(mine.footprint, image.rect);
      // The blocks are those of the whole image each time.
      counts.blocks -= mine.counts.blocks;
      counts.blocks_empty -= mine.counts.blocks_empty;
      mine.counts += counts;
      return image;
    } catch (const std::exception& error) {
      mine.refuse(error.what());
      return std::nullopt;
    }
  };
  draw_and_composite(communicator_, compositing_, task_, memory, whole_, draw_band, travelled_);
}

// What this rank has drawn behind opaque tiles of others, before it heard of them, must not change footprints:
// the image would depend on when control messages came.
void Node::clear_hidden(std::vector<Outcome>& outcomes) {
  if (std::ranges::all_of(outcomes, [](const Outcome& outcome) { return outcome.control_messages == 0; }))
    return;
  std::vector<std::uint32_t> control_messages;
  control_messages.reserve(outcomes.size());
  for (const Outcome& outcome : outcomes) control_messages.push_back(outcome.control_messages);
  opaque_tiles_->clear_hidden(image_, control_messages);
  crop_to_content(image_, task_.op);
  std::vector<volume::Rect> footprints(outcomes.size());
  communicator_.gather_to_all(bytes_of(image_.rect), std::as_writable_bytes(std::span(footprints)));
  for (std::size_t rank = 0; rank < outcomes.size(); ++rank) outcomes[rank].footprint = footprints[rank];
}

// What became of the parts of all ranks. A volume that one rank could not take in is of no use on the others.
std::vector<Outcome> Node::agree(const OwnOutcome& outcome, const std::optional<VolumeKey>& filling) {
  Outcome mine = outcome;
  std::vector<Outcome> outcomes(std::size_t(communicator_.size()));
  communicator_.gather_to_all(bytes_of(mine), std::as_writable_bytes(std::span(outcomes)));
  const Outcome* const refusal = first_refusal(outcomes);
  if (refusal == nullptr) return outcomes;
  reason_ = outcome.reason;
  communicator_.broadcast(Rank(refusal - outcomes.data()), bytes_of(reason_));
  if (filling) {
    loads_.forget(*filling);
    if (rebalancer_) rebalancer_->forget(*filling);
    renderer_.forget(*filling);
  }
  return outcomes;
}

// The image goes to the application's memory; returns where its pixels lie in the window, or nothing, on all
// ranks, when there is no room for them. Adds to the counts, on rank 0, what travelled.
std::optional<volume::Rect> Node::composite(const std::vector<Outcome>& outcomes, volume::FrameCounts& counts) {
  std::vector<volume::Rect> footprints;
  footprints.reserve(outcomes.size());
  for (const Outcome& outcome : outcomes) footprints.push_back(outcome.footprint);
  if (communicator_.rank() == 0) {
    for (const Outcome& outcome : outcomes) {
      counts.bytes_exchanged += outcome.control_bytes;
      counts.messages += outcome.control_message_count;
    }
  }
  return compositing_.composite(task_, std::move(image_), footprints, memories_.of(task_.client), counts);
}

// The whole integrals, from the parts of all ranks.
std::vector<volume::PixelIntegral> Node::compose_integrals() {
  const auto ranks = std::size_t(communicator_.size());
  std::vector<std::uint64_t> known(ranks);
  std::uint64_t mine = integrated_;
  communicator_.gather_to_all(bytes_of(mine), std::as_writable_bytes(std::span(known)));
  const std::size_t pixels = std::ranges::min(known);
  if (pixels == 0) return {};
  std::vector<IntegralPart> all(ranks * pixels);
  communicator_.gather_to_all(std::as_bytes(std::span(integrals_).first(pixels)),
                              std::as_writable_bytes(std::span(all)));
  std::vector<std::vector<IntegralPart>> parts;
  for (auto part = all.begin(); part != all.end(); part += std::ptrdiff_t(pixels))
    parts.emplace_back(part, part + std::ptrdiff_t(pixels));
  return composed_integrals(parts, integral_order_);
}

// Of the whole volume, from the parts of all ranks.
std::vector<std::uint64_t> Node::sum_histograms() {
  const std::size_t bins = histogram_.size();
  std::vector<std::uint64_t> all(std::size_t(communicator_.size()) * bins);
  communicator_.gather_to_all(std::as_bytes(std::span(histogram_)), std::as_writable_bytes(std::span(all)));
  std::vector<std::uint64_t> sums(bins);
  for (std::size_t i = 0; i < all.size(); ++i) sums[i % bins] += all[i];
  return sums;
}

}  // namespace

bool run_node(Communicator& communicator, const std::string& control_path,
              std::chrono::milliseconds stall_patience, const ExchangeSettings& exchange,
              const volume::BrickRendererFactory& make_renderer, const BalanceSettings& balance,
              const volume::ReadableFiles& files, const ClientLimits& limits) {
  Node node(communicator, exchange, make_renderer, balance, files, limits);
  if (communicator.rank() == 0) return node.lead(control_path, stall_patience);
  node.follow();
  return true;
}

}  // namespace understudy::compositor
