// SPDX-License-Identifier: Apache-2.0
#include "spu/unpack/unpack.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <string_view>
#include <vector>

#include "compositor/logging/log.h"
#include "spu/pack/pack.h"
#include "spu/stream/encode.h"

namespace understudy::spu {
namespace {

/// Calls that draw. Within one process nothing is gained by delaying them, and a program may end without
/// notice: what the driver has not received by then is never drawn.
bool makes_pixels(CallId call) {
  static const std::vector<bool> all = [] {
    constexpr std::array<std::string_view, 14> beginnings = {
        "glDraw",      "glMultiDraw", "glEnd",   "glCallList", "glRect",     "glClear",    "glBitmap",
        "glCopyPixel", "glBlit",      "glEvalM", "glAccum",    "glDispatch", "glGenerate", "glArrayElement"};
    std::vector<bool> table(call_count);
    for (std::size_t i = 0; i < call_count; ++i) {
      const std::string_view name = call_name(CallId(i));
      table[i] = std::any_of(beginnings.begin(), beginnings.end(),
                             [&](auto start) { return name.starts_with(start); });
    }
    return table;
  }();
  return all[std::size_t(call)];
}

}  // namespace

Unpack::Unpack(Chain& chain) : chain_(chain) {
  chain.find<Pack>()->hand_to(*this);
}

HandOn Unpack::when(CallId call, bool inside_begin) {
  if (needs_answer(call)) return HandOn::and_wait;
  const bool ends = call == CallId::Flush || call == CallId::Finish;
  return ends || (makes_pixels(call) && !inside_begin) ? HandOn::now : HandOn::later;
}

std::uint64_t Unpack::take(const Records& records, const PackedCall* /*last*/) {
  std::uint64_t result = 0;
  for (std::size_t at = 0; at < records.words().size();) {
    const auto record = record_at(records.words(), at, records.payload());
    if (!record) {
      logging::log(logging::Level::error, "unpack: the stream is damaged at word {}; please report this", at);
      return 0;
    }
    // A call may change the phase, and with it the table of the next unit.
    Decoded decoded = decoder_.decode(*record, chain_.below(*this));
    if (!decoded.error.empty() && decoded.error != last_error_) {
      logging::log(logging::Level::warn, "unpack: {}; the call is left out, please report this", decoded.error);
      last_error_ = std::move(decoded.error);
    }
    result = decoded.result;
    at += record->words.size();
  }
  return result;
}

constinit const UnitDescription unpack_description{
    .name = "unpack",
    .help = "executes the calls that pack has encoded into records",
    .needs = "pack",
    .make = [](const UnitPlace& place) -> std::unique_ptr<Unit> {
      return std::make_unique<Unpack>(place.chain);
    }};

}  // namespace understudy::spu
