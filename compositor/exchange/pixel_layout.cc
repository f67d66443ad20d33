#include "compositor/exchange/pixel_layout.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>
#include <utility>

#include "compositor/exchange/link.h"
#include "volume/raycast/ray_caster.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "compositor/exchange/pixel_layout.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace understudy::compositor::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr float largest_half = 65504;

// A pixel at a time, or less where a vector holds less (HWY_SCALAR).
using Floats = hn::CappedTag<float, 4>;
using Halves = hn::Rebind<hwy::float16_t, Floats>;

void to_halves(const float* from, std::size_t floats, std::byte* to) {
  const Floats wide;
  const Halves narrow;
  HWY_ALIGN std::array<hwy::float16_t, 4> halves;
  for (std::size_t i = 0; i < floats; i += hn::Lanes(wide)) {
    const auto bounded =
        hn::Max(hn::Min(hn::LoadU(wide, from + i), hn::Set(wide, largest_half)), hn::Set(wide, -largest_half));
    hn::Store(hn::DemoteTo(narrow, bounded), narrow, halves.data());
    std::memcpy(to + 2 * i, halves.data(), 2 * hn::Lanes(wide));
  }
}

void from_halves(const std::byte* from, std::size_t floats, float* to) {
  const Floats wide;
  const Halves narrow;
  HWY_ALIGN std::array<hwy::float16_t, 4> halves{};
  for (std::size_t i = 0; i < floats; i += hn::Lanes(wide)) {
    std::memcpy(halves.data(), from + 2 * i, 2 * hn::Lanes(wide));
    hn::StoreU(hn::PromoteTo(wide, hn::Load(narrow, halves.data())), wide, to + i);
  }
}

void to_bytes(const float* from, std::size_t floats, std::byte* to) {
  const Floats wide;
  const hn::RebindToSigned<Floats> whole;
  HWY_ALIGN std::array<std::int32_t, 4> values;
  for (std::size_t i = 0; i < floats; i += hn::Lanes(wide)) {
    const auto bounded = hn::Max(hn::Min(hn::LoadU(wide, from + i), hn::Set(wide, 1.0F)), hn::Zero(wide));
    hn::Store(hn::NearestInt(hn::Mul(bounded, hn::Set(wide, 255.0F))), whole, values.data());
    for (std::size_t k = 0; k < hn::Lanes(wide); ++k) to[i + k] = std::byte(values[k]);
  }
}

}  // namespace understudy::compositor::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace understudy::compositor {

HWY_EXPORT(to_halves);
HWY_EXPORT(from_halves);
HWY_EXPORT(to_bytes);

namespace {

using volume::Image;
using volume::Operator;
using volume::Rect;

/// Before the pixels, in head_bytes: what is told, and how many runs follow, or that all pixels travel.
struct Head {
  std::uint64_t told = 0;
  std::uint32_t runs = 0;
};
constexpr std::uint32_t all_pixels = 0xffffffff;

struct PixelRun {
  std::uint32_t untouched = 0;
  std::uint32_t touched = 0;
};
static_assert(sizeof(PixelRun) == bytes_per_run);

bool of_unknown_length(const Rect& rect) {
  return bytes_of_all_pixels(rect, Layout::rgba32f) <= longest_of_unknown_length;
}

std::size_t most_bytes(const Rect& rect, Layout layout) {
  // One pixel in two touched is the most runs that there can be.
  const std::size_t runs = layout == Layout::rgba32f ? 0 : sizeof(PixelRun) * (rect.pixels() / 2 + 1);
  return head_bytes + bytes_per_pixel(layout) * rect.pixels() + runs;
}

template <class T>
std::byte* put(std::byte* to, const T& value) {
  std::memcpy(to, &value, sizeof value);
  return to + sizeof value;
}

void put_pixels(const float* from, std::size_t floats, Layout layout, std::byte* to) {
  switch (layout) {
    case Layout::rgba32f:
      std::memcpy(to, from, sizeof(float) * floats);
      break;
    case Layout::rgba16f:
      HWY_DYNAMIC_DISPATCH(to_halves)(from, floats, to);
      break;
    case Layout::rgba8:
      HWY_DYNAMIC_DISPATCH(to_bytes)(from, floats, to);
      break;
  }
}

void get_pixels(const std::byte* from, std::size_t floats, Layout layout, float* to) {
  switch (layout) {
    case Layout::rgba32f:
      std::memcpy(to, from, sizeof(float) * floats);
      break;
    case Layout::rgba16f:
      HWY_DYNAMIC_DISPATCH(from_halves)(from, floats, to);
      break;
    case Layout::rgba8:
      std::transform(from, from + floats, to, [](std::byte value) { return float(int(value)) / 255.0F; });
      break;
  }
}

std::vector<PixelRun> runs_in(const Image& image, const Rect& rect, float neutral) {
  std::vector<PixelRun> runs{{}};
  for (int y = rect.y; y < rect.y + rect.height; ++y) {
    const float* pixel = image.at(rect.x, y);
    for (const float* const end = pixel + 4 * std::size_t(rect.width); pixel != end; pixel += 4) {
      const bool touched =
          pixel[0] != neutral || pixel[1] != neutral || pixel[2] != neutral || pixel[3] != neutral;
      if (touched)
        ++runs.back().touched;
      else if (runs.back().touched > 0)
        runs.push_back({1, 0});
      else
        ++runs.back().untouched;
    }
  }
  return runs;
}

}  // namespace

