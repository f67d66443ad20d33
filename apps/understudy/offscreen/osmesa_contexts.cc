// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/offscreen/osmesa_contexts.h"

#include <fmt/format.h>

#include <stdexcept>

#include "dispatch/call_id.h"
#include "volume/offscreen/osmesa.h"

namespace understudy::launcher {

namespace {

bool has_depth_stencil(const spu::RecordedContext& context) {
  return context.depth > 0 || context.stencil > 0;
}

constexpr int accumulation_bits = 16;

}  // namespace

OsmesaContexts::OsmesaContexts() : osmesa_(std::make_unique<volume::offscreen::Osmesa>()) {
  spu::DispatchTable driver{};
  for (std::size_t i = 0; i < spu::call_count; ++i)
    set_slot(driver, spu::CallId(i), spu::AnyFunction(osmesa_->GetProcAddress(spu::call_name(spu::CallId(i)))));
  one_buffer_ = std::make_unique<spu::OneBuffer>(driver);
}

OsmesaContexts::~OsmesaContexts() {
  release_current();
  for (const auto& [number, context] : contexts_) end_context(context.context);
}

/// Contexts have either both depth and stencil or neither, so that drawables can move between contexts.
void* OsmesaContexts::make_context(const spu::RecordedContext& wanted, int version) const {
  const bool depth_stencil = has_depth_stencil(wanted);
  const auto share = contexts_.find(wanted.shares_with);
  return osmesa_->create_context(
      {.version = version,
       .core = is_core(wanted),
       .depth_bits = depth_stencil ? 24 : 0,
       .stencil_bits = depth_stencil ? 8 : 0,
       .accumulation_bits = is_core(wanted) ? 0 : accumulation_bits,
       .share = share == contexts_.end() ? nullptr : static_cast<OSMesaContext>(share->second.context)});
}

void OsmesaContexts::end_context(void* context) const {
  osmesa_->DestroyContext(static_cast<OSMesaContext>(context));
}

void OsmesaContexts::create(const spu::RecordedContext& wanted) {
  Context made;
  made.context = context_for(wanted);
  made.core = is_core(wanted);
  made.double_buffered = wanted.double_buffered;
  made.depth_stencil = has_depth_stencil(wanted);
  contexts_[wanted.number] = std::move(made);
}

OsmesaContexts::Drawable& OsmesaContexts::drawable_of(Context& context, std::uint64_t number) {
  return number == 0 ? context.own : drawables_[number];
}

void OsmesaContexts::bind(Context& context, Drawable& drawable) {
  const auto [width, height] = drawable.extent;
  if (!osmesa_->MakeCurrent(static_cast<OSMesaContext>(context.context), drawable.memory.data(),
                            GL_UNSIGNED_BYTE, width, height)) {
    throw std::runtime_error(
        fmt::format("OSMesa cannot make a drawable of {} x {} pixels current; EGL may: install libegl-mesa0",
                    width, height));
  }
  one_buffer_->made_current(context.double_buffered);
}

bool OsmesaContexts::compiles_a_list(const Context& context) const {
  GLint list = 0;
  if (!context.core) driver().GetIntegerv(GL_LIST_INDEX, &list);
  return list != 0;
}

void OsmesaContexts::take_out(Drawable& drawable) {
  Context& holder = contexts_.at(drawable.holder);
  bind(holder, drawable);
  if (!compiles_a_list(holder))
    drawable.contents = spu::window_contents(driver(), drawable.extent, holder.depth_stencil);
  drawable.holder = 0;
}

void OsmesaContexts::make_current(std::uint64_t number, std::uint64_t drawable, spu::Extent2D extent) {
  current_ = number;
  Context& context = contexts_.at(number);
  Drawable& place = drawable_of(context, drawable);
  std::vector<std::uint8_t> old_memory;  // the current context may write to it until another one is current
  if (place.extent != extent) {
    old_memory = std::move(place.memory);
    place = {.extent = extent,
             .memory = std::vector<std::uint8_t>(std::size_t(4) * std::size_t(extent.width) *
                                                 std::size_t(extent.height)),
             .holder = 0,
             .contents = {}};
  }
  if (place.holder == number) return bind(context, place);
  Drawable& before = drawable_of(context, context.drawable);
  if (before.holder == number) take_out(before);
  if (place.holder != 0) take_out(place);
  bind(context, place);
  context.drawable = drawable;
  spu::WindowContents contents =
      place.contents ? std::move(*place.contents) : spu::cleared_contents(extent, context.depth_stencil);
  contents.depth_stencil.resize(context.depth_stencil ? contents.colours.size() / 4 : 0, spu::far_away);
  if (!compiles_a_list(context)) spu::set_window_contents(driver(), contents);
  place.contents.reset();
  place.holder = number;
}

void OsmesaContexts::release_current() {
  osmesa_->MakeCurrent(nullptr, nullptr, 0, 0, 0);
  current_ = 0;
}

void OsmesaContexts::destroy(std::uint64_t number) {
  const auto found = contexts_.find(number);
  if (found == contexts_.end()) return;
  Context& context = found->second;
  Drawable& drawable = drawable_of(context, context.drawable);
  // Windows outlive contexts, so their contents are saved.
  if (drawable.holder == number && context.drawable != 0) {
    take_out(drawable);
    // Another context may be current.
    const auto other = contexts_.find(current_);
    if (other == contexts_.end() || other == found) {
      release_current();
    } else {
      bind(other->second, drawable_of(other->second, other->second.drawable));
    }
  }
  end_context(context.context);
  contexts_.erase(found);
}

}  // namespace understudy::launcher
