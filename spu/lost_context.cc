// SPDX-License-Identifier: Apache-2.0
#include "spu/lost_context.h"

#include <utility>

#include "dispatch/call_words.h"

namespace understudy::spu {
namespace {

struct Lost {
  [[gnu::noinline]] static std::uint64_t call(CallId call, const std::uint64_t*) {
    static constinit thread_local bool told = false;
    if (call == CallId::GetError) return std::exchange(told, true) ? GL_NO_ERROR : GL_OUT_OF_MEMORY;
    const bool asks_for_reset =
        call == CallId::GetGraphicsResetStatus || call == CallId::GetGraphicsResetStatusARB ||
        call == CallId::GetGraphicsResetStatusEXT || call == CallId::GetGraphicsResetStatusKHR;
    return asks_for_reset ? GL_UNKNOWN_CONTEXT_RESET : 0;
  }
};

}  // namespace

const DispatchTable& lost_context() noexcept {
  static const DispatchTable table = [] {
    DispatchTable all{};
    AsWords<Lost>::fill(all);
    return all;
  }();
  return table;
}

}  // namespace understudy::spu
