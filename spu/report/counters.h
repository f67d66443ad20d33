// SPDX-License-Identifier: Apache-2.0
// The counters of a process under Understudy, in memory that outlives the process.
//
// The structure is mapped from a file (RUN_DIR/PID.counters in the launcher's folder), so that a viewer that is
// killed still leaves its figures without a destructor or atexit. One process writes it, with many threads; the
// launcher reads it after the process has ended. Plain data of fixed size without pointers; all-zero bytes mean
// "nothing happened yet".
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <span>
#include <string_view>

#include "spu/report/optimization.h"
#include "volume/frame_counts.h"

namespace understudy::spu {

constexpr std::uint32_t counters_magic = 0x55444334;  // "UDC4"
constexpr int max_counted_volumes = 32;
constexpr int max_counted_reasons = 8;
constexpr int max_counted_done_reasons = 4;
constexpr int max_counted_threads = 64;
constexpr int max_frame_records = 4096;

struct ReasonCount {
  char reason[120];
  std::atomic<std::uint64_t> count;
};

/// `given_up`: the volume is counted in the place of another one.
enum class VolumePlace : std::uint32_t { free, held, left_behind, given_up };

/// The requested error or time of images, and what was achieved.
struct BudgetCounters {
  double asked_error;         ///< 0: none
  double asked_ms;            ///< 0: none
  double measured;            ///< greatest error of the integrated rays, with the setting below
  double ms;                  ///< time of an image
  std::uint64_t rays;         ///< integrated during the run
  std::uint64_t images_over;  ///< with a ray whose error was above the requested one; the next image was finer
  std::uint32_t calibrations;
  char setting[120];
  char note[200];  ///< why the budget is not kept; empty if it is
};

struct VolumeCounters {
  std::atomic<VolumePlace> place;
  std::atomic<std::uint32_t> number;  ///< position among the process's volumes, from 1
  std::uint64_t texture;              ///< the application's texture name
  std::int32_t size[3];
  char texture_format[32];
  std::atomic<std::uint64_t> draws_substituted;
  std::atomic<std::uint64_t> draws_left;
  std::atomic<std::uint64_t> probes;  ///< how often its colours were probed
  std::atomic<std::uint64_t> texel_bytes_sent;
  std::atomic<std::uint64_t> texel_bytes_left_out;  ///< of changed textures: texels that the nodes already had
  ReasonCount left_because[max_counted_reasons];
  std::atomic<std::uint64_t> verified_frames;
  double verify_max;         ///< largest error in the verified frames
  double verify_sum_sq;      ///< sum over verified frames of the mean squared error: RMS = sqrt(sum / frames)
  double verify_worst_tile;  ///< over whole images and sentinels; the bound is 1
  std::uint64_t verify_worst_frame;           ///< the frame of the worst tile, from 1
  std::atomic<std::uint64_t> verified_tiles;  ///< sentinels
  std::atomic<std::uint64_t> verify_lost;     ///< comparisons beyond the bound
  char explanation[512];                      ///< what was recognised, in words
  char scene[32];                             ///< file in the folder of --export; empty: none
  char not_exported[200];                     ///< why there is none, as far as known
  BudgetCounters budget;
};

/// Parts of a frame, in milliseconds. They do not overlap; the rest of the frame is the application's.
struct FrameShares {
  double waiting;  ///< before a probe is read back: until the driver has drawn the application's earlier calls
  double recognition;   ///< analysing a run: geometry, colours
  double depth;         ///< reading the depth of opaque geometry, including the wait until it is drawn
  double upload;        ///< texels to the nodes
  double render;        ///< waiting for the render service
  double verification;  ///< native rendering and the comparison
  double presentation;  ///< completing the image and drawing it into the application's framebuffer
  double budget;        ///< choosing samples, and integrating rays to measure their error

  FrameShares& operator+=(const FrameShares& other) {
    waiting += other.waiting;
    recognition += other.recognition;
    depth += other.depth;
    upload += other.upload;
    render += other.render;
    verification += other.verification;
    presentation += other.presentation;
    budget += other.budget;
    return *this;
  }
};

/// Work that an optimization could skip: what was done, and what was skipped. The unit depends on the
/// optimization.
struct Amount {
  std::uint64_t done = 0;
  std::uint64_t left_out = 0;
};

/// By Optimization. In a process's own figures, amounts that the nodes count stay empty (volume::FrameCounts).
using Amounts = std::array<Amount, optimization_count>;

inline Amounts& operator+=(Amounts& sum, const Amounts& more) {
  for (std::size_t i = 0; i < sum.size(); ++i) {
    sum[i].done += more[i].done;
    sum[i].left_out += more[i].left_out;
  }
  return sum;
}

struct FrameRecord {
  double time_ms;  ///< from the last frame end to this one
  FrameShares spent_ms;
  std::uint32_t substituted;
  std::uint32_t left;
  std::uint32_t within_budget;  ///< of the substituted runs: with other samples than the application's
  double error_rms;             ///< compared with native rendering; negative: not measured
  volume::FrameCounts counts;
  Amounts amounts;

