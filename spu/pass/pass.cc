// SPDX-License-Identifier: Apache-2.0
#include "spu/pass/pass.h"

namespace understudy::spu {

constinit const UnitDescription pass_description{
    .name = "pass",
    .help = "passes every call to the next unit, at no cost",
    .position = UnitPosition::repeatable,
    .make = [](const UnitPlace&) -> std::unique_ptr<Unit> { return std::make_unique<Pass>(); }};

}  // namespace understudy::spu
