// SPDX-License-Identifier: Apache-2.0
// Separate from the unit, because its functions are compiled differently (cmake/forwarding_sources.cmake).
#include "dispatch/call_words.h"
#include "spu/chain.h"
#include "spu/remote/remote.h"

namespace understudy::spu {
namespace {

struct Asked {
  static std::uint64_t call(CallId call, const std::uint64_t* words) {
    Chain* chain = Chain::current();
    Remote* remote = chain == nullptr ? nullptr : chain->find<Remote>();
    return remote == nullptr ? 0 : remote->ask(call, words);
  }
};

}  // namespace

const DispatchTable& remote_driver() {
  static const DispatchTable table = [] {
    DispatchTable all{};
    AsWords<Asked>::fill(all);
    return all;
  }();
  return table;
}

}  // namespace understudy::spu
