// The chain of stream processing units that one OpenGL context's calls run through (Humphreys et al. 2002).
//
// A unit is a set of slots in the dispatch table. For every phase of the stream the chain builds one table a
// unit, starting from a copy of the next unit's: a slot that a unit leaves alone *is* the next unit's pointer,
// down to the driver's own, and costs nothing. Changing the phase is one store: the thread's entry points read
// another table.
#pragma once

#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "dispatch/table.h"

namespace understudy::spu {

/// What the stream is doing, as far as a unit may want other slots for it.
enum class Phase {
  plain,      ///< no volume texture exists: nothing is watched but texture uploads, lists and shaders
  watching,   ///< a volume texture exists: draws are looked at
  deferring,  ///< a run of slices is open: every call but more of the same closes it first
  owing,      ///< watching, and the depth that slices would have written is not there: see volume/depth_debt.h
  compiling,  ///< between glNewList and glEndList: calls are recorded by the driver, not executed
};
constexpr int phase_count = 5;

/// `finish` ends a frame where there is no swap: the buffers keep their contents.
enum class FrameEnd { swap, finish, wait, make_current, destroy };

class Chain;

class Unit {
 public:
  virtual ~Unit() = default;
  /// Tells units apart without run-time type information on the way of every call: the address of the type's
  /// `tag`.
  virtual const char* tag_address() const = 0;
  /// Overrides slots of `table`, which holds the next unit's slots of the same phase.
  virtual void fill(Phase phase, DispatchTable& table) = 0;
  /// Whatever was held back must be in the framebuffer when this returns. The context is current.
  virtual void settle() {}
  /// A frame ends (after the real swap when `kind` is swap).
  virtual void frame_ended(FrameEnd) {}
  /// The context goes away; it may not be current, so no GL call is allowed.
  virtual void abandon() {}
};

/// All context shared state lives in the share group; see track/share_group.h.
class ShareGroup;

class Chain {
 public:
  /// `switch_table` installs a table as the calling thread's; the door provides it.
  Chain(const DispatchTable& driver, std::shared_ptr<ShareGroup> group,
        void (*switch_table)(const DispatchTable*));
  ~Chain();
  Chain(const Chain&) = delete;
  Chain& operator=(const Chain&) = delete;

  /// Appends a unit; the last one stands above the driver.
  template <class T, class... Arguments>
  T& add(Arguments&&... arguments) {
    auto unit = std::make_unique<T>(*this, std::forward<Arguments>(arguments)...);
    T& reference = *unit;
    units_.push_back(std::move(unit));
    return reference;
  }

  /// The chain whose context is current on this thread; null when none is.
  static Chain* current();
  void make_current();
  static void release_current();

  void set_phase(Phase phase);
  Phase phase() const { return phase_; }
  /// The table above which `unit` stands, in the current phase and in a given one.
  const DispatchTable& below(const Unit& unit) const { return below(unit, phase_); }
  const DispatchTable& below(const Unit& unit, Phase phase) const;
  /// The table that calls to `unit` come through.
  const DispatchTable& face(const Unit& unit, Phase phase) const;
  /// The table the application sees.
  const DispatchTable& head(Phase phase) const;
  const DispatchTable& driver() const { return driver_; }
  ShareGroup& group() { return *group_; }

  void settle();
  void frame_ended(FrameEnd kind);
  void abandon();

  /// The unit of type T; null when the chain has none.
  template <class T>
  T* find() const {
    for (const auto& unit : units_) {
      if (unit->tag_address() == &T::tag) return static_cast<T*>(unit.get());
    }
    return nullptr;
  }

 private:
  void build(Phase phase) const;

  const DispatchTable& driver_;
  std::shared_ptr<ShareGroup> group_;
  void (*switch_table_)(const DispatchTable*);
  std::vector<std::unique_ptr<Unit>> units_;
  Phase phase_ = Phase::plain;
  /// tables_[phase][u] is unit u's face; built when the phase is first entered.
  mutable std::array<std::vector<std::unique_ptr<DispatchTable>>, phase_count> tables_;
};

}  // namespace understudy::spu
