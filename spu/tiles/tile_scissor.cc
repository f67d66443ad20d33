// SPDX-License-Identifier: Apache-2.0
#include "spu/tiles/tile_scissor.h"

#include <algorithm>
#include <cstddef>
#include <string_view>

#include "spu/tiles/window_use.h"

namespace understudy::spu {
namespace {

enum class Effect : std::uint8_t {
  none,
  box,         ///< sets the box of all viewports
  capability,  ///< enables or disables the capability in the first argument
  indexed,     ///< affects one viewport
  indexed_capability,
  pushes,
  pops,
  binds,  ///< changes the bound framebuffer
  begins_list,
  ends_list,
  calls_list,
};

Effect find_effect(CallId call) {
  const std::string_view name = call_name(call);
  if (name == "glScissor") return Effect::box;
  if (name.starts_with("glScissor")) return Effect::indexed;
  if (name == "glEnable" || name == "glDisable") return Effect::capability;
  if (name.starts_with("glEnablei") || name.starts_with("glDisablei") || name.starts_with("glEnableIndexed") ||
      name.starts_with("glDisableIndexed")) {
    return Effect::indexed_capability;
  }
  if (name == "glPushAttrib") return Effect::pushes;
  if (name == "glPopAttrib") return Effect::pops;
  if (name.starts_with("glBindFramebuffer") || name.starts_with("glDeleteFramebuffers")) return Effect::binds;
  if (name == "glNewList") return Effect::begins_list;
  if (name == "glEndList") return Effect::ends_list;
  return window_use(call) == WindowUse::lists ? Effect::calls_list : Effect::none;
}

std::array<Effect, call_count> all_effects() {
  std::array<Effect, call_count> effects{};
  for (std::size_t i = 0; i < call_count; ++i) effects[i] = find_effect(CallId(i));
  return effects;
}

Effect effect_of(CallId call) {
  static const std::array<Effect, call_count> effects = all_effects();
  return effects[std::size_t(call)];
}

}  // namespace

Rows rows_of_tile(int height, int part, int parts) {
  const int first = int(std::int64_t(height) * part / parts);
  return {first, int(std::int64_t(height) * (part + 1) / parts) - first};
}

void TileScissor::set(int width, Rows rows) {
  width_ = width;
  rows_ = rows;
  known_ = false;
}

void TileScissor::note(CallId call, const std::uint64_t* words) {
  const Effect effect = effect_of(call);
  if (effect == Effect::none) return;
  if (effect == Effect::begins_list) {
    compiling_ = true;
    pushed_in_list_ = 0;
  } else if (effect == Effect::ends_list) {
    compiling_ = false;
    // State that such a list leaves pushed would include the tile's scissor test.
    if (pushed_in_list_ > 0) lists_touch_scissor_ = true;
  } else if (compiling_) {
    note_compiled(call, words);
  }
  known_ = false;
  indexed_ |= effect == Effect::indexed ||
              (effect == Effect::indexed_capability && GLenum(words[0]) == GL_SCISSOR_TEST);
}

/// If a list changes the scissor test, a tile's scissor test must not be set around it.
void TileScissor::note_compiled(CallId call, const std::uint64_t* words) {
  switch (effect_of(call)) {
    case Effect::capability:
      if (GLenum(words[0]) == GL_SCISSOR_TEST) lists_touch_scissor_ = true;
      break;
    case Effect::box:
    case Effect::indexed:
      lists_touch_scissor_ = true;
      break;
    case Effect::pushes:
      ++pushed_in_list_;
      break;
    case Effect::pops:
      if (--pushed_in_list_ < 0) lists_touch_scissor_ = true;
      break;
    default:
      break;
  }
}

bool TileScissor::begin(const DispatchTable& gl, bool lists) {
  if (compiling_ || indexed_ || (lists && lists_touch_scissor_)) return false;
  if (!known_) {
    GLint framebuffer = 0;
    gl.GetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &framebuffer);
    window_ = framebuffer == 0;
    enabled_ = gl.IsEnabled(GL_SCISSOR_TEST) != GL_FALSE;
    gl.GetIntegerv(GL_SCISSOR_BOX, box_.data());
    known_ = true;
  }
  if (!window_) return false;
  if (enabled_) {
    const int bottom = std::max(box_[1], rows_.first);
    const auto top = int(std::min(std::int64_t(box_[1]) + box_[3], std::int64_t(rows_.first) + rows_.count));
    gl.Scissor(box_[0], bottom, box_[2], std::max(top - bottom, 0));
  } else {
    gl.Scissor(0, rows_.first, width_, rows_.count);
    gl.Enable(GL_SCISSOR_TEST);
  }
  return true;
}

void TileScissor::end(const DispatchTable& gl) const {
  if (!enabled_) gl.Disable(GL_SCISSOR_TEST);
  gl.Scissor(box_[0], box_[1], box_[2], box_[3]);
}

}  // namespace understudy::spu
