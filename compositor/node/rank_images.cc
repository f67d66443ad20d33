// SPDX-License-Identifier: Apache-2.0
// Draws a rank's part of an image, and composites the parts.
#include <algorithm>
#include <exception>
#include <new>
#include <utility>

#include "compositor/crop.h"
#include "compositor/node/image_division.h"
#include "compositor/node/processor_clock.h"
#include "compositor/node/rank_loop.h"
#include "compositor/service/request_message.h"
#include "volume/occlusion.h"

namespace understudy::compositor {

void RankLoop::begin_request(const Order& order, Bytes payload, OwnOutcome& mine) {
  ++images_;
  opaque_tiles_.reset();
  leaf_.reset();
  const auto decode = [&] { return decode_request(payload, pre_integration_tables_[order.client]); };
  if (may_divide_images_) return begin_divided_image(order.client, decode, mine);
  request_ = rebalancer_ ? rebalancer_->before_image(order.client, decode) : decode();
  begin_image(order.client);
}

// Nothing that may fail on one rank alone may stand between two collective calls.
void RankLoop::begin_divided_image(std::uint64_t client, const std::function<volume::RenderRequest()>& decode,
                                   OwnOutcome& mine) {
  std::exception_ptr trouble;
  try {
    request_ = decode();
    begin_image(client);
  } catch (...) {
    trouble = std::current_exception();
  }
  const bool agreed = all_agree(communicator_, trouble == nullptr);
  if (trouble) std::rethrow_exception(trouble);
  if (!agreed) {
    leaf_ = volume::Rect{};  // another rank refuses the image
    return;
  }
  const ProcessorClock processors;
  const auto start = std::chrono::steady_clock::now();
  try {
    divide_image(client);
  } catch (const std::bad_alloc&) {
    communicator_.abandon("no memory is left to divide an image: use fewer nodes on a machine, or --sort last");
  }
  mine.counts.division_ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  mine.counts.processor_ms += processors.ms();
}

void RankLoop::divide_image(std::uint64_t client) {
  const Arrangement& arrangement = renderer_.arrangement(rendered_);
  if (arrangement.groups() == 1) return;
  const std::vector<volume::Rect> leaves =
      compositor::divide_image(communicator_, renderer_, client, request_, whole_);
  const auto leaf_of = [&](Rank rank) { return leaves[std::size_t(arrangement.place(rank).group)]; };
  leaf_ = leaf_of(communicator_.rank());
  task_.divided = arrangement.members() == 1;
  for (std::size_t rank = 0; rank < footprints_.size(); ++rank)
    footprints_[rank] = intersection(footprints_[rank], leaf_of(Rank(rank)));
}

// Computes what all ranks know about the image before they draw it.
void RankLoop::begin_image(std::uint64_t client) {
  renderer_.begin_image();
  rendered_ = {client, request_.volume};
  task_ = {client,
           request_.op,
           intersection(request_.window, request_.viewport),
           compositing_.layout(request_),
           request_.optimizations.footprints,
           renderer_.visibility_order(client, request_)};
  footprints_ = renderer_.footprints(client, request_);
  whole_ = task_.window;
  if (!task_.only_footprints) return;
  whole_ = {};
  for (const volume::Rect& footprint : footprints_) whole_ = bounding(whole_, footprint);
}

void RankLoop::draw(OwnOutcome& mine) {
  const ProcessorClock processors;
  if (renderer_.arrangement(rendered_).members() > 1 && task_.only_footprints && volume::can_occlude(request_))
    opaque_tiles_.emplace(communicator_, images_, request_, task_.order, footprints_);
  image_ =
      renderer_.render(task_.client, request_, mine.counts, opaque_tiles_ ? &*opaque_tiles_ : nullptr, leaf_);
  mine.counts.processor_ms += processors.ms();
  mine.footprint = image_.rect;
  if (!opaque_tiles_) return;
  mine.control_messages = opaque_tiles_->tell_rest();
  mine.control_message_count = opaque_tiles_->messages();
  mine.control_bytes = opaque_tiles_->bytes();
}

// Whatever happens to this rank's part, the others wait for its outcome of every band until all have given up.
void RankLoop::draw_in_bands(OwnOutcome& mine) {
  const ImageBuffers::Memory& memory = memories_.of(task_.client);
  if (!mine.refused && 4 * whole_.pixels() > memory.floats)
    mine.refuse("there is no image buffer for this image");
  if (mine.refused) return refuse_to_draw(communicator_);
  travelled_ = {};
  const auto draw_band = [&](const volume::Rect& band) -> std::optional<volume::Image> {
    if (mine.refused) return std::nullopt;
    try {
      volume::FrameCounts counts;
      const ProcessorClock processors;
      volume::Image image =
          renderer_.render(task_.client, request_, counts, nullptr, leaf_ ? intersection(band, *leaf_) : band);
      counts.processor_ms = processors.ms();
      mine.footprint = bounding(mine.footprint, image.rect);
      // Each band counts the blocks of the whole image again.
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

// What this rank has drawn behind opaque tiles of others, before it was told of them, must not change
// footprints: the image would depend on when control messages arrive.
void RankLoop::clear_hidden(std::vector<Outcome>& outcomes) {
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

// All ranks have drawn: clears hidden pixels before compositing, and passes on the measurements of all ranks.
void RankLoop::after_image(const OwnOutcome& mine, std::vector<Outcome>& outcomes) {
  clear_hidden(outcomes);
  loads_.drew(rendered_, mine.counts);
  if (!rebalancer_) return;
  std::vector<RankWork> work;
  work.reserve(outcomes.size());
  for (const Outcome& outcome : outcomes)
    work.push_back({outcome.counts.render_ms, outcome.counts.samples_taken});
  rebalancer_->after_image(rendered_, work);
}

// Composites the image in the image buffer. Returns where its pixels lie in the window; null, on all ranks, if
// the buffer is too small. On rank 0, adds what was sent to `counts`.
std::optional<volume::Rect> RankLoop::composite(const std::vector<Outcome>& outcomes,
                                                volume::FrameCounts& counts) {
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

// Composes the whole integrals from the parts of all ranks.
std::vector<volume::PixelIntegral> RankLoop::compose_integrals() {
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

// Returns the histogram of the whole volume, from the parts of all ranks.
std::vector<std::uint64_t> RankLoop::sum_histograms() {
  const std::size_t bins = histogram_.size();
  std::vector<std::uint64_t> all(std::size_t(communicator_.size()) * bins);
  communicator_.gather_to_all(std::as_bytes(std::span(histogram_)), std::as_writable_bytes(std::span(all)));
  std::vector<std::uint64_t> sums(bins);
  for (std::size_t i = 0; i < all.size(); ++i) sums[i % bins] += all[i];
  return sums;
}

}  // namespace understudy::compositor
