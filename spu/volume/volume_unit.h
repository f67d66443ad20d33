// SPDX-License-Identifier: Apache-2.0
// The volume unit: recognises volumes in the application's drawing, and has the render nodes draw them.
//
//   observe        keeps draws that may be a volume as a Run                         observation/
//   recognise      makes a RecognisedRun of it: slices, or the box of a ray caster   recognition/
//   classify       finds the colours of its samples                                  classification/, proxy/
//   upload         sends its texels to the nodes                                     upload/
//   compose        composes an ImageRequest                                          request/, slices/, proxy/
//   verify         compares the nodes' image with the application's own              verification/
//   present        puts it where the application would have drawn                    presentation/
//   export         saves it as a scene when the frame has ended, if that is asked    scene_export/
//
// Runs that draw textures of one volume wait for each other between recognition and presentation (merging/).
// When any of the stages throws a Refusal, the application's own draws are replayed unchanged.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <vector>

#include "spu/volume/known_volumes/known_volumes.h"
#include "spu/volume/observation/draw_observer.h"
#include "spu/volume/session/live_settings.h"

namespace understudy::spu {

class RenderSession;

struct ImageRequest;
struct Stages;
struct View;

class VolumeUnit final : public DrawObserver {
 public:
  VolumeUnit(Chain& chain, std::shared_ptr<RenderSession> session);
  ~VolumeUnit() override;

  void fill(Phase phase, DispatchTable& table) override;
  void frame_ended(FrameEnd kind) override;
  void abandon() override;

  /// Every run writes the depth of framebuffer 0 at once: the application may read it in memory, without a call
  /// (OSMesa).
  void never_defer_window_depth() { defers_window_depth_ = false; }
  /// The context draws into this X window from now on; 0: it draws into none.
  void draws_into(std::uintptr_t window) { window_ = window; }

  void settle_held() override;
  void depth_looked_at(const std::vector<GLuint>& volumes) override;
  void depth_gone() override;

 private:
  struct Recognised;
  struct OwnCalls;

  std::optional<Refusal> standing_refusal(GLuint texture, GLuint program) override;
  bool leaves_all(const Pipeline& pipeline) override;
  void refuse_in_this_frame(GLuint texture, const Refusal& refusal) override;
  bool substitutes(std::unique_ptr<Run>& run) override;
  Phase resting_phase() const override;

  /// Created at the first draw that may be a volume, when the context is current.
  Stages& stages();
  /// Returns whether the geometry of consecutive textured quads shows that they are slices of a volume.
  bool is_a_stack(const Run& run);
  /// Records that the run draws a view, and returns it, if images may be late.
  std::optional<View> note_view(const Run& run);
  bool shows(std::unique_ptr<Run>& run);
  void substitute(std::unique_ptr<Run>& run);
  void tidy();
  void show(Run& run, const Recognised& recognised, KnownVolume& volume, compositor::RenderService& service);
  /// After a failed comparison: renders with rounded samples, and refutes rounding as its cause if that image
  /// is wrong, too. The application's own image is still there, so that no further frame has to be drawn twice.
  void try_rounding(const Pipeline& pipeline, const ImageRequest& image, KnownVolume& volume,
                    compositor::RenderService& service);
  /// Returns whether something reads the depth that a run of the volume would write in the bound framebuffer.
  bool depth_is_read(const KnownVolume& volume);
  void forget_deleted_volumes();
  /// Saves the scenes of the frame that ends.
  void export_scenes();
  void take_settings();

  std::shared_ptr<RenderSession> session_;
  LiveSettings settings_;  ///< in effect since the end of this context's last frame
  std::uint64_t settings_version_ = 0;
  KnownVolumes volumes_;
  std::unique_ptr<Stages> stages_;
  bool defers_window_depth_ = true;
  std::uintptr_t window_ = 0;
  std::uint64_t tidied_in_frame_ = 0;
  std::chrono::steady_clock::time_point frame_started_;
};

}  // namespace understudy::spu
