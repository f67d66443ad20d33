// SPDX-License-Identifier: Apache-2.0
#include "spu/trace/trace.h"

#include <algorithm>
#include <array>

#include "dispatch/call_words.h"
#include "spu/shared_by_file.h"
#include "spu/state_value.h"
#include "spu/stream/event.h"

namespace understudy::spu {
namespace {

struct Traced {
  static std::uint64_t call(CallId call, const std::uint64_t* words) {
    return Chain::current()->find<Trace>()->call(call, words);
  }
};

constexpr UnitOption trace_options[] = {{.name = "file",
                                         .type = OptionType::file,
                                         .fallback = "trace.ust",
                                         .help = "file to record in, for `understudy replay`"}};

}  // namespace

Trace::Trace(Chain& chain, Recording& recording)
    : chain_(chain), recording_(recording), recorder_(chain.driver()) {}

void Trace::fill(Phase, DispatchTable& table) {
  AsWords<Traced>::fill(table);
}

std::uint64_t Trace::call(CallId call, const std::uint64_t* words) {
  if (call == CallId::Viewport) note_viewport(words);
  recording_.append([&](Records& records) { recorder_.before(call, words, records); });
  // Without the recording's lock, because the call may wait for a call of another thread.
  const std::uint64_t result = invoke(chain_.below(*this), call, words);
  chain_.after_call([&] {
    if (CallRecorder::answers(call)) {
      recording_.append([&](Records& records) { CallRecorder::append_answers(call, words, result, records); });
    }
    recorder_.made(call, words, result);
    if (!recorder_.inside_begin()) recording_.flush(false);
  });
  return result;
}

void Trace::introduce_context() {
  introduced_ = true;
  const DispatchTable& gl = chain_.driver();
  const GLint version = state_value(gl, GL_MAJOR_VERSION) * 100 + state_value(gl, GL_MINOR_VERSION) * 10;
  const GLint profile = version >= 320 ? state_value(gl, GL_CONTEXT_PROFILE_MASK) : 0;
  std::array<std::uint64_t, event::context_words> words = {chain_.surroundings().context,
                                                           chain_.surroundings().shares_with, 0,
                                                           std::uint64_t(version), std::uint64_t(profile)};
  constexpr std::array<GLenum, 8> names = {GL_RED_BITS,   GL_GREEN_BITS,   GL_BLUE_BITS, GL_ALPHA_BITS,
                                           GL_DEPTH_BITS, GL_STENCIL_BITS, GL_SAMPLES,   GL_DOUBLEBUFFER};
  // Core profiles do not support the old queries; windows usually have eight bits per channel and 24 of depth.
  constexpr std::array<GLint, 8> usual = {8, 8, 8, 8, 24, 8, 0, 1};
  const bool core = (profile & GL_CONTEXT_CORE_PROFILE_BIT) != 0;
  for (std::size_t i = 0; i < names.size(); ++i)
    words[5 + i] = std::uint64_t(core && i < 6 ? usual[i] : state_value(gl, names[i]));
  recording_.append([&](Records& records) { records.append_plain(event::context, words); });
}

void Trace::tell_current() {
  const std::uint64_t words[] = {chain_.surroundings().context, drawable_.width, drawable_.height};
  recording_.append([&](Records& records) { records.append_plain(event::current, words); });
}

void Trace::made_current() {
  if (!introduced_) {
    introduce_context();
    std::array<GLint, 4> viewport{};
    chain_.driver().GetIntegerv(GL_VIEWPORT, viewport.data());
    drawable_ = {std::uint64_t(viewport[2]), std::uint64_t(viewport[3])};
  }
  tell_current();
}

void Trace::left() {
  constexpr std::uint64_t nothing[] = {0, 0, 0};
  recording_.append([&](Records& records) { records.append_plain(event::current, nothing); });
  recording_.flush(true);
}

void Trace::note_viewport(const std::uint64_t* words) {
  if (recorder_.inside_begin() || state_value(chain_.driver(), GL_DRAW_FRAMEBUFFER_BINDING) != 0) return;
  const auto extent = [&](std::size_t at) {
    return std::uint64_t(
        std::max<std::int64_t>(std::int32_t(words[at]) + std::int64_t(std::int32_t(words[at + 2])), 0));
  };
  in_frame_ = {std::max(in_frame_.width, extent(0)), std::max(in_frame_.height, extent(1))};
  if (in_frame_.width <= drawable_.width && in_frame_.height <= drawable_.height) return;
  drawable_ = {std::max(in_frame_.width, drawable_.width), std::max(in_frame_.height, drawable_.height)};
  tell_current();
}

void Trace::frame_ended(FrameEnd kind) {
  if (kind != FrameEnd::swap && kind != FrameEnd::finish) return;
  const Extent shown = in_frame_ == Extent{} ? drawable_ : in_frame_;
  recording_.end_frame(shown.width, shown.height);
  in_frame_ = {};
  if (shown == drawable_) return;
  drawable_ = shown;
  tell_current();
}

void Trace::abandon() {
  const std::uint64_t words[] = {chain_.surroundings().context};
  recording_.append([&](Records& records) { records.append_plain(event::context_gone, words); });
  recording_.flush(true);
}

constinit const UnitDescription trace_description{
    .name = "trace",
    .help = "records every call in a file, for `understudy replay`",
    .options = trace_options,
    .make = [](const UnitPlace& place) -> std::unique_ptr<Unit> {
      return std::make_unique<Trace>(place.chain, shared_by_file<Recording>(place.options.text("file")));
    }};

}  // namespace understudy::spu
