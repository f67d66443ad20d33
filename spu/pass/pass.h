// SPDX-License-Identifier: Apache-2.0
// The pass unit: leaves every slot as it is. It shows that a unit that does nothing costs nothing.
#pragma once

#include "spu/unit_description.h"

namespace understudy::spu {

class Pass final : public Unit {
 public:
  static constexpr char tag = '=';

  const char* tag_address() const override { return &tag; }
  void fill(Phase, DispatchTable&) override {}
};

extern const UnitDescription pass_description;

}  // namespace understudy::spu
