// SPDX-License-Identifier: Apache-2.0
#include "spu/stream/event.h"

#include <array>
#include <utility>

namespace understudy::spu::event {

const char* name_of(std::uint32_t id) noexcept {
  static constexpr std::array<std::pair<std::uint32_t, const char*>, 10> names = {{
      {arrays, "understudy.arrays"},
      {arrays_end, "understudy.arrays_end"},
      {thread, "understudy.thread"},
      {answers, "understudy.answers"},
      {context, "understudy.context"},
      {current, "understudy.current"},
      {context_gone, "understudy.context_gone"},
      {frame, "understudy.frame"},
      {front_shown, "understudy.front_shown"},
      {mapped_write, "understudy.mapped_write"},
  }};
  for (const auto& [known, name] : names) {
    if (known == id) return name;
  }
  return nullptr;
}

}  // namespace understudy::spu::event
