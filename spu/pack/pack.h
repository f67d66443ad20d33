// SPDX-License-Identifier: Apache-2.0
// The pack unit: encodes calls into records and passes them on in blocks (Humphreys et al. 2002), to unpack or
// to remote.
#pragma once

#include "spu/pack/record_taker.h"
#include "spu/stream/encode.h"
#include "spu/unit_description.h"

namespace understudy::spu {

class Pack final : public Unit {
 public:
  static constexpr char tag = '>';

  Pack(Chain& chain, std::size_t block_words);

  /// Called by the unit after it in the chain, which takes the packed records.
  void hand_to(RecordTaker& taker) {
    taker_ = &taker;
    if (!taker.in_this_process()) encoder_.hide_addresses();
  }

  const char* tag_address() const override { return &tag; }
  void fill(Phase phase, DispatchTable& table) override;
  void settle() override { hand_on(); }
  void give_up() override { hand_on(); }

  bool inside_begin() const { return encoder_.inside_begin(); }

  std::uint64_t call(CallId call, const std::uint64_t* words);
  /// Passes on everything packed so far; returns the result of `last` if that is not null.
  std::uint64_t hand_on(const PackedCall* last = nullptr);

 private:
  RecordTaker* taker_ = nullptr;
  const std::size_t block_words_;
  Records records_;
  Encoder encoder_;
  bool handing_on_ = false;
};

extern const UnitDescription pack_description;

}  // namespace understudy::spu
