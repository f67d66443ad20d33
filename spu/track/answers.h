// SPDX-License-Identifier: Apache-2.0
// Answers of the driver that are given again until a call could have changed them (Buck, Humphreys and Hanrahan
// 2000 answer queries from tracked state, so that no query waits for a remote renderer).
//
// No value is ever worked out here: what a call makes of its arguments, whether it is refused, and how a matrix
// is rounded, stays the driver's business. A call only makes the answers stale that depend on what it may
// change (state_topics.h). Values that another context can change, those of shared objects, are never kept.
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <unordered_map>

#include "dispatch/call_id.h"
#include "dispatch/table.h"
#include "spu/chain.h"
#include "spu/track/state_topics.h"

namespace understudy::spu {

class Answers {
 public:
  /// Puts the queries into `table`, and in front of every other command a note of what it changes. `next` is
  /// the table that `table` was made from.
  void fill(Phase phase, DispatchTable& table, const DispatchTable& next);

  void changed(StateTopics topics) { changed_ |= topics; }
  /// glBegin perhaps, or a list that may hold one: a query is an error then.
  void perhaps_inside_begin() { known_outside_begin_ = false; }
  void outside_begin() { known_outside_begin_ = true; }

  /// What track itself does for a command in this phase; null where the next unit is to be called.
  const DispatchTable* own(Phase phase, CallId call) const;

  /// glGet*v and glGet*i_v: writes to `to` what `ask(T*)` would.
  template <class T, class Ask>
  void values(CallId call, GLenum name, GLuint index, T* to, Ask ask);
  /// glIsEnabled: `is_known` says whether the driver answers other queries of this name.
  template <class Ask, class IsKnown>
  GLboolean enabled(CallId call, GLenum name, GLuint index, Ask ask, IsKnown is_known);
  /// glGetString and glGetStringi.
  template <class Ask>
  const GLubyte* text(CallId call, GLenum name, GLuint index, Ask ask);

 private:
  struct Query {
    CallId call;
    GLenum name;
    GLuint index;
    bool operator==(const Query&) const = default;
  };
  struct Hash {
    std::size_t operator()(const Query& query) const {
      std::uint64_t bits = std::uint64_t(query.name) << 32U | query.index;
      bits = (bits ^ std::uint64_t(query.call) << 20U) * 0x9e3779b97f4a7c15U;
      return std::size_t(bits ^ bits >> 32U);
    }
  };
  struct Answer {
    StateTopics topics = topic::nothing;
    std::uint64_t asked_at = 0;
    std::size_t size = 0;  ///< bytes
    alignas(8) std::array<std::byte, max_state_values * sizeof(double)> bytes{};
  };
  struct Own {
    DispatchTable table{};
    std::bitset<call_count> overridden;
  };

  /// Null when it must be asked.
  const Answer* find(const Query& query);
  void keep(const Query& query, StateTopics topics, const void* bytes, std::size_t size);

  std::unordered_map<Query, Answer, Hash> answers_;
  StateTopics changed_ = topic::everything;  ///< since the last query
  std::uint64_t now_ = 0;
  std::array<std::uint64_t, 32> changed_at_{};  ///< by topic
  bool known_outside_begin_ = false;
  std::array<std::unique_ptr<Own>, phase_count> own_;
};

}  // namespace understudy::spu
