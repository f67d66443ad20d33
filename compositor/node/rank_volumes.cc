// SPDX-License-Identifier: Apache-2.0
// Receives the texels of volumes.
#include <fmt/format.h>
#include <unistd.h>

#include <exception>
#include <new>
#include <utility>

#include "compositor/node/rank_loop.h"
#include "compositor/service.h"
#include "volume/texel_box.h"

namespace understudy::compositor {

void RankLoop::forget_client(std::uint64_t client) {
  loads_.forget_client(client);
  if (rebalancer_) rebalancer_->forget_client(client);
  renderer_.forget_client(client);
  memories_.forget_client(client);
  pre_integration_tables_.erase(client);
}

// Handles a volume as a whole; its texels are handled by texels() and load().
void RankLoop::take_volume(NodeMessage message, const Order& order, Bytes payload, OwnOutcome& mine) {
  switch (message) {
    case NodeMessage::begin_volume: {
      const volume::VolumeDescription description = decode_volume(payload);
      mine.filling = VolumeKey{order.client, description.id};
      loads_.forget(*mine.filling);
      if (rebalancer_) rebalancer_->begin(*mine.filling);
      renderer_.begin(order.client, description);
      tell_where_bricks_are(*mine.filling, mine);
      break;
    }
    case NodeMessage::begin_change: {
      const Change change = decode_change(payload);
      mine.filling = VolumeKey{order.client, change.volume};
      renderer_.begin_change(*mine.filling, change.version);
      break;
    }
    case NodeMessage::end_volume:
      mine.filling = VolumeKey{order.client, decode_id(payload)};
      // Memory for a slice range is not needed again soon.
      payload_space_ = {};
      room_ = 0;
      renderer_.end(*mine.filling);
      break;
    case NodeMessage::forget_volume: {
      const VolumeKey key{order.client, decode_id(payload)};
      loads_.forget(key);
      if (rebalancer_) rebalancer_->forget(key);
      renderer_.forget(key);
      break;
    }
    default:
      throw MalformedMessage("an application does not send this type of message");
  }
}

void RankLoop::load(LoadMessage message, const Order& order, Bytes payload, OwnOutcome& mine) {
  switch (message) {
    case LoadMessage::load_volume: {
      const LoadRequest wanted = decode_load_request(payload);
      mine.filling = VolumeKey{order.client, wanted.volume.id};
      if (rebalancer_) rebalancer_->forget(*mine.filling);
      loads_.begin(*mine.filling, wanted);
      tell_where_bricks_are(*mine.filling, mine);
      mine.load = loads_.figures(*mine.filling);
      break;
    }
    case LoadMessage::continue_load: {
      const VolumeKey key{order.client, decode_id(payload)};
      if (loads_.knows(key)) mine.filling = key;
      loads_.read_on(key);
      mine.load = loads_.figures(key);
      break;
    }
    case LoadMessage::histogram: {
      const HistogramQuestion question = decode_histogram_question(payload);
      histogram_ = renderer_.histogram({order.client, question.volume}, question.bins);
      break;
    }
    default:
      throw MalformedMessage("an application does not send this type of message");
  }
}

// One of several ranks on a machine that show the same bricks keeps them for all.
void RankLoop::tell_where_bricks_are(VolumeKey key, OwnOutcome& mine) const {
  mine.process = ::getpid();
  mine.descriptor = renderer_.shared_descriptor(key);
}

void RankLoop::find_bricks(VolumeKey key, const std::vector<Outcome>& outcomes) {
  const Arrangement::Place& place = renderer_.arrangement(key).place(communicator_.rank());
  const Outcome& keeper = outcomes[std::size_t(place.keeper)];
  if (keeper.descriptor < 0) return;
  renderer_.find_bricks_at(key, fmt::format("/proc/{}/fd/{}", keeper.process, keeper.descriptor));
}

// Allocates memory for a payload. False, on all ranks, if one of them has none.
bool RankLoop::make_room(std::uint64_t bytes) {
  // All ranks have seen the same orders, so they agree on when more room is needed; only then must they also
  // agree on whether there is any.
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

// Broadcasts the payload, which is `here` on rank 0. False, on all ranks, if one of them has no room for it.
bool RankLoop::receive_payload(const Order& order, std::span<std::byte> here) {
  if (!make_room(order.payload_bytes)) return false;
  communicator_.broadcast(
      0, communicator_.rank() == 0 ? here : std::span(payload_space_).first(order.payload_bytes));
  return true;
}

// Sends texels, which are `here` on rank 0, to the ranks that show them.
std::vector<Outcome> RankLoop::texels(const Order& order, std::span<volume::TexelBox> boxes, Bytes here) {
  communicator_.broadcast(0, std::as_writable_bytes(boxes));
  const VolumeKey key{order.client, order.volume};
  OwnOutcome mine;
  mine.filling = key;
  try {
    renderer_.check_texels(key, boxes, order.payload_bytes);
  } catch (const std::exception& error) {
    mine.refuse(error.what());  // likewise on all ranks
    return agree(mine);
  }
  if (!make_room(order.payload_bytes)) {
    mine.refuse("a node has no memory left for this message");
    return agree(mine);
  }
  try {
    if (communicator_.rank() == 0) {
      send_shares(key, boxes, here);
    } else {
      receive_shares(key, boxes);
    }
    if (rebalancer_) rebalancer_->texels_changed(key, renderer_.description(key), boxes);
    renderer_.texels_change(key, boxes);
    renderer_.add_texels(key, shares_, payload_space_);
  } catch (const RequestRefused& error) {
    mine.refuse(error.what());
  }
  return agree(mine);
}

std::size_t bytes_of_boxes(std::span<const volume::TexelBox> boxes, std::size_t bytes_per_texel) {
  std::size_t texels = 0;
  for (const volume::TexelBox& box : boxes) texels += volume::texels_in(box);
  return texels * bytes_per_texel;
}

void RankLoop::receive_shares(VolumeKey key, std::span<const volume::TexelBox> boxes) {
  shares_ = renderer_.shares(key, boxes, communicator_.rank());
  const std::size_t bytes = bytes_of_boxes(shares_, renderer_.bytes_per_texel(key));
  if (bytes == 0) return;
  const Incoming share{0, std::span(payload_space_).first(bytes)};
  communicator_.transfer({}, {&share, 1});
}

void RankLoop::send_shares(VolumeKey key, std::span<const volume::TexelBox> boxes, Bytes texels) {
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

}  // namespace understudy::compositor
