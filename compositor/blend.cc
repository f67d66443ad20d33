// SPDX-License-Identifier: Apache-2.0
#include "compositor/blend.h"

#include <cassert>
#include <cstddef>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "compositor/blend.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

// Compiled once per instruction set; the best one is selected at run time.
HWY_BEFORE_NAMESPACE();
namespace understudy::compositor::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Processes single pixels where a vector holds less than a pixel (HWY_SCALAR), otherwise whole vectors and a
// tail of single pixels. Every lane computes the same, so a pixel's value never depends on where its run
// begins.
#if HWY_TARGET == HWY_SCALAR

template <class Pixel>
void for_pixels(float* front, const float* back, std::size_t floats, Pixel pixel) {
  for (std::size_t i = 0; i < floats; i += 4) pixel(front + i, back + i);
}

void over(float* front, const float* back, std::size_t floats) {
  for_pixels(front, back, floats, [](float* f, const float* b) {
    const float clear = f[3] < 1.0F ? 1.0F - f[3] : 0.0F;
    for (int c = 0; c < 4; ++c) f[c] += clear * b[c];
  });
}

void greatest(float* front, const float* back, std::size_t floats) {
  for (std::size_t i = 0; i < floats; ++i) front[i] = front[i] < back[i] ? back[i] : front[i];
}

void least(float* front, const float* back, std::size_t floats) {
  for (std::size_t i = 0; i < floats; ++i) front[i] = back[i] < front[i] ? back[i] : front[i];
}

void sum(float* front, const float* back, std::size_t floats) {
  for (std::size_t i = 0; i < floats; ++i) front[i] += back[i];
}

#else

template <class Combine>
void for_pixels(float* front, const float* back, std::size_t floats, Combine combine) {
  const hn::ScalableTag<float> wide;
  const hn::FixedTag<float, 4> pixel;
  const std::size_t lanes = hn::Lanes(wide);
  std::size_t i = 0;
  for (; i + lanes <= floats; i += lanes)
    hn::StoreU(combine(wide, hn::LoadU(wide, front + i), hn::LoadU(wide, back + i)), wide, front + i);
  for (; i < floats; i += 4)
    hn::StoreU(combine(pixel, hn::LoadU(pixel, front + i), hn::LoadU(pixel, back + i)), pixel, front + i);
}

void over(float* front, const float* back, std::size_t floats) {
  for_pixels(front, back, floats, [](auto d, auto f, auto b) {
    // Rounding may leave alpha slightly above one: the back is then hidden completely, and not subtracted.
    const auto clear = hn::Max(hn::Sub(hn::Set(d, 1.0F), hn::Broadcast<3>(f)), hn::Zero(d));
    return hn::MulAdd(clear, b, f);
  });
}

void greatest(float* front, const float* back, std::size_t floats) {
  for_pixels(front, back, floats, [](auto, auto f, auto b) { return hn::Max(f, b); });
}

void least(float* front, const float* back, std::size_t floats) {
  for_pixels(front, back, floats, [](auto, auto f, auto b) { return hn::Min(f, b); });
}

void sum(float* front, const float* back, std::size_t floats) {
  for_pixels(front, back, floats, [](auto, auto f, auto b) { return hn::Add(f, b); });
}

#endif

}  // namespace understudy::compositor::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace understudy::compositor {

HWY_EXPORT(over);
HWY_EXPORT(greatest);
HWY_EXPORT(least);
HWY_EXPORT(sum);

void blend(volume::Operator op, std::span<float> front, std::span<const float> back) {
  assert(front.size() == back.size() && front.size() % 4 == 0);
  switch (op) {
    case volume::Operator::over:
    case volume::Operator::first_hit:  // for images whose pixels are opaque or empty
      HWY_DYNAMIC_DISPATCH(over)(front.data(), back.data(), front.size());
      break;
    case volume::Operator::max:
      HWY_DYNAMIC_DISPATCH(greatest)(front.data(), back.data(), front.size());
      break;
    case volume::Operator::min:
      HWY_DYNAMIC_DISPATCH(least)(front.data(), back.data(), front.size());
      break;
    case volume::Operator::add:
      HWY_DYNAMIC_DISPATCH(sum)(front.data(), back.data(), front.size());
      break;
  }
}

void blend(volume::Operator op, volume::Image& front, const volume::ImageView& back) {
  const volume::Rect common = intersection(front.rect, back.rect);
  if (common.empty()) return;
  const std::size_t floats = 4 * std::size_t(common.width);
  for (int y = common.y; y < common.y + common.height; ++y) {
    const std::size_t source =
        4 * (std::size_t(y - back.rect.y) * std::size_t(back.rect.width) + std::size_t(common.x - back.rect.x));
    blend(op, std::span(front.at(common.x, y), floats), back.rgba.subspan(source, floats));
  }
}

}  // namespace understudy::compositor
#endif
