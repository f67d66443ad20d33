#include "spu/pack/pack.h"

#include "dispatch/call_words.h"
#include "spu/unpack/unpack.h"

namespace understudy::spu {
namespace {

struct Packed {
  static std::uint64_t call(CallId call, const std::uint64_t* words) {
    return Chain::current()->find<Pack>()->call(call, words);
  }
};

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
  const bool wanted = needs_answer(call) || call == CallId::Flush || call == CallId::Finish;
  // Between glBegin and glEnd the block stays open: what follows may have to be put before glBegin.
  const bool full =
      records_.words().size() + records_.payload().size() >= block_words_ && !encoder_.inside_begin();
  return wanted || full ? hand_on() : 0;
}

std::uint64_t Pack::hand_on() {
  if (records_.empty()) return 0;
  const std::uint64_t result = chain_.find<Unpack>()->make(records_);
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
