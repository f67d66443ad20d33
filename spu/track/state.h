// SPDX-License-Identifier: Apache-2.0
// The state of a context as a value, and the calls that turn one state into another (Buck, Humphreys and
// Hanrahan 2000, "Tracking graphics state for networked rendering").
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dispatch/table.h"
#include "spu/stream/record.h"
#include "spu/track/state_rows.h"

namespace understudy::spu {

/// The values of all rows that apply to the context. Not included: pushed matrices and attributes, pixel maps,
/// the polygon stipple, evaluators, the raster position, array pointers, transform feedback, assembly programs.
class State {
 public:
  struct Item {
    const StateRow* row;
    GLuint number;            ///< 0 if there is only one item
    std::size_t first_value;  ///< index of the first of row->count() values
  };

  /// In the order of state_rows(), then by number.
  std::span<const Item> items() const { return items_; }
  std::span<const double> values(const Item& item) const {
    return std::span(values_).subspan(item.first_value, std::size_t(item.row->count()));
  }
  std::span<double> values(const Item& item) {
    return std::span(values_).subspan(item.first_value, std::size_t(item.row->count()));
  }
  /// Finds an item by the call that sets it, the name of its first query and, unless 0, the call's target; null
  /// if the context has no such item.
  const Item* find(CallId set, GLenum name, GLuint number = 0, GLenum target = 0) const;
  /// Whether the context has a core profile, without fixed function.
  bool core() const { return core_; }

  /// Adds an item and returns its values, which the caller fills in.
  std::span<double> add(const StateRow& row, GLuint number);
  void set_core(bool core) { core_ = core; }

  /// Compares bits, so that a NaN equals itself.
  bool operator==(const State& other) const;

 private:
  std::vector<Item> items_;
  std::vector<double> values_;
  bool core_ = false;
};

/// Queries the state of the current context, which must not be between glBegin and glEnd. Leaves no error.
State read_state(const DispatchTable& gl);

/// Returns the calls that turn a context in state `from` into one in state `to`, to be made by a Decoder.
/// Object names mean the same objects in both; items that one of the contexts lacks are left alone.
Records difference(const State& from, const State& to);

}  // namespace understudy::spu
