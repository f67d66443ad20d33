// SPDX-License-Identifier: Apache-2.0
#include "spu/tiles/tiles.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "dispatch/call_words.h"
#include "spu/report/counters.h"
#include "spu/shared_by_file.h"
#include "spu/state_value.h"
#include "spu/stream/event.h"
#include "spu/stream/extent.h"
#include "spu/stream/pixels.h"
#include "spu/tiles/window_use.h"
#include "spu/window_system/shown_image.h"

namespace understudy::spu {
namespace {

/// If a window is completed more often than this, it is cheaper to let one process draw it.
constexpr int most_copies = 16;
/// Limit for one read of a tile worker, below its limit for streams from elsewhere (stream/decode.h).
constexpr std::size_t most_read_bytes = std::size_t(32) << 20;

struct Divided {
  static std::uint64_t call(CallId call, const std::uint64_t* words) {
    return Chain::current()->find<Tiles>()->call(call, words);
  }
};

/// 0 for an attachment that the window lacks.
GLint ask_of_window(const DispatchTable& gl, GLenum attachment, GLenum name) {
  GLint value = 0;
  gl.GetFramebufferAttachmentParameteriv(GL_DRAW_FRAMEBUFFER, attachment, GL_FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE,
                                         &value);
  if (value == GL_NONE) return 0;
  gl.GetFramebufferAttachmentParameteriv(GL_DRAW_FRAMEBUFFER, attachment, name, &value);
  return value;
}

std::pair<GLint, GLint> depth_and_stencil_bits(const DispatchTable& gl) {
  return {ask_of_window(gl, GL_DEPTH, GL_FRAMEBUFFER_ATTACHMENT_DEPTH_SIZE),
          ask_of_window(gl, GL_STENCIL, GL_FRAMEBUFFER_ATTACHMENT_STENCIL_SIZE)};
}

constexpr UnitOption tiles_options[] = {
    {.name = "of",
     .type = OptionType::integer,
     .fallback = "2",
     .low = 2,
     .high = most_tiles,
     .help = "number of tiles of a window, each drawn by a process of its own"},
    {.name = "gl-server",
     .type = OptionType::text,
     .fallback = "",
     .help = "Unix socket of the GL servers that draw the other tiles"}};

}  // namespace

bool window_divides(const DispatchTable& gl) {
  // Older versions do not support these queries and would raise an error that the application sees.
  const auto* version = reinterpret_cast<const char*>(gl.GetString(GL_VERSION));
  if (version == nullptr || std::atof(version) < 3 || state_value(gl, GL_DRAW_FRAMEBUFFER_BINDING) != 0 ||
      state_value(gl, GL_SAMPLES) > 0)
    return false;
  const GLenum colour = state_value(gl, GL_DOUBLEBUFFER) != 0 ? GL_BACK_LEFT : GL_FRONT_LEFT;
  for (const GLenum channel : {GL_FRAMEBUFFER_ATTACHMENT_RED_SIZE, GL_FRAMEBUFFER_ATTACHMENT_GREEN_SIZE,
                               GL_FRAMEBUFFER_ATTACHMENT_BLUE_SIZE, GL_FRAMEBUFFER_ATTACHMENT_ALPHA_SIZE}) {
    if (ask_of_window(gl, colour, channel) > 8) return false;
  }
  // Windows are completed by way of textures, which support only these depth formats
  // (window_system/shown_image.h).
  const std::pair bits = depth_and_stencil_bits(gl);
  return bits == std::pair{0, 0} || bits == std::pair{24, 8};
}

Tiles::Tiles(Chain& chain, TileWorkers& tile_workers, int parts)
    : chain_(chain),
      workers_(tile_workers),
      parts_(parts),
      recorder_(chain.driver()),
      scissor_(tile_workers.lists_touch_scissor()) {}

void Tiles::fill(Phase, DispatchTable& table) {
  if (workers_.here() || !placed_) AsWords<Divided>::fill(table);
}

void Tiles::introduce(std::span<const std::uint64_t> words) {
  workers_.gather(parts_);
  workers_.records().append_plain(event::context, words);
}

void Tiles::place(std::uint64_t drawable, Extent2D extent) {
  const bool first = !std::exchange(placed_, true);
  if (!workers_.here()) {
    if (first) chain_.refill();
    return;
  }
  drawable_ = drawable;
  extent_ = extent;
  const std::uint64_t words[] = {chain_.surroundings().context, std::uint64_t(extent.width),
                                 std::uint64_t(extent.height), drawable};
  workers_.records().append_plain(event::current, words);
  if (first && workers_.given_up() == nullptr && !window_divides(chain_.driver())) {
    workers_.give_up("a window has several samples a pixel, or an unusual depth or colour");
    if (!workers_.here()) chain_.refill();
  } else if (first && workers_.given_up() == nullptr) {
    divided_ = true;
    has_depth_ = depth_and_stencil_bits(chain_.driver()).first > 0;
    workers_.begin_tiles();
  }
  divide();
}

void Tiles::divide() {
  scissor_.set(extent_.width, rows_of_tile(extent_.height, 0, parts_));
}

void Tiles::left() {
  if (!workers_.here()) return;
  constexpr std::uint64_t nothing[] = {0, 0, 0};
  workers_.records().append_plain(event::current, nothing);
}

void Tiles::abandon() {
  if (!workers_.here()) return;
  const std::uint64_t words[] = {chain_.surroundings().context};
  workers_.records().append_plain(event::context_gone, words);
  workers_.hand_on(true);
  if (std::exchange(divided_, false)) workers_.end_tiles();
}

std::uint64_t Tiles::call(CallId call, const std::uint64_t* words) {
  const DispatchTable& next = chain_.below(*this);
  if (!workers_.here()) {
    // A tile worker has just been lost.
    stop_dividing();
    return invoke(next, call, words);
  }
  if (recorder_.inside_begin()) return make(call, words, false);
  const WindowUse use = window_use(call);
  if (use == WindowUse::reads || use == WindowUse::asks) return read(call, words);
  if (use == WindowUse::pushes) {
    // The tile workers should draw at the same time as this process.
    recorder_.before(CallId::Flush, words, workers_.records());
    workers_.hand_on(true);
    return invoke(next, call, words);
  }
  if (divided_ && !making_whole_) {
    if (const char* why = beyond_tiles(call, words)) workers_.give_up(why);
    if (copies_window(call, words)) make_whole_for_copy();
    if (workers_.given_up() != nullptr && !is_compiling()) {
      stop_dividing();
      if (!workers_.here()) return invoke(next, call, words);
    }
  }
  scissor_.note(call, words);
  const bool lists = use == WindowUse::lists;
  const bool draws = lists || use == WindowUse::draws || use == WindowUse::begins;
  return make(call, words, draws && divided_);
}

std::uint64_t Tiles::make(CallId call, const std::uint64_t* words, bool restricted) {
  const DispatchTable& next = chain_.below(*this);
  const WindowUse use = window_use(call);
  Records& records = workers_.records();
  recorder_.before(call, words, records);
  const bool lists = use == WindowUse::lists;
  restricted = restricted && scissor_.begin(next, lists);
  const std::uint64_t result = invoke(next, call, words);
  restricted_ |= restricted;
  if (restricted_ && !recorder_.inside_begin()) {
    scissor_.end(next);
    restricted_ = false;
  }
  if (lists) scissor_.forget();
  if (CallRecorder::answers(call)) CallRecorder::append_answers(call, words, result, records);
  recorder_.made(call, words, result);
  if (!recorder_.inside_begin()) workers_.hand_on(false);
  return result;
}

/// Whether the call copies pixels of a window, to another place or to where later calls use them.
bool Tiles::copies_window(CallId call, const std::uint64_t* words) const {
  const WindowUse use = window_use(call);
  if (use != WindowUse::copies && use != WindowUse::blits) return false;
  if (call == CallId::BlitNamedFramebuffer) return words[0] == 0;
  return state_value(chain_.driver(), GL_READ_FRAMEBUFFER_BINDING) == 0;
}

/// Makes a query. Answers stay in this process, unless they go to a buffer object, where later calls use them.
std::uint64_t Tiles::read(CallId call, const std::uint64_t* words) {
  const DispatchTable& next = chain_.below(*this);
  const bool pixels = window_use(call) == WindowUse::reads;
  const auto parameters = call_shape(call).parameters();
  const bool image = std::any_of(parameters.begin(), parameters.end(), [](const ParameterShape& parameter) {
    return parameter.rule == ExtentRule::image_out;
  });
  const bool window = pixels && divided_ && state_value(next, GL_READ_FRAMEBUFFER_BINDING) == 0;
  if (image && state_value(next, GL_PIXEL_PACK_BUFFER_BINDING) != 0) {
    if (window && !making_whole_) make_whole_for_copy();
    if (workers_.given_up() != nullptr && !is_compiling()) stop_dividing();
    return workers_.here() ? make(call, words, false) : invoke(next, call, words);
  }
  const std::uint64_t result = invoke(next, call, words);
  if (window) fetch_rows(call, words);
  return result;
}

void Tiles::fetch_rows(CallId call, const std::uint64_t* words) {
  const DispatchTable& next = chain_.below(*this);
  const CallShape& shape = call_shape(call);
  auto* to = reinterpret_cast<std::byte*>(static_cast<std::uintptr_t>(words[shape.parameter_count - 1]));
  const ImageShape image = image_shape(call, words);
  const PixelStore store = pixel_store(next, pack_names);
  const auto extent = image_extent(image, store);
  const std::uint8_t room_at = argument_named(shape, "bufSize");
  if (!extent || to == nullptr ||
      (room_at != no_argument && *extent > std::size_t(std::max(GLsizei(words[room_at]), 0)))) {
    return;
  }
  ImageShape row = image;
  row.height = 1;
  const std::size_t row_bytes = std::max<std::size_t>(image_extent(row, tight_pixels).value_or(1), 1);
  const std::int64_t at_once = std::max<std::int64_t>(std::int64_t(most_read_bytes / row_bytes), 1);
  const std::int64_t bottom = GLint(words[1]);
  const std::int64_t top = bottom + image.height;
  // The requested rows of a tile worker's tile, without the first `done` ones.
  const auto part_of = [&](int worker, std::int64_t done) {
    const Rows rows = rows_of_tile(extent_.height, worker + 1, parts_);
    const std::int64_t first = std::max<std::int64_t>(rows.first, bottom) + done;
    const std::int64_t last = std::min<std::int64_t>(rows.first + rows.count, top);
    return Rows{int(first), int(std::clamp<std::int64_t>(last - first, 0, at_once))};
  };
  workers_.hand_on(true);
  const std::int64_t most_rows = std::min<std::int64_t>(image.height, extent_.height);
  for (std::int64_t done = 0; done < most_rows; done += at_once) {
    for (int worker = 0; worker < workers_.count(); ++worker) {
      const Rows rows = part_of(worker, done);
      if (rows.count == 0) continue;
      const std::array<std::uint64_t, 7> question = {
          words[0], std::uint64_t(rows.first),       words[2], std::uint64_t(rows.count), words[4],
          words[5], words[shape.parameter_count - 1]};
      question_.clear();
      recorder_.before(CallId::ReadPixels, question.data(), question_);
      workers_.ask(worker, question_);
    }
    for (int worker = 0; worker < workers_.count(); ++worker) {
      const Rows rows = part_of(worker, done);
      if (rows.count == 0) continue;
      const CallAnswer answer = workers_.answer(worker);
      ImageShape part = image;
      part.height = rows.count;
      // A format that OpenGL rejects has no answer in any process.
      if (answer.outputs.empty() || answer.outputs[0].bytes.size() != image_extent(part, tight_pixels))
        continue;
      PixelStore above = store;
      above.skip_rows += GLint(rows.first - bottom);
      spread_image(part, above, answer.outputs[0].bytes.data(), to);
    }
  }
}

void Tiles::make_whole() {
  making_whole_ = true;
  // These calls go through this unit: reads are assembled from tiles, and draws are made by all processes.
  const DispatchTable& all = chain_.face(*this, chain_.phase());
  // With indexed scissor boxes, the test could be disabled for one viewport only, leaving the boxes unequal.
  const bool tested = !scissor_.indexed() && all.IsEnabled(GL_SCISSOR_TEST) != GL_FALSE;
  if (tested) all.Disable(GL_SCISSOR_TEST);
  set_window_contents(all, window_contents(all, extent_, has_depth_));
  if (tested) all.Enable(GL_SCISSOR_TEST);
  making_whole_ = false;
}

void Tiles::make_whole_for_copy() {
  if (is_compiling()) {
    workers_.give_up("display lists of the application copy pixels of a window");
  } else if (++copies_ > most_copies) {
    workers_.give_up("the application copies pixels of its window all the time");
  } else {
    make_whole();
  }
}

/// Completes the window in this process, which draws all of it from then on.
void Tiles::stop_dividing() {
  if (divided_ && workers_.here()) make_whole();
  if (std::exchange(divided_, false)) workers_.end_tiles();
  if (!workers_.here()) chain_.refill();
}

std::vector<std::uint8_t> Tiles::shown_image() {
  const DispatchTable& next = chain_.below(*this);
  if (!divided_ || !workers_.here()) return spu::shown_image(next, extent_);
  const std::uint64_t words[] = {++frames_, std::uint64_t(extent_.width), std::uint64_t(extent_.height)};
  question_.clear();
  question_.append_plain(event::frame, words);
  workers_.hand_on(true);
  for (int worker = 0; worker < workers_.count(); ++worker) workers_.ask(worker, question_);
  const std::size_t row_bytes = std::size_t(4) * std::size_t(extent_.width);
  std::vector<std::uint8_t> pixels =
      shown_rows(next, extent_.width, rows_of_tile(extent_.height, 0, parts_).first,
                 rows_of_tile(extent_.height, 0, parts_).count);
  pixels.resize(row_bytes * std::size_t(extent_.height));
  for (int worker = 0; worker < workers_.count(); ++worker) {
    const Rows rows = rows_of_tile(extent_.height, worker + 1, parts_);
    const CallAnswer answer = workers_.answer(worker);
    if (answer.outputs.empty()) continue;
    const std::vector<std::byte>& bytes = answer.outputs[0].bytes;
    const std::size_t first = row_bytes * std::size_t(rows.first);
    std::memcpy(pixels.data() + first, bytes.data(),
                std::min(bytes.size(), row_bytes * std::size_t(rows.count)));
  }
  // A tile worker was lost: then the window's contents in this process are the best available.
  if (!workers_.here()) return spu::shown_image(next, extent_);
  process_counters().tiles.frames.fetch_add(1, std::memory_order_relaxed);
  return pixels;
}

constinit const UnitDescription tiles_description{
    .name = "tiles",
    .help = "draws each tile of a window with a process of its own (understudy run --remote --tiles on)",
    .options = tiles_options,
    .make = [](const UnitPlace& place) -> std::unique_ptr<Unit> {
      const std::string& servers = place.options.text("gl-server");
      if (servers.empty())
        throw ChainError("tiles",
                         "there are no GL servers to draw them; start the viewer with: understudy run "
                         "--remote --tiles on -n 2 -- viewer");
      return std::make_unique<Tiles>(place.chain, shared_by_file<TileWorkers>(servers),
                                     int(place.options.integer("of")));
    }};

}  // namespace understudy::spu
