// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/observation/state_kinds.h"

#include <string_view>

#include "dispatch/call_shape.h"
#include "dispatch/call_words.h"
#include "spu/track/call_names.h"
#include "spu/volume/observation/draw_observer.h"

namespace understudy::spu {
namespace {

std::uint64_t kind_of_state(CallId call, const std::uint64_t* words) {
  constexpr std::uint64_t prime = 0x100000001b3;
  std::uint64_t kind = std::uint64_t(call) + 1;
  for (const ParameterShape& parameter : call_shape(call).parameters()) {
    const bool names = parameter.pointer == 0 && parameter.type == ValueType::enumeration;
    kind = (kind ^ (names ? *words + 1 : 0)) * prime;
    ++words;
  }
  return kind;
}

struct NoteStateKind {
  static constexpr bool chooses(std::string_view name) { return kind_of_name(name) == CallKind::other; }
  [[gnu::noinline]] static std::uint64_t call(CallId call, const std::uint64_t* words) {
    DrawObserver& observer = DrawObserver::current();
    observer.state_kinds.note(call, words);
    return invoke(observer.next(), call, words);
  }
};

}  // namespace

void StateKinds::note(CallId call, const std::uint64_t* words) {
  const std::uint64_t kind = kind_of_state(call, words);
  if (kind == latest_) return;
  latest_ = kind;
  kinds_.insert(kind);
}

void fill_state_kind_slots(DispatchTable& table) {
  AsWords<NoteStateKind>::fill_chosen(table);
}

}  // namespace understudy::spu
