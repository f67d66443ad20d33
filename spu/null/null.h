// SPDX-License-Identifier: Apache-2.0
// The null unit: discards every call, which leaves only the cost of the application's own work.
#pragma once

#include "spu/unit_description.h"

namespace understudy::spu {

class Null final : public Unit {
 public:
  static constexpr char tag = '0';

  const char* tag_address() const override { return &tag; }
  void fill(Phase phase, DispatchTable& table) override;
};

extern const UnitDescription null_description;

}  // namespace understudy::spu
