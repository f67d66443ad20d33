// SPDX-License-Identifier: Apache-2.0
// What a process under Understudy counts, kept in memory that outlives it.
//
// The structure is mapped from a file (RUN_DIR/PID.counters, the folder belongs to the launcher), so a viewer
// that is killed still leaves its figures: no destructor, no atexit needed. One writer process, many threads;
// the launcher reads it after the end. Plain data, fixed size, no pointers, and all-zero bytes mean "nothing
// happened yet".
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <span>
#include <string_view>

#include "spu/report/optimization.h"
#include "volume/frame_counts.h"

namespace understudy::spu {

constexpr std::uint32_t counters_magic = 0x55444333;  // "UDC3"
constexpr int max_counted_volumes = 32;
constexpr int max_counted_reasons = 8;
constexpr int max_counted_done_reasons = 4;
constexpr int max_counted_threads = 64;
constexpr int max_frame_records = 4096;

struct ReasonCount {
  char reason[120];
  std::atomic<std::uint64_t> count;
};

/// Given up: its volume is counted in the place of another one.
enum class VolumePlace : std::uint32_t { free, held, left_behind, given_up };

/// What became of the error or the time that was asked for.
struct BudgetCounters {
  double asked_error;         ///< 0: none
  double asked_ms;            ///< 0: none
  double measured;            ///< greatest error of the rays that were integrated, under the setting below
  double ms;                  ///< that an image takes
  std::uint64_t rays;         ///< integrated while running
  std::uint64_t images_over;  ///< in which a ray was wrong by more than was asked; the next was finer
  std::uint32_t calibrations;
  char setting[120];
  char note[200];  ///< why the budget is not kept; empty: it is
};

struct VolumeCounters {
  std::atomic<VolumePlace> place;
  std::atomic<std::uint32_t> number;  ///< the how many-th volume of the process, from 1
  std::uint64_t texture;              ///< the application's texture name
  std::int32_t size[3];
  char texture_format[32];
  std::atomic<std::uint64_t> draws_substituted;
  std::atomic<std::uint64_t> draws_left;
  std::atomic<std::uint64_t> probes;  ///< how often its colours were found out
  std::atomic<std::uint64_t> texel_bytes_sent;
  std::atomic<std::uint64_t> texel_bytes_left_out;  ///< of changed textures: what the nodes had already
  ReasonCount left_because[max_counted_reasons];
  std::atomic<std::uint64_t> verified_frames;
  double verify_max;         ///< worst over the verified frames
  double verify_sum_sq;      ///< sum over verified frames of the mean squared error: RMS = sqrt(sum / frames)
  double verify_worst_tile;  ///< of whole images and sentinels, 1 is the bound
  std::uint64_t verify_worst_frame;           ///< the frame that it was in, from 1
  std::atomic<std::uint64_t> verified_tiles;  ///< sentinels
  std::atomic<std::uint64_t> verify_lost;     ///< comparisons beyond the bound
  char explanation[512];                      ///< what was recognised, in plain words
  BudgetCounters budget;
};

/// Parts of a frame, in milliseconds. They do not overlap; what is left of the frame is the application's.
struct FrameShares {
  double waiting;  ///< until the driver has drawn what the application drew before, where a probe is read back
  double recognition;   ///< what a run means: geometry, colours
  double depth;         ///< reading what opaque geometry left, which waits until the driver has drawn it
  double upload;        ///< texels to the nodes
  double render;        ///< waiting for the render service
  double verification;  ///< the application's own drawing, and the comparison
  double presentation;  ///< the image completed, and into the application's framebuffer
  double budget;        ///< choosing samples, and integrating rays to see how wrong they are

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

/// Of what could be left out: what was done, and what was left out. Units are those of the optimization.
struct Amount {
  std::uint64_t done = 0;
  std::uint64_t left_out = 0;
};

/// By Optimization. In a process's own figures those stay empty that the nodes count (volume::FrameCounts).
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
  std::uint32_t within_budget;  ///< of the substituted: with samples that are not the application's own
  double error_rms;             ///< against the application's own drawing; negative: not measured
  volume::FrameCounts counts;
  Amounts amounts;

