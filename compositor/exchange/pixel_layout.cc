// SPDX-License-Identifier: Apache-2.0
#include "compositor/exchange/pixel_layout.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstring>
#include <vector>

#include "compositor/blend.h"
#include "compositor/exchange/communicator.h"
#include "volume/raycast/ray_caster.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "compositor/exchange/pixel_layout.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace understudy::compositor::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Bit i of the result: a component of pixel i, of at most 64, differs from `neutral`.
std::uint64_t touched_one_by_one(const float* pixels, std::size_t count, float neutral) {
  const hn::CappedTag<float, 4> d;
  const auto untouched = hn::Set(d, neutral);
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < count; ++i) {
    bool touched = false;
    for (std::size_t lane = 0; lane < 4; lane += hn::Lanes(d))
      touched |= !hn::AllTrue(d, hn::Eq(hn::LoadU(d, pixels + 4 * i + lane), untouched));
    bits |= std::uint64_t(touched) << i;
  }
  return bits;
}

/// Sets bit x % 64 of word x / 64 of `bits` if pixel x of a row is touched.
void find_touched(const float* row, std::size_t pixels, float neutral, std::uint64_t* bits) {
  const hn::ScalableTag<float> d;
  const auto untouched = hn::Set(d, neutral);
  // If this many pixels are all touched or all untouched, they take few steps.
  constexpr std::size_t at_once = 16;
  for (std::size_t x = 0; x < pixels; x += 64) {
    std::uint64_t word = 0;
    for (std::size_t i = 0; i < 64 && x + i < pixels; i += at_once) {
      const float* const here = row + 4 * (x + i);
      const std::size_t count = std::min(at_once, pixels - x - i);
      if (count == at_once && hn::Lanes(d) <= 4 * at_once) {
        auto all = hn::Eq(hn::LoadU(d, here), untouched), any = all;
        for (std::size_t k = hn::Lanes(d); k < 4 * at_once; k += hn::Lanes(d)) {
          const auto same = hn::Eq(hn::LoadU(d, here + k), untouched);
          all = hn::And(all, same);
          any = hn::Or(any, same);
        }
        if (hn::AllTrue(d, all)) continue;
        if (hn::AllFalse(d, any)) {
          word |= ((std::uint64_t(1) << at_once) - 1) << i;
          continue;
        }
      }
      word |= touched_one_by_one(here, count, neutral) << i;
    }
    bits[x / 64] = word;
  }
}

}  // namespace understudy::compositor::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace understudy::compositor {

HWY_EXPORT(find_touched);

namespace {

using volume::Image;
using volume::Operator;
using volume::Rect;

/// Precedes the pixels, in head_bytes: the count of tell(), how many runs follow the pixels (or that all pixels
/// are sent), and whether these are packed.
struct Head {
  std::uint64_t told = 0;
  std::uint32_t runs = 0;
  std::uint32_t packed = 0;
};
static_assert(sizeof(Head) == head_bytes);
constexpr std::uint32_t all_pixels = 0xffffffff;

/// Number of untouched pixels, then of pixels that are sent; runs continue from row to row.
struct PixelRun {
  std::uint32_t untouched = 0;
  std::uint32_t touched = 0;
};

RankLost malformed() {
  return RankLost("a message with pixels does not fit its rectangle");
}

struct Span {
  std::size_t first = 0;
  std::size_t end = 0;
};

/// The touched spans of a row, from the result of find_touched().
class TouchedSpans {
 public:
  explicit TouchedSpans(std::size_t width) : width_(width), bits_((width + 63) / 64) {}

  /// Holes of less than `least_hole` pixels do not separate spans.
  const std::vector<Span>& find(const float* row, float neutral, std::size_t least_hole) {
    HWY_DYNAMIC_DISPATCH(find_touched)(row, width_, neutral, bits_.data());
    spans_.clear();
    for (std::size_t x = next(0, true); x < width_;) {
      const std::size_t end = next(x, false);
      if (!spans_.empty() && x - spans_.back().end < least_hole)
        spans_.back().end = end;
      else
        spans_.push_back({x, end});
      x = next(end, true);
    }
    return spans_;
  }

 private:
  /// Returns the first pixel from x on that is touched (or is not, as `touched` says); otherwise the width.
  std::size_t next(std::size_t x, bool touched) const {
    for (; x < width_; x = (x / 64 + 1) * 64) {
      const std::uint64_t word = (touched ? bits_[x / 64] : ~bits_[x / 64]) >> (x % 64);
      if (word != 0) return std::min(width_, x + std::size_t(std::countr_zero(word)));
    }
    return width_;
  }

  std::size_t width_;
  std::vector<std::uint64_t> bits_;
  std::vector<Span> spans_;
};

}  // namespace

void PixelMessage::tell(std::uint64_t count) {
  assert(size() >= head_bytes && room_.data() == bytes_.data());
  std::memcpy(room_.data() + offsetof(Head, told), &count, sizeof count);
}

std::uint64_t PixelMessage::told() const {
  if (received_ < head_bytes) throw RankLost("a message with pixels was cut short");
  std::uint64_t count = 0;
  std::memcpy(&count, bytes_.data() + offsetof(Head, told), sizeof count);
  return count;
}