  Amount& amount(Optimization optimization) { return amounts[std::size_t(optimization)]; }
};

/// Counters of a process whose OpenGL calls are made by a GL server. Bytes include the heads of messages.
struct RemoteCounters {
  std::atomic<std::uint32_t> is;  ///< 1: OpenGL is remote
  std::atomic<std::uint64_t> frames;
  std::atomic<std::uint64_t> round_trips;
  std::atomic<std::uint64_t> bytes_up;
  std::atomic<std::uint64_t> bytes_down;
  std::atomic<std::uint32_t> lost;         ///< 1: the GL server was lost before the process ended
  std::atomic<std::uint64_t> frames_lost;  ///< ended but never shown, because it was lost
};

/// Counters of a GL server that draws windows in tiles.
struct TileCounters {
  std::uint32_t count;                ///< tiles of a window; 0: windows are drawn whole
  std::atomic<std::uint64_t> frames;  ///< assembled from tiles
  char given_up[128];                 ///< why windows are drawn whole from some frame on; empty if they are not
};

struct ProcessCounters {
  std::uint32_t magic;
  std::int32_t pid;
  char program[256];
  std::atomic<std::uint64_t> frames;
  std::atomic<std::uint64_t> frames_substituted;  ///< with at least one substituted run of slices
  std::atomic<std::uint64_t> frames_left;         ///< with at least one run of slices not substituted
  volume::FrameCounts total;                      ///< over all frames; the ring below keeps only the last
  Amounts total_amounts;                          ///< likewise
  ReasonCount done_because[optimization_count][max_counted_done_reasons];
  std::int32_t nodes;                        ///< 0: embedded
  std::atomic<std::uint64_t> images_behind;  ///< shown one frame late
  std::atomic<std::uint64_t> windows_asked;  ///< how often a window with such an image was asked to redraw
  std::atomic<std::uint32_t> threads;
  std::uint64_t calls[max_counted_threads];  ///< one slot per thread, so that counting needs no atomics
  RemoteCounters remote;
  TileCounters tiles;
  std::atomic<std::uint32_t> volumes;
  std::atomic<std::uint32_t> volumes_merged;   ///< those of them that are counted in another volume's place
  VolumeCounters volume[max_counted_volumes];  ///< the last one is shared: see count_volume()
  FrameRecord frame[max_frame_records];        ///< ring: frame f is at f % max_frame_records
};

/// This process's counters: mapped from UNDERSTUDY_RUN_DIR if the launcher has set it, otherwise private
/// memory. Never fails, and the address stays the same for the life of the process; a forked child has counters
/// of its own, and a file from its first call on.
ProcessCounters& process_counters();

/// Counts one more volume and returns the place for its figures: an unused one; otherwise that of a volume that
/// no longer exists, whose figures are added to the last place; otherwise the last place, which all volumes
/// beyond max_counted_volumes - 1 share that exist at the same time. May be called on any thread.
VolumeCounters& count_volume(std::uint64_t texture);

/// Merges volumes that turned out to be parts of one: their figures are added to those of the first of them,
/// and the other places become free. The same counters may appear more than once.
VolumeCounters& count_as_one(std::span<VolumeCounters* const> parts);

/// The volume no longer exists: its figures stay until their place is needed.
void leave_behind(VolumeCounters& volume);

/// Fills a fixed field of the counters with as much of the text as fits, and zeros.
void put_text(std::span<char> field, std::string_view text);

/// Counts a run that was not substituted. A volume has room for max_counted_reasons; if there are more, the
/// last one becomes "other reasons".
void count_reason(VolumeCounters& volume, std::string_view reason, std::uint64_t times = 1);

/// Counts why work was done that this optimization could have skipped. An optimization has room for
/// max_counted_done_reasons; if there are more, the last one becomes "other reasons".
void count_done(Optimization optimization, std::string_view reason);

/// Counts a finished frame: in the ring, and in the totals.
void count_frame(const FrameRecord& frame);

/// Discards all frames counted so far, which are not to be reported. Not while another thread counts.
void forget_counted_frames();

/// The call counter of the calling thread. Threads beyond max_counted_threads share the last one.
std::uint64_t* thread_call_counter();

}  // namespace understudy::spu
