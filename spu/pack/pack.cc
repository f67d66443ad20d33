#include "spu/pack/pack.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include "dispatch/call_words.h"
#include "spu/unpack/unpack.h"

namespace understudy::spu {
namespace {

struct Packed {
  static std::uint64_t call(CallId call, const std::uint64_t* words) {
    return Chain::current()->find<Pack>()->call(call, words);
  }
};

/// Calls that make pixels. Within one process nothing is gained by keeping them waiting, and a program may end
/// without another word: by then the driver is no longer able to draw what it had never heard of.
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

constexpr UnitOption options[] = {{.name = "block",
                                   .type = OptionType::integer,
                                   .fallback = "64",
                                   .low = 1,
                                   .high = 65536,
                                   .help = "KiB of calls that are handed on together at most"}};

}  // namespace

Pack::Pack(Chain& chain, std::size_t block_words)
    : chain_(chain), block_words_(block_words), encoder_(chain.driver(), [this] { hand_on(); }) {}

void Pack::fill(Phase, DispatchTable& table) {
  AsWords<Packed>::fill(table);
}

std::uint64_t Pack::call(CallId call, const std::uint64_t* words) {
  encoder_.encode(call, words, records_);
  const bool wanted = needs_answer(call) || call == CallId::Flush || call == CallId::Finish ||
                      (makes_pixels(call) && !encoder_.inside_begin());
  // Between glBegin and glEnd the block stays open: what follows may have to be put before glBegin.
  const bool full =
      records_.words().size() + records_.payload().size() >= block_words_ && !encoder_.inside_begin();
  return wanted || full ? hand_on() : 0;
}

std::uint64_t Pack::hand_on() {
  // A unit behind us may settle the chain while our calls are being made.
  if (records_.empty() || handing_on_) return 0;
  handing_on_ = true;
  const std::uint64_t result = chain_.find<Unpack>()->make(records_);
  handing_on_ = false;
  records_.clear();
  return result;
}

constinit const UnitDescription pack_description{
    .name = "pack",
    .help = "turns calls into records, for unpack behind it",
    .options = options,
    .leads_to = "unpack",
    .make = [](const UnitPlace& place) -> std::unique_ptr<Unit> {
      return std::make_unique<Pack>(place.chain, std::size_t(place.options.integer("block")) * 128);
    }};

}  // namespace understudy::spu
