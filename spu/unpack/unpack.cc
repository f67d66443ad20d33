#include "spu/unpack/unpack.h"

#include <fmt/format.h>

#include <cstdio>

namespace understudy::spu {

std::uint64_t Unpack::make(const Records& records) {
  std::uint64_t result = 0;
  for (std::size_t at = 0; at < records.words().size();) {
    const auto record = record_at(records.words(), at, records.payload());
    if (!record) {
      fmt::print(stderr, "understudy: unpack: the stream is damaged at word {}; please report this\n", at);
      return 0;
    }
    // A call may change the phase, and with it the table behind us.
    Decoded decoded = decoder_.decode(*record, chain_.below(*this));
    if (!decoded.error.empty() && decoded.error != last_error_) {
      fmt::print(stderr, "understudy: unpack: {}; the call is left out, please report this\n", decoded.error);
      last_error_ = std::move(decoded.error);
    }
    result = decoded.result;
    at += record->words.size();
  }
  return result;
}

constinit const UnitDescription unpack_description{.name = "unpack",
                                                   .help = "makes the calls that pack has turned into records",
                                                   .needs = "pack",
                                                   .make = [](const UnitPlace& place) -> std::unique_ptr<Unit> {
                                                     return std::make_unique<Unpack>(place.chain);
                                                   }};

}  // namespace understudy::spu
