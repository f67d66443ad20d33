// SPDX-License-Identifier: Apache-2.0
// The volume unit: recognises volumes in the application's drawing, and lets the render nodes draw them.
//
//   observe        draws are kept as a Run while they may be a volume                 observation/
//   recognise      what the run is: a RecognisedRun of slices, or of a ray caster     recognition/
//   classify       which colours its samples have                                     classification/, proxy/
//   upload         its texels go to the nodes                                         upload/
//   compose        an ImageRequest                                                    request/, slices/, proxy/
//   verify         the nodes' image is compared with the application's own            verification/
//   present        and put where the application would have drawn                     presentation/
//
// Runs through the textures of one volume wait between recognition and presentation for each other (merging/).
// A Refusal on that way ends in the application's own drawing: the run is replayed as it was.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <vector>

#include "spu/volume/known_volumes/known_volumes.h"
#include "spu/volume/observation/draw_observer.h"

namespace understudy::spu {

class RenderSession;

struct ImageRequest;
struct Stages;

class VolumeUnit final : public DrawObserver {
 public:
  VolumeUnit(Chain& chain, std::shared_ptr<RenderSession> session);
  ~VolumeUnit() override;

  void fill(Phase phase, DispatchTable& table) override;
  void frame_ended(FrameEnd kind) override;
  void abandon() override;

  void settle_held() override;
  void depth_looked_at(const std::vector<GLuint>& volumes) override;
  void depth_gone() override;

 private:
  struct Recognised;

  std::optional<Refusal> standing_refusal(GLuint texture, GLuint program) override {
    return volumes_.standing_refusal(texture, program);
  }
  void refuse_in_this_frame(GLuint texture, const Refusal& refusal) override;
  bool substitutes(std::unique_ptr<Run>& run) override;
  Phase resting_phase() const override;

  /// Made with the first draw that may be a volume, when the context is current.
  Stages& stages();
  /// Textured quads in a row are no volume until their geometry says so.
  bool is_a_stack(const Run& run);
  bool shows(std::unique_ptr<Run>& run);
  void substitute(std::unique_ptr<Run>& run);
  void tidy();
  void show(Run& run, const Recognised& recognised, KnownVolume& volume, compositor::RenderService& service);
  /// After a lost comparison: refutes that rounded samples explain it, where their image is wrong as well. The
  /// application's own image is at hand, so that no other frame has to be drawn twice to learn this.
  void try_rounding(const Pipeline& pipeline, const ImageRequest& image, KnownVolume& volume,
                    compositor::RenderService& service);
  void forget_deleted_volumes();

  std::shared_ptr<RenderSession> session_;
  KnownVolumes volumes_;
  std::unique_ptr<Stages> stages_;
  std::uint64_t tidied_in_frame_ = 0;
  std::chrono::steady_clock::time_point frame_started_;
};

}  // namespace understudy::spu
