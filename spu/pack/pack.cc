// SPDX-License-Identifier: Apache-2.0
#include "spu/pack/pack.h"

#include <exception>

#include "dispatch/call_words.h"

namespace understudy::spu {
namespace {

/// In scope while a call is packed: if that throws, all of the call's records are removed.
class WholeRecords {
 public:
  explicit WholeRecords(Records& records) : records_(records), words_(records.words().size()) {}
  ~WholeRecords() {
    if (std::uncaught_exceptions() > exceptions_) records_.rewind(words_);
  }
  WholeRecords(const WholeRecords&) = delete;
  WholeRecords& operator=(const WholeRecords&) = delete;

 private:
  Records& records_;
  const std::size_t words_;
  const int exceptions_ = std::uncaught_exceptions();
};

struct Packed {
  static std::uint64_t call(CallId call, const std::uint64_t* words) {
    return Chain::current()->find<Pack>()->call(call, words);
  }
};

constexpr UnitOption pack_options[] = {
    {.name = "block",
     .type = OptionType::integer,
     .fallback = "64",
     .low = 1,
     .high = 65536,
     .help = "largest size of the records that are passed on together, in KiB"}};

}  // namespace

Pack::Pack(Chain& chain, std::size_t block_words)
    : block_words_(block_words), encoder_(chain.driver(), [this] {
        if (taker_->in_this_process()) hand_on();
      }) {}

void Pack::fill(Phase, DispatchTable& table) {
  AsWords<Packed>::fill(table);
}

std::uint64_t Pack::call(CallId call, const std::uint64_t* words) {
  if (const auto known = taker_->known(call, words)) return *known;
  {
    const WholeRecords whole(records_);
    taker_->before(call, words, records_);
    encoder_.encode(call, words, records_);
  }
  const HandOn when = taker_->when(call, encoder_.inside_begin());
  if (when == HandOn::and_wait) {
    const PackedCall last{call, words};
    return hand_on(&last);
  }
  // Between glBegin and glEnd the block stays open: later records may have to be inserted before glBegin.
  const bool full =
      records_.words().size() + records_.payload().size() >= block_words_ && !encoder_.inside_begin();
  if (when == HandOn::now || full) hand_on();
  return 0;
}

std::uint64_t Pack::hand_on(const PackedCall* last) {
  // A unit below may settle the chain while our calls are being made.
  if (records_.empty() || handing_on_) return 0;
  // The records are cleared even if taking them fails: no call is made twice.
  struct HandedOn {
    Pack& pack;
    ~HandedOn() {
      pack.handing_on_ = false;
      pack.records_.clear();
    }
  } const handed_on{*this};
  handing_on_ = true;
  return taker_->take(records_, last);
}

constinit const UnitDescription pack_description{
    .name = "pack",
    .help = "encodes calls into records, for unpack or remote after it",
    .options = pack_options,
    .leads_to = "unpack",
    .or_leads_to = "remote",
    .make = [](const UnitPlace& place) -> std::unique_ptr<Unit> {
      return std::make_unique<Pack>(place.chain, std::size_t(place.options.integer("block")) * 128);
    }};

}  // namespace understudy::spu