  Amount& amount(Optimization optimization) { return amounts[std::size_t(optimization)]; }
};

/// Of a process whose OpenGL calls are made elsewhere. Bytes include heads of messages.
struct RemoteCounters {
  std::atomic<std::uint32_t> is;  ///< 1: they are
  std::atomic<std::uint64_t> frames;
  std::atomic<std::uint64_t> round_trips;
  std::atomic<std::uint64_t> bytes_up;
  std::atomic<std::uint64_t> bytes_down;
  std::atomic<std::uint32_t> lost;         ///< 1: the GL server went away before the process did
  std::atomic<std::uint64_t> frames_lost;  ///< ended and never shown, as it was gone
};

/// Of a GL server whose windows are drawn in tiles.
struct TileCounters {
  std::uint32_t count;                ///< tiles of a window; 0: windows are drawn whole
  std::atomic<std::uint64_t> frames;  ///< put together from tiles
  char given_up[128];                 ///< why windows are drawn whole from some frame on; empty: they are not
};

struct ProcessCounters {
  std::uint32_t magic;
  std::int32_t pid;
  char program[256];
  std::atomic<std::uint64_t> frames;
  std::atomic<std::uint64_t> frames_substituted;  ///< with at least one substituted run of slices
  std::atomic<std::uint64_t> frames_left;         ///< with at least one run of slices not substituted
  volume::FrameCounts total;                      ///< over all frames; the ring below forgets
  Amounts total_amounts;                          ///< likewise
  ReasonCount done_because[optimization_count][max_counted_done_reasons];
  std::int32_t nodes;                        ///< 0: embedded
  std::atomic<std::uint64_t> images_behind;  ///< shown one frame late, and of these
  std::atomic<std::uint64_t> windows_asked;  ///< how often the window was asked to draw again
  std::atomic<std::uint32_t> threads;
  std::uint64_t calls[max_counted_threads];  ///< one slot a thread, so that counting needs no atomics
  RemoteCounters remote;
  TileCounters tiles;
  std::atomic<std::uint32_t> volumes;
  std::atomic<std::uint32_t> volumes_merged;   ///< of these, those that are counted in another's place
  VolumeCounters volume[max_counted_volumes];  ///< the last one: see count_volume()
  FrameRecord frame[max_frame_records];        ///< ring: frame f is at f % max_frame_records
};

/// This process's counters: mapped from UNDERSTUDY_RUN_DIR when the launcher gave one, else private memory.
/// Never fails, and the address stays the same for the life of the process; a child after fork() counts for
/// itself.
ProcessCounters& process_counters();

/// Counts one more volume, and finds its figures a place: an unused one; else that of a volume that is gone,
/// whose figures are added to the last place; else the last place itself, which is shared by all volumes beyond
/// max_counted_volumes - 1 that live at once. Any thread.
VolumeCounters& count_volume(std::uint64_t texture);

/// Volumes turned out to be parts of one: their figures become those of the first of them, the other places are
/// free again. The same counters may be named more than once.
VolumeCounters& count_as_one(std::span<VolumeCounters* const> parts);

/// The volume is gone: its figures stay until their place is needed.
void leave_behind(VolumeCounters& volume);

/// A fixed field of the counters: as much of the text as it holds, and zeros.
void put_text(std::span<char> field, std::string_view text);

/// Counts one more run that was not substituted. A volume knows max_counted_reasons; the last of them
/// is "other reasons" once there are more.
void count_reason(VolumeCounters& volume, std::string_view reason, std::uint64_t times = 1);

/// Counts once more why something was done that this optimization could have spared. An optimization knows
/// max_counted_done_reasons; the last of them is "other reasons" once there are more.
void count_done(Optimization optimization, std::string_view reason);

/// Counts one finished frame: its ring slot, and the totals.
void count_frame(const FrameRecord& frame);

/// The frames so far are no part of what is to be told: counting starts again. Not while another thread counts.
void forget_counted_frames();

/// The slot of the calling thread's call count. Threads beyond max_counted_threads share the last slot.
std::uint64_t* thread_call_counter();

}  // namespace understudy::spu
