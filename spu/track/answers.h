// SPDX-License-Identifier: Apache-2.0
// Answers of the driver that are repeated until a call may have changed them (Buck, Humphreys and Hanrahan 2000
// answer queries from tracked state, so that no query waits for a remote renderer).
//
// No value is computed here: how a call's arguments change the state, whether the call is rejected, and how a
// matrix is rounded is left to the driver. A call only invalidates the answers that depend on what it may
// change (state_topics.h). Values of shared objects, which another context can change, are never kept.
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
  /// Replaces the queries in `table`, and makes every other command first note what it changes. `next` is the
  /// table that `table` was copied from.
  void fill(Phase phase, DispatchTable& table, const DispatchTable& next);

  void changed(StateTopics topics) { changed_ |= topics; }
  /// Called for glBegin, or a list that may contain one: queries are errors from then on.
  void perhaps_inside_begin() { known_outside_begin_ = false; }
  void outside_begin() { known_outside_begin_ = true; }

  /// The track unit's own function for a command in this phase; null if the next unit is to be called.
  const DispatchTable* own(Phase phase, CallId call) const;

  /// glGet*v and glGet*i_v: writes to `to` what `ask(T*)` would write.
  template <class T, class Ask>
  void values(CallId call, GLenum name, GLuint index, T* to, Ask ask);
  /// glIsEnabled: `is_known` finds out whether the driver answers other queries of this name.
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

  /// Returns null if the driver must be queried.
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
