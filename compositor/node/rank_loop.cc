// SPDX-License-Identifier: Apache-2.0
#include "compositor/node/rank_loop.h"

#include <fmt/format.h>

#include <exception>
#include <stdexcept>
#include <utility>
#include <variant>

#include "compositor/logging/log.h"
#include "compositor/node/image_division.h"
#include "compositor/service.h"
#include "compositor/service/request_message.h"

namespace understudy::compositor {

namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

}  // namespace

bool RankLoop::lead(const std::string& control_path, std::chrono::milliseconds stall_patience) {
  std::optional<Clients> clients;
  try {
    clients.emplace(control_path, communicator_.size(), stall_patience);
  } catch (const std::runtime_error& error) {
    logging::log(logging::Level::error, "no launcher: {}", error.what());
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

void RankLoop::follow() {
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
    if (order.type == NodeMessage::render && !order.overlapped) {
      volume::FrameCounts counts;
      composite(outcomes, counts);
    }
    if (order.type == NodeMessage::integrals) compose_integrals();
    if (order.type == LoadMessage::histogram) sum_histograms();
  }
}

void RankLoop::request(Clients& clients, Clients::Request request) {
  if (request.message.type == NodeMessage::add_texels) {
    Texels message;
    try {
      message = decode_texels(request.message.payload);
    } catch (const MalformedMessage& error) {
      return clients.reply(request, LauncherMessage::refused, encode_text(error.what()));
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
      return clients.reply(request, LauncherMessage::refused, encode_text(reason_.data()));
    return clients.reply(request, NodeMessage::done, {});
  }
  const auto start = Clock::now();
  Order order{
      .step = Step::request,
      .type = request.message.type,
      .client = request.client,
      .payload_bytes = request.message.payload.size(),
      .overlapped = request.message.type == NodeMessage::render && communicator_.size() > 1 && overlap_.next()};
  communicator_.broadcast(0, bytes_of(order));
  if (!receive_payload(order, request.message.payload))
    return clients.reply(request, LauncherMessage::refused,
                         encode_text("a node has no memory left for this message"));

  const std::vector<Outcome> outcomes = perform(order, request.message.payload);
  if (first_refusal(outcomes))
    return clients.reply(request, LauncherMessage::refused, encode_text(reason_.data()));
  if (is_load(order.type)) return reply_to_load(clients, request, outcomes);
  if (order.type == NodeMessage::integrals)
    return clients.reply(request, NodeMessage::integrated, encode(compose_integrals()));
  if (order.type == LoadMessage::histogram)
    return clients.reply(request, LoadMessage::counted, encode_histogram(sum_histograms()));
  if (order.type != NodeMessage::render) return clients.reply(request, NodeMessage::done, {});
  reply_with_image(clients, request, order, outcomes, start);
}

void RankLoop::reply_to_load(Clients& clients, const Clients::Request& request,
                             const std::vector<Outcome>& outcomes) {
  std::vector<RankLoad> loads;
  loads.reserve(outcomes.size());
  for (const Outcome& outcome : outcomes) loads.push_back(outcome.load);
  clients.reply(request, LoadMessage::loading, encode(loads));
}

void RankLoop::reply_with_image(Clients& clients, const Clients::Request& request, const Order& order,
                                const std::vector<Outcome>& outcomes, Clock::time_point start) {
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
    return clients.reply(request, LauncherMessage::refused,
                         encode_text("there is no image buffer for this image"));
  compositing_.add_cost_of_whole_windows(task_, memories_.of(task_.client), counts);
  overlap_.took(order.overlapped, counts.samples, milliseconds_since(start), counts.composite_ms);
  rendered.rect = *rect;
  clients.reply(request, NodeMessage::rendered, encode(rendered));
}

// Performs this rank's part of a request; returns the outcomes of all ranks.
std::vector<Outcome> RankLoop::perform(const Order& order, Bytes payload) {
  OwnOutcome mine;
  const bool renders = order.type == NodeMessage::render;
  if (renders) compositing_.prepare();
  try {
    perform_own_part(order, payload, mine);
  } catch (const std::exception& error) {
    mine.refuse(error.what());
  }
  if (order.overlapped) draw_in_bands(mine);
  std::vector<Outcome> outcomes = agree(mine);
  if (renders && !first_refusal(outcomes)) after_image(mine, outcomes);
  const bool begins = order.type == NodeMessage::begin_volume || order.type == LoadMessage::load_volume;
  if (begins && !first_refusal(outcomes)) find_bricks(*mine.filling, outcomes);
  const auto done = [](const Outcome& outcome) { return !outcome.refused && outcome.load.done(); };
  if (is_load(order.type) && std::ranges::all_of(outcomes, done)) {
    loads_.complete(*mine.filling);
    all_agree(communicator_, true);  // from here on ranks may read bricks that others keep
  }
  return outcomes;
}

void RankLoop::perform_own_part(const Order& order, Bytes payload, OwnOutcome& mine) {
  if (const auto message = order.type.as<LoadMessage>()) return load(*message, order, payload, mine);
  const auto message = order.type.as<NodeMessage>();
  if (!message) throw MalformedMessage("an application does not send this type of message");
  switch (*message) {
    case NodeMessage::pre_integration_table: {
      KeptPreIntegrationTable kept = decode_pre_integration_table(payload);
      pre_integration_tables_[order.client][std::size_t(kept.place)] = std::move(kept.table);
      break;
    }
    case NodeMessage::render:
      begin_request(order, payload, mine);
      if (!order.overlapped) draw(mine);
      break;
    case NodeMessage::integrals:
      integrate(order, payload);
      break;
    default:
      take_volume(*message, order, payload, mine);
  }
}

void RankLoop::integrate(const Order& order, Bytes payload) {
  const IntegralQuestion question = decode_integral_question(payload);
  integral_order_ = renderer_.visibility_order(order.client, question.request);
  integrals_ = renderer_.integrals(order.client, question.request, question.pixels, question.most_ms);
  integrated_ = integrals_.size();
  integrals_.resize(question.pixels.size());
}

// Exchanges the outcomes of all ranks. A volume that one rank could not receive is dropped on all.
std::vector<Outcome> RankLoop::agree(const OwnOutcome& outcome) {
  Outcome mine = outcome;
  std::vector<Outcome> outcomes(std::size_t(communicator_.size()));
  communicator_.gather_to_all(bytes_of(mine), std::as_writable_bytes(std::span(outcomes)));
  const Outcome* const refusal = first_refusal(outcomes);
  if (refusal == nullptr) return outcomes;
  reason_ = outcome.reason;
  communicator_.broadcast(Rank(refusal - outcomes.data()), bytes_of(reason_));
  if (outcome.filling) {
    loads_.forget(*outcome.filling);
    if (rebalancer_) rebalancer_->forget(*outcome.filling);
    renderer_.forget(*outcome.filling);
  }
  return outcomes;
}

}  // namespace understudy::compositor
