// SPDX-License-Identifier: Apache-2.0
#include "compositor/node/compositing.h"

#include <utility>

#include "compositor/exchange/exchange.h"
#include "compositor/exchange/measure_message_cost.h"
#include "volume/request.h"

namespace understudy::compositor {

Layout Compositing::layout(const volume::RenderRequest& request) const {
  if (request.bound_of) return Layout::rgba32f;
  const Layout layout = request.exact ? Layout::rgba32f : settings_.layout;
  return request.may_travel_as_halves && layout == Layout::rgba32f ? Layout::rgba16f : layout;
}

void Compositing::prepare() {
  if (!message_cost_) message_cost_ = measure_message_cost(communicator_);
}

Schedule Compositing::schedule_of(const ImageTask& task, std::span<const volume::Rect> footprints,
                                  const std::vector<bool>& reached_by) const {
  if (task.divided) {
    Schedule gathered = schedule(Algorithm::serial, task.order, footprints);
    write_gathered(gathered, reached_by);
    return gathered;
  }
  if (!settings_.algorithm) return cheapest(task.order, footprints, task.layout, *message_cost_, reached_by);
  Schedule chosen = schedule(*settings_.algorithm, task.order, footprints);
  write_gathered(chosen, reached_by);
  return chosen;
}

std::optional<volume::Rect> Compositing::composite(const ImageTask& task, volume::Image mine,
                                                   std::span<const volume::Rect> footprints,
                                                   const ImageBuffers::Memory& memory,
                                                   volume::FrameCounts& counts,
                                                   const std::optional<volume::Rect>& whole) {
  Schedule chosen = schedule_of(task, footprints, memory.reached_by);
  if (whole) chosen.whole = *whole;
  if (4 * chosen.whole.pixels() > memory.floats) return std::nullopt;
  chosen.clear_pixels_travel = !task.only_footprints;
  chosen.packed = settings_.packed.value_or(packing_pays(*message_cost_));
  const Exchanged exchanged =
      exchange(std::move(mine), chosen, task.op, task.layout, communicator_, memory.here);
  if (communicator_.rank() == 0) {
    counts.bytes_exchanged += exchanged.bytes;
    counts.messages += cost(chosen, task.layout, MessageCost()).messages;
  }
  return chosen.whole;
}

void Compositing::add_cost_of_whole_windows(const ImageTask& task, const ImageBuffers::Memory& memory,
                                            volume::FrameCounts& counts) {
  if (task.divided) {
    // Footprints save nothing here: a rank has nothing outside its leaf.
    counts.bytes_of_whole_windows += counts.bytes_exchanged;
    counts.messages_of_whole_windows += counts.messages;
    return;
  }
  if (task.window != priced_window_ || task.layout != priced_layout_ ||
      memory.reached_by != priced_reached_by_) {
    const std::vector<volume::Rect> windows(task.order.size(), task.window);
    price_ = cost(schedule_of(task, windows, memory.reached_by), task.layout, MessageCost());
    priced_window_ = task.window;
    priced_layout_ = task.layout;
    priced_reached_by_ = memory.reached_by;
  }
  counts.bytes_of_whole_windows += price_.bytes_sent;
  counts.messages_of_whole_windows += price_.messages;
}

}  // namespace understudy::compositor