void PixelMessage::tell(std::uint64_t count) {
  assert(bytes_.size() >= head_bytes);
  put(bytes_.data(), count);
}

std::uint64_t PixelMessage::told() const {
  if (received_ < head_bytes) throw LinkLost("a message with pixels was cut short");
  std::uint64_t count = 0;
  std::memcpy(&count, bytes_.data(), sizeof count);
  return count;
}

PixelMessage encode_pixels(const Image& image, const Rect& rect, Operator op, Layout layout, bool clear_too) {
  if (!of_unknown_length(rect)) layout = Layout::rgba32f;
  const std::size_t pixel = bytes_per_pixel(layout);
  std::vector<PixelRun> runs;
  std::size_t touched = 0;
  if (may_travel_in_runs(rect, op, layout, clear_too)) {
    runs = runs_in(image, rect, volume::neutral_value(op));
    for (const PixelRun& run : runs) touched += run.touched;
  }
  const MessageLength length = message_length(rect, op, layout, clear_too, runs.size(), touched);
  if (!length.in_runs) runs.clear();
  PixelMessage message(length.bytes);
  std::byte* to = put(message.room().data(), std::uint64_t(0));
  to = put(to, runs.empty() ? all_pixels : std::uint32_t(runs.size()));
  if (runs.empty()) {
    for (int y = rect.y; y < rect.y + rect.height; ++y, to += pixel * std::size_t(rect.width))
      put_pixels(image.at(rect.x, y), 4 * std::size_t(rect.width), layout, to);
    return message;
  }
  for (const PixelRun& run : runs) to = put(to, run);
  const auto width = std::size_t(rect.width);
  std::size_t at = 0;
  for (const PixelRun& run : runs) {
    at += run.untouched;
    for (std::size_t left = run.touched; left > 0;) {
      const std::size_t here = std::min(left, width - at % width);
      put_pixels(image.at(rect.x + int(at % width), rect.y + int(at / width)), 4 * here, layout, to);
      to += pixel * here;
      at += here;
      left -= here;
    }
  }
  return message;
}

PixelMessage room_for_pixels(const Rect& rect, Layout layout) {
  return PixelMessage(most_bytes(rect, of_unknown_length(rect) ? layout : Layout::rgba32f));
}

Image decode_pixels(PixelMessage& message, const Rect& rect, Operator op, Layout layout) {
  if (!of_unknown_length(rect)) layout = Layout::rgba32f;
  const std::size_t pixel = bytes_per_pixel(layout);
  const auto malformed = [] { return LinkLost("a message with pixels does not fit its rectangle"); };
  if (message.received() < head_bytes) throw malformed();
  std::span<const std::byte> left = message.bytes().first(message.received()).subspan(head_bytes);
  std::uint32_t count = 0;
  std::memcpy(&count, message.bytes().data() + sizeof(std::uint64_t), sizeof count);
  Image image(rect);
  if (count == all_pixels) {
    if (left.size() != pixel * rect.pixels()) throw malformed();
    get_pixels(left.data(), image.rgba.size(), layout, image.rgba.data());
    return image;
  }
  if (const float neutral = volume::neutral_value(op); neutral != 0) std::ranges::fill(image.rgba, neutral);
  if (left.size() / sizeof(PixelRun) < count) throw malformed();
  const std::span<const std::byte> runs = left.first(sizeof(PixelRun) * count);
  left = left.subspan(runs.size());
  std::size_t at = 0;
  for (std::size_t i = 0; i < count; ++i) {
    PixelRun run;
    std::memcpy(&run, runs.data() + sizeof run * i, sizeof run);
    at += run.untouched;
    if (at > rect.pixels() || run.touched > rect.pixels() - at || left.size() < pixel * run.touched)
      throw malformed();
    get_pixels(left.data(), 4 * std::size_t(run.touched), layout, image.rgba.data() + 4 * at);
    left = left.subspan(pixel * run.touched);
    at += run.touched;
  }
  if (at > rect.pixels() || !left.empty()) throw malformed();
  return image;
}

}  // namespace understudy::compositor
#endif
