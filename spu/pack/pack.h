// SPDX-License-Identifier: Apache-2.0
// The pack unit: turns calls into records and hands them on in blocks (Humphreys et al. 2002), to unpack or to
// link.
#pragma once

#include "spu/pack/record_taker.h"
#include "spu/stream/encode.h"
#include "spu/unit_description.h"

namespace understudy::spu {

class Pack final : public Unit {
 public:
  static constexpr char tag = '>';

  Pack(Chain& chain, std::size_t block_words);

  /// Told by the unit behind it, which takes what is packed.
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
  /// Everything packed so far is made; answers the result of `last`, when somebody waits for it.
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
