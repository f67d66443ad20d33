// The pack unit: turns calls into records and hands them on in blocks (Humphreys et al. 2002).
#pragma once

#include "spu/stream/encode.h"
#include "spu/unit_description.h"

namespace understudy::spu {

class Unpack;

class Pack final : public Unit {
 public:
  static constexpr char tag = '>';

  Pack(Chain& chain, std::size_t block_words);

  const char* tag_address() const override { return &tag; }
  void fill(Phase phase, DispatchTable& table) override;
  void settle() override { hand_on(); }

  std::uint64_t call(CallId call, const std::uint64_t* words);
  /// Everything packed so far is made; answers the result of the last call.
  std::uint64_t hand_on();

 private:
  Chain& chain_;
  const std::size_t block_words_;
  Records records_;
  Encoder encoder_;
  bool handing_on_ = false;
};

extern const UnitDescription pack_description;

}  // namespace understudy::spu
