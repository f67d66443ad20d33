// SPDX-License-Identifier: Apache-2.0
#include "spu/null/null.h"

#include "dispatch/call_words.h"

namespace understudy::spu {
namespace {

struct NullCall {
  static std::uint64_t call(CallId, const std::uint64_t*) { return 0; }
};

}  // namespace

void Null::fill(Phase, DispatchTable& table) {
  AsWords<NullCall>::fill(table);
}

constinit const UnitDescription null_description{
    .name = "null",
    .help = "discards every call: results are 0, and memory that OpenGL would write to stays unchanged",
    .make = [](const UnitPlace&) -> std::unique_ptr<Unit> { return std::make_unique<Null>(); }};

}  // namespace understudy::spu
