// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/cli/play.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <set>
#include <stdexcept>

#include "apps/understudy/images/read_image.h"
#include "apps/understudy/offscreen/offscreen_contexts.h"
#include "apps/understudy/progress/progress_option.h"
#include "compositor/logging/log.h"
#include "spu/player/player.h"
#include "spu/report/counters.h"
#include "spu/stream/event.h"
#include "spu/stream/trace_file.h"
#include "spu/window_system/shown_image.h"

namespace understudy::launcher {
namespace {

/// Maximum number of distinct faults of a trace that are logged; further ones are only counted.
constexpr std::size_t most_faults_of_play = 20;

class Playing {
 public:
  Playing(const PlayPlan& plan, const spu::Options& options)
      : plan_(plan),
        reader_(plan.trace),
        bytes_(std::filesystem::file_size(plan.trace)),
        progress_(plan.progress),
        windows_(open_offscreen_contexts(options.server_opengl)),
        player_(*windows_, options) {
    player_.on_frame = [this](const spu::ShownFrame& frame) { frame_shown(frame); };
    player_.on_read = [this](const spu::Decoder::ReadImage& image) { image_read(image); };
  }

  Played run() {
    if (!plan_.save_frames.empty()) std::filesystem::create_directories(plan_.save_frames);
    while (frame_ <= plan_.frames.last) {
      const std::optional<spu::Block> block = reader_.next();
      if (!block) break;
      const double done = bytes_ == 0 ? 1 : double(block->file_offset) / double(bytes_);
      progress_.show(done, fmt::format("{} {}, {} % of the trace", played_.frames,
                                       played_.frames == 1 ? "frame" : "frames", int(100 * done)));
      play(*block);
    }
    if (reader_.cut_off())
      logging::log(logging::Level::warn, "{} was cut off; it was replayed up to its last complete block",
                   plan_.trace.string());
    if (frame_ <= plan_.frames.first && plan_.frames.first > 1) {
      spu::forget_counted_frames();
      logging::log(logging::Level::info, "{} has only {} frames", plan_.trace.string(), frame_ - 1);
    }
    if (played_.errors > 0)
      logging::log(logging::Level::warn, "{} records could not be replayed", played_.errors);
    return played_;
  }

 private:
  void play(const spu::Block& block) {
    std::size_t position = 0;
    std::uint64_t& calls = *spu::thread_call_counter();
    while (position < block.records.size() && frame_ <= plan_.frames.last) {
      const auto record = spu::record_at(block.records, position, block.payload);
      if (!record)
        throw std::runtime_error(
            fmt::format("{}: {}", plan_.trace.string(), in_block(block, "a record is longer than its block")));
      position += record->words.size();
      if (plan_.played != nullptr) plan_.played->is(record->id);
      const std::string error = player_.play(*record);
      if (spu::event::name_of(record->id) == nullptr) ++calls;
      if (!error.empty()) tell(in_block(block, error), error);
    }
  }

  void tell(const std::string& fault, const std::string& kind) {
    ++played_.errors;
    if (told_.size() < most_faults_of_play && told_.insert(kind).second)
      logging::log(logging::Level::warn, "{}: {}", plan_.trace.string(), fault);
  }

  void frame_shown(const spu::ShownFrame& shown) {
    if (frame_ == plan_.frames.first) spu::forget_counted_frames();
    if (plan_.frames.contains(frame_)) {
      ++played_.frames;
      if (!plan_.save_frames.empty() && shown.extent.width > 0 && shown.extent.height > 0) {
        write_png(plan_.save_frames / fmt::format("frame_{:04}.png", frame_),
                  image_of(shown_image(player_.driver(), shown.extent), shown.extent));
      }
    }
    ++frame_;
  }

  void image_read(const spu::Decoder::ReadImage& read) {
    if (!plan_.frames.contains(frame_)) return;
    const std::optional<RgbaImage> image = image_of(read);
    if (!image) return;
    ++played_.reads;
    if (plan_.save_frames.empty()) return;
    write_png(plan_.save_frames / fmt::format("read_{:04}.png", played_.reads), *image);
  }

  const PlayPlan plan_;
  spu::TraceReader reader_;
  const std::uintmax_t bytes_;  ///< size of the trace
  Progress progress_;
  const std::unique_ptr<OffscreenContexts> windows_;
  spu::Player player_;
  Played played_;
  std::uint64_t frame_ = 1;  ///< the frame that is being drawn
  std::set<std::string> told_;
};

int play_and_say(const PlayPlan& plan) {
  return play_guarded(plan.trace, [&](PlayedRecord& played) {
    PlayPlan guarded = plan;
    guarded.played = &played;
    play(guarded, spu::options_from_environment());
    return 0;
  });
}

}  // namespace

FrameRange parse_frame_range(const std::string& text) {
  FrameRange range;
  const std::size_t dash = text.find('-');
  const auto number = [&](const std::string& digits) -> std::uint64_t {
    const bool valid = !digits.empty() && digits.size() < 10 &&
                       std::all_of(digits.begin(), digits.end(), [](char c) { return c >= '0' && c <= '9'; });
    if (!valid) throw std::runtime_error(fmt::format("'{}' is not a range of frames; give 3-7, 3- or 3", text));
    return std::stoull(digits);
  };
  range.first = number(text.substr(0, dash));
  if (dash == std::string::npos) {
    range.last = range.first;
  } else if (dash + 1 < text.size()) {
    range.last = number(text.substr(dash + 1));
  }
  if (range.first == 0 || range.last < range.first)
    throw std::runtime_error(fmt::format(
        "'{}' is not a range of frames; frames are counted from 1, and the first comes before the last", text));
  return range;
}

Played play(const PlayPlan& plan, const spu::Options& options) {
  return Playing(plan, options).run();
}

void add_play(CLI::App& app, std::function<int()>& chosen) {
  const auto plan = std::make_shared<PlayPlan>();
  const auto frames = std::make_shared<std::string>();
  CLI::App* subcommand = app.add_subcommand("play", "replays a trace in this process, for replay");
  subcommand->group("");
  subcommand->add_option("trace", plan->trace)->required();
  subcommand->add_option("--frames", *frames);
  subcommand->add_option("--save-frames", plan->save_frames);
  const auto progress = std::make_shared<ProgressOptions>();
  add_progress_options(*subcommand, *progress);
  subcommand->callback([plan, frames, progress, &chosen] {
    plan->progress = progress->style();
    if (!frames->empty()) plan->frames = parse_frame_range(*frames);
    chosen = [plan] { return play_and_say(*plan); };
  });
}

}  // namespace understudy::launcher
