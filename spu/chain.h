// SPDX-License-Identifier: Apache-2.0
// The chain of stream processing units that one OpenGL context's calls run through (Humphreys et al. 2002).
//
// A unit is a set of slots in the dispatch table. For every phase of the stream, the chain builds one table per
// unit, starting from a copy of the next unit's table: a slot that a unit does not override *is* the next
// unit's pointer, down to the driver's own, and costs nothing. Changing the phase is one store: the thread's
// entry points then read another table. The application calls a shell around the first unit's table
// (dispatch/shell.h): if a unit throws, the whole chain is given up, and the context's calls go directly to the
// driver from then on. While the chain runs, a unit may also replace single slots of its table (Chromium's
// change of interface): units that inherited the slot get the new function at once.
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

/// What the stream is doing, as far as units may need other slots for it.
enum class Phase {
  plain,           ///< no volume texture exists: only texture uploads, lists and shaders are watched
  watching,        ///< a volume texture exists: draws are inspected
  deferring,       ///< a run of slices is open: every call that does not continue the run closes it first
  depth_deferred,  ///< watching, and depth that slices would have written has not been written yet: see
                   ///< volume/depth/deferred_depth_write.h
  compiling,       ///< between glNewList and glEndList: calls are recorded by the driver, not executed
};
constexpr int phase_count = 5;

/// `finish` ends a frame if there is no swap: the buffers keep their contents.
enum class FrameEnd { swap, finish, wait, make_current, destroy };

class Chain;

/// One element of a chain. It may change, replace, discard or add calls; slots that it does not override cost
/// nothing. All functions except process_ends() are called on the thread that has the context current.
class Unit {
 public:
  virtual ~Unit() = default;
  /// Identifies the unit's type without run-time type information in the path of every call: the address of the
  /// type's `tag`.
  virtual const char* tag_address() const = 0;
  /// Overrides slots of `table`, which holds the next unit's slots of the same phase. Slots that are null there
  /// (commands that the driver lacks) stay null whatever is stored in them.
  virtual void fill(Phase phase, DispatchTable& table) = 0;
  /// On return, everything that was held back is in the framebuffer. The context is current.
  virtual void settle() {}
  /// The chain's context has become current on the calling thread, or is about to be released.
  virtual void made_current() {}
  virtual void left() {}
  /// A frame ends (after the real swap when `kind` is swap).
  virtual void frame_ended(FrameEnd) {}
  /// The context is being destroyed; it may not be current, so no GL call is allowed.
  virtual void abandon() {}
  /// The chain is given up: on return, everything that was held back is in the framebuffer, drawn with the next
  /// unit's functions. Afterwards only left() and abandon() of the unit are called. The context is current.
  virtual void give_up() {}
  /// The process may end without further notice: writes figures that belong in a file. May be called on any
  /// thread.
  virtual void process_ends() {}

 private:
  friend class Chain;
  std::size_t place_ = 0;  ///< in its chain
};

/// State that contexts share is kept in the share group; see track/share_group.h.
class ShareGroup;

class ServerConnection;

/// Identifies a context among the contexts of the process.
struct Surroundings {
  std::uint64_t context = 0;           ///< its number
  std::uint64_t shares_with = 0;       ///< number of a context that it shares objects with; 0: none
  ServerConnection* server = nullptr;  ///< the server that makes its calls; null: none
};

/// The units of one context, from the application to the driver. Current on one thread at a time. Tables are
/// built when a phase is first entered, and never move.
class Chain {
 public:
  /// `switch_table` installs a table for the calling thread; the entry library provides it.
  Chain(const DispatchTable& driver, std::shared_ptr<ShareGroup> group,
        void (*switch_table)(const DispatchTable*), Surroundings surroundings = {});
  ~Chain();
  Chain(const Chain&) = delete;
  Chain& operator=(const Chain&) = delete;

  /// Appends a unit; the last one is directly above the driver.
  template <class T, class... Arguments>
  T& add(Arguments&&... arguments) {
    auto unit = std::make_unique<T>(*this, std::forward<Arguments>(arguments)...);
    T& reference = *unit;
    add(std::move(unit));
    return reference;
  }
  void add(std::unique_ptr<Unit> unit);
  /// Removes all units, last one first, so that calls go directly to the driver. Not allowed while the chain is
  /// current on any thread.
  void remove_units();

  /// The chain whose context is current on this thread; null when none is.
  static Chain* current() { return current_; }
  /// The chain's context is current on this thread now: notifies the units and installs the table of the
  /// present phase.
  void make_current();
  static void release_current();

