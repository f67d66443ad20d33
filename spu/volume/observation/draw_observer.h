// SPDX-License-Identifier: Apache-2.0
// The first stage: watches for draws that may be a volume, and keeps them as runs.
//
//   watching ──(a draw that may be a volume)──► deferring ──(any other call, a frame end)──► close the run
//
// The slots of the dispatch table (draw_slots.h and the other *_slots functions) find the observer in the chain
// and tell it what the application does; what a closed run is, the unit above decides.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "spu/chain.h"
#include "spu/volume/context/context.h"
#include "spu/volume/observation/deferred_depth.h"
#include "spu/volume/observation/run.h"
#include "spu/volume/observation/stack_watch.h"
#include "spu/volume/pipeline/program_samplers.h"
#include "spu/volume/refusal/refusal.h"

namespace understudy::spu {

class DrawObserver : public Unit {
 public:
  static constexpr char tag = 'v';

  explicit DrawObserver(Chain& chain) : chain_(chain) {}

  /// That of the chain that is current on this thread, which has one.
  static DrawObserver& current() { return *Chain::current()->find<DrawObserver>(); }

  const char* tag_address() const final { return &tag; }
  void settle() final {
    close_run();
    settle_held();
  }
  void give_up() final;

  /// A draw is about to happen while watching. Opens a run and answers true when it may be a slice.
  bool opens_run();
  bool run_open() const { return run_ != nullptr; }
  Run& run() { return *run_; }
  /// The run is over: its image is in the framebuffer, or its calls are made.
  void close_run();
  /// Runs that wait for others of their volume (in the phase deferring, with no run open) are shown now,
  /// whether or not all are there.
  virtual void settle_held() = 0;

  /// The application is between glBegin and glEnd of a draw that is not deferred: nothing may be asked of
  /// OpenGL.
  bool inside_begin = false;
  /// Between glBeginConditionalRender and glEndConditionalRender, where our own drawing may do nothing.
  bool conditional_render = false;
  /// Between glBeginTransformFeedback and glEndTransformFeedback. From OpenGL 4.0 on a query tells, which knows
  /// of feedback that pauses.
  bool transform_feedback = false;
  StackWatch stacks;
  /// Many 2-D textures of one size: what is drawn with them may be a stack of slices.
  void stack_defined();

  DeferredDepth deferred_depth;
  /// Depth that runs of these volumes would have written is being used: it is watched no longer.
  virtual void depth_looked_at(const std::vector<GLuint>& volumes) = 0;
  /// Some of it is gone, unused.
  virtual void depth_gone() = 0;

  const GlContext& context();
  const DispatchTable& next() const { return chain_.below(*this); }
  Chain& chain() { return chain_; }

 protected:
  /// Why the volume of `texture` is not substituted with `program` whatever the run; null: there is no reason.
  virtual std::optional<Refusal> standing_refusal(GLuint texture, GLuint program) = 0;
  /// No run begins for that reason: of slices drawn one by one, too, that is said once a frame.
  virtual void refuse_in_this_frame(GLuint texture, const Refusal& refusal) = 0;
  /// The image of `run` is in the framebuffer; else its calls are to be made.
  virtual bool substitutes(std::unique_ptr<Run>& run) = 0;
  /// The phase between runs.
  virtual Phase resting_phase() const = 0;
  ProgramSamplers& samplers() { return samplers_; }

  /// Takes away the open run, unmade.
  void drop_run() {
    run_.reset();
    closing_.reset();
  }
  void end_stack_watch();

 private:
  bool begins_run();
  /// The application's own drawing, unless the run has been shown.
  void draw(Run& run);
  /// Null where `pipeline` may begin a run.
  std::optional<Refusal> refusal_of(const Pipeline& pipeline);

  Chain& chain_;
  std::optional<GlContext> context_;
  ProgramSamplers samplers_;
  Records calls_;  ///< of the open run; kept between runs for its memory
  std::unique_ptr<Run> run_;
  std::unique_ptr<Run> closing_;  ///< is being looked at
};

}  // namespace understudy::spu
