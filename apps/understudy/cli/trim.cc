// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/cli/trim.h"

#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "apps/understudy/cli/output_file.h"
#include "apps/understudy/offscreen/offscreen_contexts.h"
#include "compositor/logging/log.h"
#include "spu/player/player.h"
#include "spu/stream/event.h"
#include "spu/stream/trace_file.h"
#include "spu/trim/prefix.h"
#include "spu/trim/restoration.h"
#include "spu/trim/shortened.h"
#include "spu/window_system/shown_image.h"

namespace understudy::launcher {
namespace {

/// Maximum number of distinct faults of a trace that are logged.
constexpr std::size_t most_faults_of_trim = 20;

/// Calls `take(record, frame)` for every record up to the end of frame `last`; frames are counted from 1.
template <class Take>
std::uint64_t walk(const std::filesystem::path& trace, std::uint64_t last, const Take& take) {
  spu::TraceReader reader(trace);
  std::uint64_t frame = 1;
  while (frame <= last) {
    const std::optional<spu::Block> block = reader.next();
    if (!block) break;
    std::size_t position = 0;
    while (position < block->records.size() && frame <= last) {
      const auto record = spu::record_at(block->records, position, block->payload);
      if (!record)
        throw std::runtime_error(
            fmt::format("{}: {}", trace.string(), in_block(*block, "a record is longer than its block")));
      position += record->words.size();
      take(*record, frame);
      if (record->id == spu::event::frame) ++frame;
    }
  }
  return frame - 1;
}

spu::Options bare() {
  spu::Options options;
  options.chain = "driver";
  return options;
}

/// Returns the FNV-1a hash of an image.
std::uint64_t fingerprint(const void* bytes, std::size_t size) {
  const auto* byte = static_cast<const std::uint8_t*>(bytes);
  std::uint64_t sum = 0xcbf2'9ce4'8422'2325U;
  for (std::size_t i = 0; i < size; ++i) sum = (sum ^ byte[i]) * 0x0000'0100'0000'01b3U;
  return sum;
}

/// Images of frames that are played natively: those shown, and those read back.
class Images {
 public:
  Images()
      : windows_(open_offscreen_contexts(spu::options_from_environment().server_opengl)),
        player_(*windows_, bare()) {
    player_.on_frame = [this](const spu::ShownFrame& shown) {
      const auto pixels = spu::shown_image(player_.driver(), shown.extent);
      images_.push_back(fingerprint(pixels.data(), pixels.size()));
    };
    player_.on_read = [this](const spu::Decoder::ReadImage& read) {
      images_.push_back(fingerprint(read.pixels.data(), read.pixels.size()));
    };
  }

  spu::Player& player() { return player_; }
  /// Returns the images since the last call.
  std::vector<std::uint64_t> take() { return std::exchange(images_, {}); }

 private:
  const std::unique_ptr<OffscreenContexts> windows_;
  spu::Player player_;
  std::vector<std::uint64_t> images_;
};

std::vector<std::uint64_t> images_of(const TrimPlan& plan) {
  Images images;
  walk(plan.out, ~std::uint64_t(0), [&](const spu::Record& record, std::uint64_t) {
    if (plan.played != nullptr) plan.played->is(record.id);
    images.player().play(record);
  });
  return images.take();
}

/// Logs each record that cannot be played, once per distinct fault.
class Faults {
 public:
  explicit Faults(const std::filesystem::path& trace) : trace_(trace) {}
  void tell(const std::string& fault) {
    if (fault.empty() || told_.size() >= most_faults_of_trim || !told_.insert(fault).second) return;
    logging::log(logging::Level::warn, "{}: {}; the record is kept as it is", trace_.string(), fault);
  }

 private:
  const std::filesystem::path& trace_;
  std::set<std::string> told_;
};

void write(const TrimPlan& plan, const std::vector<spu::RecordAction>& actions,
           const spu::Records& restoration) {
  spu::Shortened shortened(plan.out);
  std::size_t number = 0;
  bool cut = false;
  walk(plan.trace, plan.frames.last, [&](const spu::Record& record, std::uint64_t frame) {
    if (frame < plan.frames.first) return shortened.take(record, actions[number++]);
    if (!cut) shortened.take_all(restoration);
    cut = true;
    shortened.take(record);
  });
  shortened.finish();
}

}  // namespace

void trim(const TrimPlan& plan) {
  const std::uint64_t first = plan.frames.first;
  std::vector<spu::RecordAction> actions;
  spu::Records restoration;
  std::vector<std::uint64_t> wanted;
  std::vector<std::string> troubles;
  {
    Images whole;
    spu::Prefix prefix(whole.player());
    Faults faults(plan.trace);
    bool cut = false;
    const auto cut_here = [&] {
      cut = true;
      actions = prefix.actions();
      troubles = spu::restore_drawn(whole.player(), prefix.drawn(), restoration);
      whole.take();
    };
    const std::uint64_t frames =
        walk(plan.trace, plan.frames.last, [&](const spu::Record& record, std::uint64_t frame) {
          if (plan.played != nullptr) plan.played->is(record.id);
          if (frame < first) return faults.tell(prefix.play(record));
          if (!cut) cut_here();
          faults.tell(whole.player().play(record));
        });
    if (frames < first)
      throw std::runtime_error(fmt::format("{} has only {} frames", plan.trace.string(), frames));
    wanted = whole.take();
  }

  // Earlier drawing is restored only if a frame depends on it, so try without the restoration first.
  const spu::Records nothing;
  for (const spu::Records* brought_back : std::initializer_list<const spu::Records*>{&nothing, &restoration}) {
    write(plan, actions, *brought_back);
    if (images_of(plan) == wanted) return;
  }
  std::filesystem::remove(plan.out);
  std::string why;
  for (const std::string& trouble : troubles) why += "; " + trouble;
  throw std::runtime_error(fmt::format(
      "frames {} and later depend on earlier images that cannot be restored{}; trim from an earlier frame",
      first, why));
}

void add_trim(CLI::App& app, std::function<int()>& chosen) {
  const auto plan = std::make_shared<TrimPlan>();
  const auto frames = std::make_shared<std::string>();
  CLI::App* subcommand =
      app.add_subcommand("trim", "writes a shorter trace that shows only some of the frames, numbered from 1");
  subcommand->add_option("trace", plan->trace, "trace file")->required()->check(CLI::ExistingFile);
  subcommand->add_option("--frames", *frames, "frames to keep, counted from 1")->required()->type_name("A-B");
  subcommand->add_option("-o,--out", plan->out, "trace file to write")
      ->required()
      ->type_name("OUT")
      ->check(can_be_written());
  subcommand->callback([plan, frames, &chosen] {
    plan->frames = parse_frame_range(*frames);
    chosen = [plan] {
      std::error_code none;
      if (std::filesystem::equivalent(plan->trace, plan->out, none))
        throw std::runtime_error("the shorter trace cannot overwrite the trace itself; give -o another name");
      return play_guarded(plan->trace, [&](PlayedRecord& played) {
        plan->played = &played;
        trim(*plan);
        logging::log(logging::Level::info, "{}: {:.1f} MB of {:.1f} MB", plan->out.string(),
                     double(std::filesystem::file_size(plan->out)) / 1e6,
                     double(std::filesystem::file_size(plan->trace)) / 1e6);
        return 0;
      });
    };
  });
}

}  // namespace understudy::launcher
