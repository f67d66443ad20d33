#include "compositor/node/compositing.h"

#include <utility>

#include "compositor/exchange/exchange.h"
#include "compositor/exchange/measure_link.h"

namespace understudy::compositor {

Layout Compositing::layout(bool may_travel_as_halves) const {
  return may_travel_as_halves && settings_.layout == Layout::rgba32f ? Layout::rgba16f : settings_.layout;
}

void Compositing::prepare() {
  if (!link_cost_) link_cost_ = measure_link(link_);
}

Schedule Compositing::schedule_of(const PictureTask& task, std::span<const volume::Rect> footprints,
                                  const std::vector<bool>& reached_by) const {
  if (!settings_.algorithm) return cheapest(task.order, footprints, task.layout, *link_cost_, reached_by);
  Schedule chosen = schedule(*settings_.algorithm, task.order, footprints);
  write_home(chosen, reached_by);
  return chosen;
}

std::optional<volume::Rect> Compositing::composite(const PictureTask& task, volume::Image mine,
                                                   std::span<const volume::Rect> footprints,
                                                   const PictureMemories::Memory& memory,
                                                   volume::FrameCounts& counts,
                                                   const std::optional<volume::Rect>& whole) {
  Schedule chosen = schedule_of(task, footprints, memory.reached_by);
  if (whole) chosen.whole = *whole;
  if (4 * chosen.whole.pixels() > memory.floats) return std::nullopt;
  chosen.clear_pixels_travel = !task.only_footprints;
  chosen.packed = settings_.packed.value_or(packing_pays(*link_cost_));
  const Exchanged exchanged = exchange(std::move(mine), chosen, task.op, task.layout, link_, memory.here);
  if (link_.rank() == 0) {
    counts.bytes_exchanged += exchanged.bytes;
    counts.messages += cost(chosen, task.layout, LinkCost()).messages;
  }
  return chosen.whole;
}

void Compositing::add_cost_of_whole_windows(const PictureTask& task, const PictureMemories::Memory& memory,
                                            volume::FrameCounts& counts) {
  if (task.window != priced_window_ || task.layout != priced_layout_ ||
      memory.reached_by != priced_reached_by_) {
    const std::vector<volume::Rect> windows(task.order.size(), task.window);
    price_ = cost(schedule_of(task, windows, memory.reached_by), task.layout, LinkCost());
    priced_window_ = task.window;
    priced_layout_ = task.layout;
    priced_reached_by_ = memory.reached_by;
  }
  counts.bytes_of_whole_windows += price_.bytes_sent;
  counts.messages_of_whole_windows += price_.messages;
}

}  // namespace understudy::compositor
