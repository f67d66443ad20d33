// The unpack unit: makes the calls of records on the units behind it.
#pragma once

#include <string>

#include "spu/stream/decode.h"
#include "spu/unit_description.h"

namespace understudy::spu {

class Unpack final : public Unit {
 public:
  static constexpr char tag = 'u';

  explicit Unpack(Chain& chain) : chain_(chain) {}

  const char* tag_address() const override { return &tag; }
  void fill(Phase, DispatchTable&) override {}

  /// Makes the calls, in order; answers the result of the last one.
  std::uint64_t make(const Records& records);

 private:
  Chain& chain_;
  Decoder decoder_;
  std::string last_error_;
};

extern const UnitDescription unpack_description;

}  // namespace understudy::spu
