// SPDX-License-Identifier: Apache-2.0
// The chain of stream processing units that one OpenGL context's calls run through (Humphreys et al. 2002).
//
// A unit is a set of slots in the dispatch table. For every phase of the stream the chain builds one table a
// unit, starting from a copy of the next unit's: a slot that a unit leaves alone *is* the next unit's pointer,
// down to the driver's own, and costs nothing. Changing the phase is one store: the thread's entry points read
// another table. What the application calls is a shell around the first unit's table (dispatch/shell.h): where
// a unit throws, the whole chain is given up, and the context is the driver's alone from then on. A unit may
// also replace single slots of its face while the chain runs (Chromium's change of interface): whoever
// inherited the slot sees the new one at once.
#pragma once

#include <cxxabi.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "dispatch/call_id.h"
#include "dispatch/table.h"

namespace understudy::spu {

/// What the stream is doing, as far as a unit may want other slots for it.
enum class Phase {
  plain,           ///< no volume texture exists: nothing is watched but texture uploads, lists and shaders
  watching,        ///< a volume texture exists: draws are looked at
  deferring,       ///< a run of slices is open: every call but more of the same closes it first
  depth_deferred,  ///< watching, and the depth that slices would have written is not there: see
                   ///< volume/depth/deferred_depth_write.h
  compiling,       ///< between glNewList and glEndList: calls are recorded by the driver, not executed
};
constexpr int phase_count = 5;

/// `finish` ends a frame where there is no swap: the buffers keep their contents.
enum class FrameEnd { swap, finish, wait, make_current, destroy };

class Chain;

/// One element of a chain. It may change, replace, discard or add calls; whatever it leaves alone costs
/// nothing. Functions are called on the thread that has the context current, but process_ends().
class Unit {
 public:
  virtual ~Unit() = default;
  /// Tells units apart without run-time type information on the way of every call: the address of the type's
  /// `tag`.
  virtual const char* tag_address() const = 0;
  /// Overrides slots of `table`, which holds the next unit's slots of the same phase. Slots that are null
  /// there, commands that the driver lacks, stay null whatever is put into them.
  virtual void fill(Phase phase, DispatchTable& table) = 0;
  /// Whatever was held back must be in the framebuffer when this returns. The context is current.
  virtual void settle() {}
  /// The chain's context has become current on the calling thread, or stops being it.
  virtual void made_current() {}
  virtual void left() {}
  /// A frame ends (after the real swap when `kind` is swap).
  virtual void frame_ended(FrameEnd) {}
  /// The context goes away; it may not be current, so no GL call is allowed.
  virtual void abandon() {}
  /// The chain is given up: what was held back must be in the framebuffer when this returns, drawn by the next
  /// unit's own functions. Afterwards the unit is told no more than left() and abandon(). The context is
  /// current.
  virtual void give_up() {}
  /// The process may end without another word: figures that belong into a file are written. Called by any
  /// thread.
  virtual void process_ends() {}

 private:
  friend class Chain;
  std::size_t place_ = 0;  ///< in its chain
};

/// All context shared state lives in the share group; see track/share_group.h.
class ShareGroup;

class ServerConnection;

/// What a context is among the contexts of the process.
struct Surroundings {
  std::uint64_t context = 0;           ///< its number
  std::uint64_t shares_with = 0;       ///< number of one that it shares objects with; 0: none
  ServerConnection* server = nullptr;  ///< where its calls are made; null: here
};

/// The units of one context, from the application to the driver. One thread at a time has it current; tables
/// are built when a phase is first entered, and stay where they are.
class Chain {
 public:
  /// `switch_table` installs a table as the calling thread's; the entry library provides it.
  Chain(const DispatchTable& driver, std::shared_ptr<ShareGroup> group,
        void (*switch_table)(const DispatchTable*), Surroundings surroundings = {});
  ~Chain();
  Chain(const Chain&) = delete;
  Chain& operator=(const Chain&) = delete;

  /// Appends a unit; the last one stands above the driver.
  template <class T, class... Arguments>
  T& add(Arguments&&... arguments) {
    auto unit = std::make_unique<T>(*this, std::forward<Arguments>(arguments)...);
    T& reference = *unit;
    add(std::move(unit));
    return reference;
  }
  void add(std::unique_ptr<Unit> unit);
  /// Takes all units away, the last one first, so that calls go straight to the driver. Not while the chain is
  /// current on any thread.
  void remove_units();

  /// The chain whose context is current on this thread; null when none is.
  static Chain* current() { return current_; }
  /// Its context is current on this thread now: units are told, and the table of the present phase is
  /// installed.
  void make_current();
  static void release_current();

