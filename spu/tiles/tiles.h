// SPDX-License-Identifier: Apache-2.0
// The tiles unit of the GL server that serves the application. Every call that reaches it, from the application
// and from the units above, is also played by tile workers (tile_workers.h), and each process draws only the
// rows of its tile of a window (Humphreys et al. 2002, section 5: sort-first with one tile per server).
//
// Framebuffer objects are drawn whole by all processes, because their contents may be used as textures. Pixels
// that are read from a window are assembled from the tiles; before pixels of a window are copied, all processes
// complete it. If an application does something that cannot be assembled, or copies all the time, this process
// draws alone from then on: the current window is completed at once, another window of the same context when it
// is drawn next.
//
// again.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "spu/tiles/tile_scissor.h"
#include "spu/tiles/tile_workers.h"
#include "spu/trace/call_recorder.h"
#include "spu/unit_description.h"
#include "spu/window_system/window_system.h"

namespace understudy::spu {

/// Whether the window of the current context, which has just been created, can be assembled from tiles: one
/// sample per pixel, 8 bits per channel, and a depth format that can be copied.
bool window_divides(const DispatchTable& gl);

class Tiles final : public Unit {
 public:
  static constexpr char tag = '=';

  Tiles(Chain& chain, TileWorkers& tile_workers, int parts);

  const char* tag_address() const override { return &tag; }
  void fill(Phase phase, DispatchTable& table) override;
  void left() override;
  void abandon() override;

  // Called by the player of the stream, for what it knows of contexts beyond their calls.

  /// The words of the `context` event.
  void introduce(std::span<const std::uint64_t> words);
  /// The context is current with this drawable. Must be called after every change of either.
  void place(std::uint64_t drawable, Extent2D extent);
  /// Returns what the window shows, rows from the bottom, RGBA. The context is current.
  std::vector<std::uint8_t> shown_image();

  std::uint64_t call(CallId call, const std::uint64_t* words);

 private:
  std::uint64_t make(CallId call, const std::uint64_t* words, bool restricted);
  std::uint64_t read(CallId call, const std::uint64_t* words);
  void fetch_rows(CallId call, const std::uint64_t* words);
  bool copies_window(CallId call, const std::uint64_t* words) const;
  void make_whole_for_copy();
  void divide();
  void make_whole();
  void stop_dividing();
  bool is_compiling() const { return scissor_.compiling(); }

  Chain& chain_;
  TileWorkers& workers_;
  const int parts_;
  CallRecorder recorder_;
  TileScissor scissor_;
  Records question_;
  std::uint64_t drawable_ = 0;
  Extent2D extent_;
  bool placed_ = false;
  bool divided_ = false;  ///< every process draws only its tile of the window
  bool has_depth_ = false;
  bool making_whole_ = false;  ///< make_whole() is running
  bool restricted_ = false;    ///< true while a draw is restricted, also from glBegin to glEnd
  int copies_ = 0;
  std::uint64_t frames_ = 0;
};

extern const UnitDescription tiles_description;

}  // namespace understudy::spu
