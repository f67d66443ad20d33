// SPDX-License-Identifier: Apache-2.0
// The first stage: watches for draws that may be a volume, and keeps them as runs.
//
//   watching --(a draw that may be a volume)--> deferring --(any other call, a frame end)--> close the run
//
// The slots of the dispatch table (draw_slots.h and the other *_slots functions) find the observer in the chain
// and report the application's calls to it; the derived unit decides what a closed run is.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "spu/chain.h"
#include "spu/volume/context/context.h"
#include "spu/volume/context/kept_errors.h"
#include "spu/volume/observation/deferred_depth.h"
#include "spu/volume/observation/run.h"
#include "spu/volume/observation/stack_watch.h"
#include "spu/volume/observation/state_kinds.h"
#include "spu/volume/pipeline/program_samplers.h"
#include "spu/volume/refusal/refusal.h"

namespace understudy::spu {

class DrawObserver : public Unit {
 public:
  static constexpr char tag = 'v';

  explicit DrawObserver(Chain& chain) : chain_(chain) {}

  /// Returns the observer of the chain that is current on this thread, which must have one.
  static DrawObserver& current() { return *Chain::current()->find<DrawObserver>(); }

  const char* tag_address() const final { return &tag; }
  void settle() final {
    close_run();
    settle_held();
  }
  void give_up() final;

  /// Called before a draw while watching. Opens a run and returns true if the draw may be a slice.
  bool opens_run();
  bool run_open() const { return run_ != nullptr; }
  Run& run() { return *run_; }
  /// Ends the run: shows its image in the framebuffer, or makes its calls.
  void close_run();
  /// Shows runs that wait for others of their volume (in the phase deferring, with no run open), whether or not
  /// all are there.
  virtual void settle_held() = 0;

  /// The application is between glBegin and glEnd of a draw that is not deferred: OpenGL must not be queried.
  bool inside_begin = false;
  /// Between glBeginConditionalRender and glEndConditionalRender, where our own drawing may have no effect.
  bool conditional_render = false;
  /// Between glBeginTransformFeedback and glEndTransformFeedback. From OpenGL 4.0 on a query is used instead,
  /// which takes paused feedback into account.
  bool transform_feedback = false;
  StateKinds state_kinds;
  StackWatch stacks;
  /// Many 2-D textures of one size were defined: draws with them may be a stack of slices.
  void stack_defined();

  KeptErrors kept_errors;

  DeferredDepth deferred_depth;
  /// Depth that runs of these volumes would have written is being read: it is no longer watched.
  virtual void depth_looked_at(const std::vector<GLuint>& volumes) = 0;
  /// Some deferred depth was cleared before it was read.
  virtual void depth_gone() = 0;

  const GlContext& context();
  const DispatchTable& next() const { return chain_.below(*this); }
  Chain& chain() { return chain_; }

 protected:
  /// Why the volume of `texture` is not substituted with `program`, whatever the run; null if there is no
  /// reason.
  virtual std::optional<Refusal> standing_refusal(GLuint texture, GLuint program) = 0;
  /// Returns whether the application draws all volumes itself for now; counts this draw then.
  virtual bool leaves_all(const Pipeline& pipeline) = 0;
  /// No run begins for this reason, which is reported once per frame even if slices are drawn one by one.
  virtual void refuse_in_this_frame(GLuint texture, const Refusal& refusal) = 0;
  /// Returns false if the calls of `run` are to be made; otherwise its image is shown, or `run` is taken and
  /// waits.
  virtual bool substitutes(std::unique_ptr<Run>& run) = 0;
  /// The phase between runs.
  virtual Phase resting_phase() const = 0;
  ProgramSamplers& samplers() { return samplers_; }

  /// Discards the open run without making its calls.
  void drop_run() {
    run_.reset();
    closing_.reset();
  }
  void end_stack_watch();

 private:
  bool begins_run();
  /// Makes the application's own draws, unless the run has been shown.
  void draw(Run& run);
  /// Null if `pipeline` may begin a run.
  std::optional<Refusal> refusal_of(const Pipeline& pipeline);

  Chain& chain_;
  std::optional<GlContext> context_;
  ProgramSamplers samplers_;
  Records calls_;  ///< of the open run; reused by later runs for its memory
  std::unique_ptr<Run> run_;
  std::unique_ptr<Run> closing_;  ///< is being substituted
};

}  // namespace understudy::spu
