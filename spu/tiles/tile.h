// SPDX-License-Identifier: Apache-2.0
// The tile unit, used by tile workers: the process draws one tile of each window, and plays the stream that it
// gets from the process which serves the application (tiles.h).
#pragma once

#include <atomic>
#include <cstdint>

#include "spu/stream/begin_and_end.h"
#include "spu/tiles/tile_scissor.h"
#include "spu/unit_description.h"
#include "spu/window_system/window_system.h"

namespace understudy::spu {

class Tile final : public Unit {
 public:
  static constexpr char tag = '-';

  Tile(Chain& chain, std::atomic<bool>& lists_touch_scissor, int part, int parts);

  const char* tag_address() const override { return &tag; }
  void fill(Phase phase, DispatchTable& table) override;

  /// The context is current with a drawable of this extent. Must be called after every change of either.
  void place(Extent2D extent);
  /// The rows of this tile in the current drawable.
  Rows rows() const { return rows_of_tile(extent_.height, part_, parts_); }
  Extent2D extent() const { return extent_; }

  std::uint64_t call(CallId call, const std::uint64_t* words);

 private:
  Chain& chain_;
  const int part_;
  const int parts_;
  TileScissor scissor_;
  Extent2D extent_;
  bool placed_ = false;
  bool divides_ = false;     ///< result of window_divides()
  bool restricted_ = false;  ///< true while a draw is restricted, also from glBegin to glEnd
  BeginAndEnd begin_and_end_;
};

extern const UnitDescription tile_description;

}  // namespace understudy::spu
