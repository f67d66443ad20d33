// SPDX-License-Identifier: Apache-2.0
#include "spu/tiles/tile.h"

#include <string>
#include <utility>

#include "dispatch/call_words.h"
#include "spu/shared_by_file.h"
#include "spu/tiles/tile_workers.h"
#include "spu/tiles/tiles.h"
#include "spu/tiles/window_use.h"

namespace understudy::spu {
namespace {

struct Drawn {
  static std::uint64_t call(CallId call, const std::uint64_t* words) {
    return Chain::current()->find<Tile>()->call(call, words);
  }
};

/// Shared by all contexts: a tile worker draws for one application, whose contexts may share display lists.
struct CompiledCalls {
  explicit CompiledCalls(const std::string&) {}
  std::atomic<bool> touch_scissor = false;
};

constexpr UnitOption tile_options[] = {{.name = "part",
                                        .type = OptionType::integer,
                                        .fallback = "0",
                                        .low = 0,
                                        .high = most_tiles - 1,
                                        .help = "number of the tile, counted from the lowest"},
                                       {.name = "of",
                                        .type = OptionType::integer,
                                        .fallback = "2",
                                        .low = 2,
                                        .high = most_tiles,
                                        .help = "number of tiles of a window"}};

}  // namespace

Tile::Tile(Chain& chain, std::atomic<bool>& lists_touch_scissor, int part, int parts)
    : chain_(chain), part_(part), parts_(parts), scissor_(lists_touch_scissor) {}

void Tile::fill(Phase, DispatchTable& table) {
  AsWords<Drawn>::fill(table);
}

void Tile::place(Extent2D extent) {
  if (!std::exchange(placed_, true)) divides_ = window_divides(chain_.driver());
  extent_ = extent;
  scissor_.set(extent.width, rows());
}

std::uint64_t Tile::call(CallId call, const std::uint64_t* words) {
  const DispatchTable& next = chain_.below(*this);
  const WindowUse use = window_use(call);
  const bool lists = use == WindowUse::lists;
  if (!begin_and_end_.inside()) {
    scissor_.note(call, words);
    const bool draws = lists || use == WindowUse::draws || use == WindowUse::begins;
    restricted_ = draws && divides_ && scissor_.begin(next, lists);
  }
  const std::uint64_t result = invoke(next, call, words);
  begin_and_end_.follow(call, words);
  if (restricted_ && !begin_and_end_.inside()) {
    scissor_.end(next);
    restricted_ = false;
  }
  if (lists) scissor_.forget();
  return result;
}

constinit const UnitDescription tile_description{
    .name = "tile",
    .help = "draws one tile of every window (in tile workers, see tiles)",
    .options = tile_options,
    .make = [](const UnitPlace& place) -> std::unique_ptr<Unit> {
      return std::make_unique<Tile>(place.chain, shared_by_file<CompiledCalls>("").touch_scissor,
                                    int(place.options.integer("part")), int(place.options.integer("of")));
    }};

}  // namespace understudy::spu
