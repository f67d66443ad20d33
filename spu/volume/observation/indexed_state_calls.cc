// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/observation/indexed_state_calls.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "dispatch/pass_through.h"
#include "spu/chain.h"
#include "spu/track/share_group.h"
#include "spu/volume/observation/draw_observer.h"

namespace understudy::spu {
namespace {

struct NoteIndexedState {
  static constexpr bool chooses(std::string_view name) {
    constexpr std::array<std::string_view, 18> beginnings{"glColorMaski",
                                                          "glColorMaskIndexed",
                                                          "glEnablei",
                                                          "glEnableIndexed",
                                                          "glDisablei",
                                                          "glDisableIndexed",
                                                          "glBlendFunci",
                                                          "glBlendFuncIndexed",
                                                          "glBlendFuncSeparatei",
                                                          "glBlendEquationi",
                                                          "glBlendEquationIndexed",
                                                          "glBlendEquationSeparatei",
                                                          "glViewportIndexed",
                                                          "glBlendFuncSeparateIndexed",
                                                          "glBlendEquationSeparateIndexed",
                                                          "glViewportArray",
                                                          "glScissorIndexed",
                                                          "glScissorArray"};
    return std::ranges::any_of(beginnings, [&](std::string_view each) { return name.starts_with(each); });
  }
  static const DispatchTable& before(CallId) {
    DrawObserver& observer = DrawObserver::current();
    observer.chain().group().indexed_state_set();
    return observer.next();
  }
};

}  // namespace

void fill_indexed_state_slots(DispatchTable& table) {
  PassThrough<NoteIndexedState>::fill_chosen(table);
}

}  // namespace understudy::spu