PixelMessage encode_pixels(const Image& image, const Rect& rect, Operator op, Layout layout, bool packed,
                           bool clear_too, std::span<std::byte> room) {
  const bool of_known_length = !of_unknown_length(rect);
  if (of_known_length) layout = Layout::rgba32f;
  const std::size_t pixel = bytes_per_pixel(layout);
  const bool all = !may_travel_in_runs(rect, op, layout, clear_too);
  packed = packed && !all;
  const auto width = std::size_t(rect.width);
  const std::size_t most = most_message_bytes(rect, layout);
  PixelMessage message = room.size() >= most ? PixelMessage(room) : PixelMessage(most);
  std::byte* to = message.room().data() + head_bytes;
  LastPixel last{};
  std::vector<PixelRun> runs;
  const auto put = [&](std::span<const float> floats) {
    if (packed) {
      to += pack_pixels(floats, layout, last, to);
      return;
    }
    put_pixels(floats, layout, to);
    to += pixel * floats.size() / 4;
  };
  TouchedSpans spans(width);
  std::size_t next = 0;  // first pixel behind the last run
  for (int y = rect.y; y < rect.y + rect.height; ++y) {
    const float* const row = image.at(rect.x, y);
    if (all) {
      put({row, 4 * width});
      continue;
    }
    const std::size_t before = std::size_t(y - rect.y) * width;
    for (const Span& span : spans.find(row, volume::neutral_value(op), least_hole(op, layout))) {
      if (runs.empty() || before + span.first > next)
        runs.push_back({std::uint32_t(before + span.first - next), 0});
      runs.back().touched += std::uint32_t(span.end - span.first);
      next = before + span.end;
      put({row + 4 * span.first, 4 * (span.end - span.first)});
    }
  }
  if (!runs.empty()) std::memcpy(to, runs.data(), sizeof(PixelRun) * runs.size());
  to += sizeof(PixelRun) * runs.size();
  const Head head{0, all ? all_pixels : std::uint32_t(runs.size()), packed ? 1U : 0U};
  std::memcpy(message.room().data(), &head, sizeof head);
  message.shorten(std::size_t(to - message.room().data()));
  return message;
}

std::size_t most_message_bytes(const Rect& rect, Layout layout) {
  if (!of_unknown_length(rect)) return bytes_of_all_pixels(rect, layout);
  // There are most runs when every second pixel is touched.
  return head_bytes + most_packed_bytes(rect.pixels()) + sizeof(PixelRun) * (rect.pixels() / 2 + 1);
}

PixelMessage space_for_pixels(const Rect& rect, Layout layout) {
  return PixelMessage(most_message_bytes(rect, layout));
}

PixelReader::PixelReader(const PixelMessage& message, const Rect& rect, Layout layout)
    : rect_(rect), layout_(of_unknown_length(rect) ? layout : Layout::rgba32f) {
  if (message.received() < head_bytes || message.received() > message.size()) throw malformed();
  Head head;
  std::memcpy(&head, message.bytes().data(), sizeof head);
  pixels_ = message.bytes().first(message.received()).subspan(head_bytes);
  packed_ = head.packed != 0;
  if (head.runs == all_pixels) {
    touched_ = rect.pixels();
    return;
  }
  if (pixels_.size() / sizeof(PixelRun) < head.runs) throw malformed();
  runs_ = pixels_.last(sizeof(PixelRun) * head.runs);
  pixels_ = pixels_.first(pixels_.size() - runs_.size());
}

// Calls use(pixels) for every span of the row that was sent; its pixels are the next ones of the message.
template <class Use>
void PixelReader::for_spans(std::span<float> row, Use use) {
  assert(row.size() == 4 * std::size_t(rect_.width));
  while (!row.empty()) {
    if (untouched_ == 0 && touched_ == 0) {
      if (runs_.empty()) return;
      PixelRun run;
      std::memcpy(&run, runs_.data(), sizeof run);
      runs_ = runs_.subspan(sizeof run);
      untouched_ = run.untouched;
      touched_ = run.touched;
    }
    const std::size_t skipped = std::min(untouched_, row.size() / 4);
    untouched_ -= skipped;
    row = row.subspan(4 * skipped);
    const std::size_t here = untouched_ > 0 ? 0 : std::min(touched_, row.size() / 4);
    touched_ -= here;
    if (here > 0) use(row.first(4 * here));
    row = row.subspan(4 * here);
  }
}

void PixelReader::next_pixels(std::span<float> pixels) {
  if (packed_) {
    const std::size_t taken = unpack_pixels(pixels_, layout_, last_, pixels);
    if (taken == 0) throw malformed();
    pixels_ = pixels_.subspan(taken);
    return;
  }
  const std::size_t bytes = bytes_per_pixel(layout_) * pixels.size() / 4;
  if (pixels_.size() < bytes) throw malformed();
  get_pixels(pixels_.data(), layout_, pixels);
  pixels_ = pixels_.subspan(bytes);
}

void PixelReader::read_row(std::span<float> row) {
  for_spans(row, [&](std::span<float> span) { next_pixels(span); });
}

void PixelReader::blend_row_behind(Operator op, std::span<float> row) {
  // Few enough to stay in the nearest cache.
  constexpr std::size_t floats_at_once = 4 * 4 * packed_block_pixels;
  for_spans(row, [&](std::span<float> span) {
    while (!span.empty()) {
      std::array<float, floats_at_once> behind;
      const std::span<float> here = span.first(std::min(span.size(), floats_at_once));
      next_pixels(std::span(behind).first(here.size()));
      blend(op, here, std::span(behind).first(here.size()));
      span = span.subspan(here.size());
    }
  });
}

void PixelReader::end() const {
  if (!pixels_.empty() || !runs_.empty() || untouched_ > 0 || touched_ > 0) throw malformed();
}

}  // namespace understudy::compositor
#endif