  /// One store: the thread's entry points read the table of that phase from now on.
  void set_phase(Phase phase);
  Phase phase() const { return phase_; }
  /// The table above which `unit` stands, in the current phase and in a given one.
  const DispatchTable& below(const Unit& unit) const { return below(unit, phase_); }
  const DispatchTable& below(const Unit& unit, Phase phase) const {
    if (!built(phase)) build(phase);
    return below(unit.place_, phase);
  }
  /// Something went wrong that nobody can mend, for want of memory perhaps: units draw what they hold back, and
  /// from now on calls go straight to the driver. Said once in a process. The context is current on the calling
  /// thread. `trouble` says what went wrong.
  void give_up(const char* trouble) noexcept;
  bool given_up() const { return given_up_; }
  /// What a unit does after the call it was asked for is made: where it fails, the chain is given up and the
  /// call is not made again.
  template <class Work>
  void after_call(Work work) {
    try {
      work();
    } catch (abi::__forced_unwind&) {
      throw;
    } catch (...) {
      give_up_for_exception();
    }
  }
  /// give_up() with what the exception that is being handled says.
  void give_up_for_exception() noexcept;

  /// The table that calls to `unit` come through.
  const DispatchTable& face(const Unit& unit, Phase phase) const;
  /// The first unit's table.
  const DispatchTable& head(Phase phase) const;
  /// What the application calls: head(), out of which nothing thrown gets. A slot that is the driver's own is
  /// the driver's own here too.
  const DispatchTable& guarded_head(Phase phase) const;
  const DispatchTable& driver() const { return driver_; }
  ShareGroup& group() { return *group_; }
  const Surroundings& surroundings() const { return surroundings_; }

  /// Puts `function` into one slot of the face of `unit`, in all phases. Units above it that inherited the slot
  /// inherit the new one, those that override it do not notice.
  void replace_slot(const Unit& unit, CallId call, AnyFunction function);
  template <class Function>
  void replace_slot(const Unit& unit, Function DispatchTable::*member,
                    std::type_identity_t<Function> function) {
    replace_slot(unit, call_of(member), reinterpret_cast<AnyFunction>(function));
  }
  /// Takes that back: the slot is again what fill() makes of it.
  void restore_slot(const Unit& unit, CallId call);
  /// Asks every unit to fill its slots anew, for units whose wishes have changed. The tables stay where they
  /// are.
  void refill();

  /// The following four are handed to every unit, the one nearest to the application first; see Unit.
  void settle();
  void frame_ended(FrameEnd kind);
  void abandon();
  void process_ends();

  /// The unit of type T; null when the chain has none.
  template <class T>
  T* find() const {
    return static_cast<T*>(find(&T::tag));
  }
  Unit* find(const char* tag) const {
    for (const Place& place : units_) {
      if (place.tag == tag) return place.unit.get();
    }
    return nullptr;
  }

 private:
  struct Guard;
  /// Tells every unit; of a chain that was given up, whatever units have to say to that is dropped.
  template <class Told>
  void tell(Told told);
  struct Place {
    const char* tag;  ///< the unit's own; kept here because units are looked up on every call
    std::unique_ptr<Unit> unit;
  };
  /// What a slot was before it was replaced.
  struct Original {
    bool inherited;
    AnyFunction own;  ///< where it was not inherited
  };
  struct Replacement {
    std::size_t place;
    CallId call;
    AnyFunction function;
    std::array<Original, phase_count> originals;  ///< of the phases that are built
  };

  template <class Function>
  CallId call_of(Function DispatchTable::*member) const {
    const auto* slot = reinterpret_cast<const char*>(&(driver_.*member));
    return CallId((slot - reinterpret_cast<const char*>(&driver_)) / std::ptrdiff_t{sizeof(AnyFunction)});
  }

  /// Makes every table the driver's. Units that go delete what they made in OpenGL, and the functions of the
  /// units below them would look for a chain that is current, or for a unit that has gone.
  void return_to_driver();
  /// Where calls go when the chain is given up.
  const DispatchTable& without_units() const;
  void build_guarded(Phase phase) const;
  void guard_slot(Phase phase, CallId call) const;

  bool built(Phase phase) const { return !tables_[std::size_t(phase)].empty(); }
  void build(Phase phase) const;
  const DispatchTable& below(std::size_t place, Phase phase) const {
    return place + 1 < units_.size() ? *tables_[std::size_t(phase)][place + 1] : driver_;
  }
  std::vector<Replacement>::iterator find_replacement(const Unit& unit, CallId call);
  void note_original(Replacement& replacement, Phase phase) const;
  /// Of the unit at `place`, and of the units above it that inherit the slot from there.
  void set_inherited(std::size_t place, Phase phase, CallId call, AnyFunction function);

  /// Read by every call that a unit looks at. The core, opened late, has but few bytes of these, and asking for
  /// their address by function costs 5 ns a call.
  [[gnu::tls_model("initial-exec")]] static constinit thread_local Chain* current_;

  const DispatchTable& driver_;
  std::shared_ptr<ShareGroup> group_;
  const Surroundings surroundings_;
  void (*switch_table_)(const DispatchTable*);
  std::vector<Place> units_;
  mutable std::vector<Replacement> replacements_;
  Phase phase_ = Phase::plain;
  const DispatchTable* guarded_ = nullptr;  ///< head(phase_) while units are asked
  bool given_up_ = false;
  /// tables_[phase][u] is unit u's face; built when the phase is first entered.
  mutable std::array<std::vector<std::unique_ptr<DispatchTable>>, phase_count> tables_;
  mutable std::array<std::unique_ptr<DispatchTable>, phase_count> guarded_tables_;
};

}  // namespace understudy::spu
