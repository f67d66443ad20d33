// SPDX-License-Identifier: Apache-2.0
// Functions that build the rows of tables of state (state_rows.h).
#pragma once

#include <algorithm>
#include <initializer_list>
#include <span>

#include "spu/track/state_rows.h"

namespace understudy::spu {

/// For use in tables only: the names are short.
namespace state_row_kinds {

using enum CallId;

constexpr StateRow plain(StateGroup group, CallId set, std::initializer_list<StateQuery> queries) {
  StateRow row{.group = group, .set = set};
  std::copy(queries.begin(), queries.end(), row.queries.begin());
  return row;
}
constexpr StateRow value(CallId set, std::initializer_list<StateQuery> queries) {
  return plain(StateGroup::values, set, queries);
}
/// The call's first argument is the query's name.
constexpr StateRow named(CallId set, GLenum name, int count = 1) {
  StateRow row = value(set, {{name, count}});
  row.named = true;
  return row;
}
constexpr StateRow targeted(StateGroup group, CallId set, GLenum target,
                            std::initializer_list<StateQuery> queries) {
  StateRow row = plain(group, set, queries);
  row.target = target;
  return row;
}
constexpr StateRow from(int version, StateRow row) {
  row.from_version = version;
  return row;
}
constexpr StateRow below(int version, StateRow row) {
  row.below_version = version;
  return row;
}
constexpr StateRow compatibility(StateRow row) {
  row.compatibility = true;
  return row;
}
constexpr StateRow core(StateRow row) {
  row.core = true;
  return row;
}
/// One item each, whose number, starting at `first`, is an argument of the call.
constexpr StateRow each(Per per, GLenum first, StateRow row) {
  row.per = per;
  row.numbered = true;
  row.first_number = first;
  return row;
}
constexpr StateRow asked(Question question, StateRow row) {
  row.question = question;
  return row;
}
/// One item per texture unit, which must be selected.
constexpr StateRow of_unit(Per per, StateRow row) {
  row.per = per;
  row.selector = Selector::texture_unit;
  return row;
}
constexpr StateRow capability(GLenum name) {
  return asked(Question::enabled, plain(StateGroup::capabilities, Enable, {{name, 1}}));
}

constexpr StateRow fixed(CallId set, GLenum name, int count = 1) {
  return compatibility(named(set, name, count));
}

}  // namespace state_row_kinds

/// Lights, materials, texture environments, matrices and current values: state that shaders have replaced.
std::span<const StateRow> fixed_function_rows();

}  // namespace understudy::spu