  /// Switches the phase with one store: the thread's entry points then read the table of that phase.
  void set_phase(Phase phase);
  Phase phase() const { return phase_; }
  /// The table that `unit` calls, in the current phase or in the given one.
  const DispatchTable& below(const Unit& unit) const { return below(unit, phase_); }
  const DispatchTable& below(const Unit& unit, Phase phase) const {
    if (!built(phase)) build(phase);
    return below(unit.place_, phase);
  }
  /// Gives up the chain after an error that cannot be repaired, such as a lack of memory: units draw what they
  /// hold back, and from now on calls go directly to the driver. Logs `trouble`, the error, once per process.
  /// The context is current on the calling thread.
  void give_up(const char* trouble) noexcept;
  bool given_up() const { return given_up_; }
  /// Runs what a unit does after it has made the requested call: if that throws, the chain is given up, and the
  /// call is not repeated.
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
  /// give_up() with the message of the exception that is being handled.
  void give_up_for_exception() noexcept;

  /// The table through which `unit` is called.
  const DispatchTable& face(const Unit& unit, Phase phase) const;
  /// The first unit's table.
  const DispatchTable& head(Phase phase) const;
  /// What the application calls: head() in a shell that lets no exception out. Slots that are the driver's own
  /// are the driver's own here too.
  const DispatchTable& guarded_head(Phase phase) const;
  const DispatchTable& driver() const { return driver_; }
  ShareGroup& group() { return *group_; }
  const Surroundings& surroundings() const { return surroundings_; }

  /// Stores `function` in one slot of the face of `unit`, in all phases. Units above it that inherited the slot
  /// inherit the new function; those that override it are not affected.
  void replace_slot(const Unit& unit, CallId call, AnyFunction function);
  template <class Function>
  void replace_slot(const Unit& unit, Function DispatchTable::*member,
                    std::type_identity_t<Function> function) {
    replace_slot(unit, call_of(member), reinterpret_cast<AnyFunction>(function));
  }
  /// Undoes replace_slot(): the slot is again what fill() makes of it.
  void restore_slot(const Unit& unit, CallId call);
  /// Lets every unit fill its slots again, for units whose slots depend on a changed setting. The tables do not
  /// move.
  void refill();

  /// The following four are forwarded to every unit, the one nearest to the application first; see Unit.
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
  /// Calls `told` for every unit. If the chain was given up, exceptions of the units are dropped.
  template <class Told>
  void tell(Told told);
  struct Place {
    const char* tag;  ///< the unit's tag; kept here because units are looked up on every call
    std::unique_ptr<Unit> unit;
  };
  /// A slot's value before it was replaced.
  struct Original {
    bool inherited;
    AnyFunction own;  ///< its value if it was not inherited
  };
  struct Replacement {
    std::size_t place;
    CallId call;
    AnyFunction function;
    std::array<Original, phase_count> originals;  ///< of the phases whose tables are built
  };

  template <class Function>
  CallId call_of(Function DispatchTable::*member) const {
    const auto* slot = reinterpret_cast<const char*>(&(driver_.*member));
    return CallId((slot - reinterpret_cast<const char*>(&driver_)) / std::ptrdiff_t{sizeof(AnyFunction)});
  }

  /// Makes every table the driver's. Units that are destroyed delete their OpenGL objects, and the functions of
  /// the units below them would look for a current chain or for a unit that no longer exists.
  void return_to_driver();
  /// The table for calls after the chain was given up.
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
  /// Sets the slot of the unit at `place`, and of the units above it that inherit the slot from there.
  void set_inherited(std::size_t place, Phase phase, CallId call, AnyFunction function);

  /// Read by every call that a unit handles. The core is opened late, so only a few bytes of static TLS are
  /// left for it; getting the address by a function call instead costs 5 ns per call.
  [[gnu::tls_model("initial-exec")]] static constinit thread_local Chain* current_;

  const DispatchTable& driver_;
  std::shared_ptr<ShareGroup> group_;
  const Surroundings surroundings_;
  void (*switch_table_)(const DispatchTable*);
  std::vector<Place> units_;
  mutable std::vector<Replacement> replacements_;
  Phase phase_ = Phase::plain;
  const DispatchTable* guarded_ = nullptr;  ///< head(phase_), which the shells call
  bool given_up_ = false;
  /// tables_[phase][u] is unit u's face; built when the phase is first entered.
  mutable std::array<std::vector<std::unique_ptr<DispatchTable>>, phase_count> tables_;
  mutable std::array<std::unique_ptr<DispatchTable>, phase_count> guarded_tables_;
};

}  // namespace understudy::spu
