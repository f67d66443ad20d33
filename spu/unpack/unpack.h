// SPDX-License-Identifier: Apache-2.0
// The unpack unit: makes the calls in records on the units after it.
#pragma once

#include <string>

#include "spu/pack/record_taker.h"
#include "spu/stream/decode.h"
#include "spu/unit_description.h"

namespace understudy::spu {

class Unpack final : public Unit, public RecordTaker {
 public:
  static constexpr char tag = 'u';

  explicit Unpack(Chain& chain);

  const char* tag_address() const override { return &tag; }
  void fill(Phase, DispatchTable&) override {}

  HandOn when(CallId call, bool inside_begin) override;
  std::uint64_t take(const Records& records, const PackedCall* last) override;

 private:
  Chain& chain_;
  Decoder decoder_;
  std::string last_error_;
};

extern const UnitDescription unpack_description;

}  // namespace understudy::spu
