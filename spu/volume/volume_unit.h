// The volume unit: watches for runs of slices, and lets the render nodes play their part.
//
//   watching ──(a draw that may be a volume)──► deferring ──(any other call, a frame end)──► close the run:
//     observe geometry → fit camera → find slices → classification → texels (once) → render → present
//   Runs through the textures of one volume wait between recognition and render for each other (merging/).
//   Any refusal on that way ends in the application's own drawing: the run is replayed as it was.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "spu/chain.h"
#include "spu/report/counters.h"
#include "spu/volume/budget/budget.h"
#include "spu/volume/classification/probe.h"
#include "spu/volume/classification/sample_rounding.h"
#include "spu/volume/context/context.h"
#include "spu/volume/geometry/slices.h"
#include "spu/volume/observation/run.h"
#include "spu/volume/observation/stack_detection.h"
#include "spu/volume/pipeline/program_samplers.h"
#include "spu/volume/presentation/present.h"
#include "spu/volume/proxy/march.h"
#include "spu/volume/recognition/program_check.h"
#include "spu/volume/session/render_session.h"
#include "spu/volume/timing/frame_clock.h"
#include "spu/volume/timing/speed_guard.h"
#include "spu/volume/upload/block_hashes.h"
#include "spu/volume/verification/schedule.h"
#include "volume/description.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/texture_space.h"

namespace understudy::spu {

struct ImageDifference;
struct NativeImage;
class NativeDrawing;
struct MergedVolume;
struct Transferred;

/// What is remembered of one texture between frames.
struct KnownVolume {
  volume::VolumeDescription description;  ///< as the service has it
  std::uint64_t generation = 0;           ///< of the service that has it; 0: none
  std::uint64_t texture_version = 0;      ///< of the texture, whose texels it has
  BlockHashes hashes;                     ///< of the texels that it has
  TextureDescription texture;
  std::array<float, 2> range{0, 1};
  std::optional<Probed> probed;
  std::vector<float> probed_under;  ///< the state that decides what probing finds
  std::optional<March> march;       ///< how its ray caster marches, where it is drawn by one
  MarchInputs march_inputs;         ///< what the march was measured under
  bool depth_looked_at = false;     ///< somebody used the depth that its slices write
  std::string handed_back;          ///< why the volume is not substituted for good; empty: it is not
  std::string left_inside;          ///< why it is left while the eye is inside; empty: it is not
  bool verified_inside = false;     ///< an image with the eye inside was like the application's
  std::string last_reason;          ///< the last reason for leaving it that was said
  int refusals = 0;                 ///< in a row
  std::uint64_t left_in_frame = ~std::uint64_t(0);
  std::uint64_t frames = 0;
  VerificationSchedule verification;
  SampleRounding sample_rounding;
  SpeedGuard speed;
  volume::Matrix4 camera{};        ///< of the last image of its ray caster, from texture to clip coordinates
  std::uint64_t next_try = 0;      ///< the frame from which on it is tried again, after a lost comparison
  std::unique_ptr<Budget> budget;  ///< where an error or a time is asked for
  VolumeCounters* counters = nullptr;
};

class VolumeUnit final : public Unit {
 public:
  static constexpr char tag = 'v';

  VolumeUnit(Chain& chain, std::shared_ptr<RenderSession> session);
  ~VolumeUnit() override;

  const char* tag_address() const override { return &tag; }
  void fill(Phase phase, DispatchTable& table) override;
  void settle() override {
    close_run();
    settle_held();
  }
  void frame_ended(FrameEnd kind) override;
  void abandon() override;

  /// A draw is about to happen while watching. Opens a run and answers true when it may be a slice.
  bool opens_run();
  bool run_open() const { return run_ != nullptr; }
  Run& run() { return *run_; }
  void close_run();
  /// Runs that wait for the others of their volume (in the phase deferring, with no run open) are shown now,
  /// whether or not all are there.
  void settle_held();

  /// The application is between glBegin and glEnd of a draw that is not deferred: nothing may be asked of
  /// OpenGL.
  bool inside_begin = false;
  /// Between glBeginConditionalRender and glEndConditionalRender, where our own drawing may do nothing.
  bool conditional_render = false;
  /// Many 2-D textures of one size: what is drawn with them may be a stack of slices.
  void stack_defined();
  StackDetection stack_detection;

  /// The depth that the last substituted slices would have written is being used; or is gone, unused.
  void depth_looked_at();
  void depth_cleared();

  const GlContext& context();
  const DispatchTable& next() const { return chain_.below(*this); }
  Chain& chain() { return chain_; }

 private:
  struct Substitution;
  struct RenderedImage;
  struct Merging;

  /// The image of the run is in the framebuffer; else the application's calls are to be played.
  bool shows(std::unique_ptr<Run>& closed);
  void substitute(std::unique_ptr<Run>& closed);
  bool begins_run();
  KnownVolume& known(GLuint texture);
  void observe(Substitution& s);
  bool is_a_stack(const Run& run);
  /// Ends the watch for stacks where none is drawn.
  void leave_stacks();
  void stop_watching_stacks();
  void find_geometry(Substitution& s);
  void describe_volume(Substitution& s);
  void upload(Substitution& s, compositor::RenderService& service);
  void count_transferred(VolumeCounters& volume, const Transferred& transferred, const char* why);
  /// Why colours are found out, empty where they are known.
  std::string_view why_probed(const KnownVolume& known, const std::vector<float>& key,
                              const InputRange& range) const;
  /// An empty reason: colours were known.
  void count_probe(std::string_view why);
  void classify(Substitution& s);
  void place_fog(Substitution& s, const MeasuredFog& measured);
  void compose_request(Substitution& s);
  void compose_proxy_request(Substitution& s, compositor::RenderService& service);
  /// The march whose image is most like the application's.
  March choose_march(Substitution& s, compositor::RenderService& service, const std::vector<March>& marches);
  /// From the nodes' image of a ray caster to what it shows, together with the parts that cropping has left
  /// behind the nearest.
  void complete_image(Substitution& s, compositor::RenderService& service, const March& march,
                      volume::Image& image, volume::FrameCounts& counts);
  void hide_behind_geometry(Substitution& s);
  /// Renders the request and puts the image where the slices would be; `check` sees it before, and may throw.
  volume::FrameCounts show(compositor::RenderService& service, Substitution& s,
                           const std::function<void(const volume::ImageView&)>& check);
  /// Not every image of the nodes is what the application shows of it.
  static bool is_finished_here(const Substitution& s);
  bool may_be_behind(const Substitution& s);
  void cast_own_samples(compositor::RenderService& service, Substitution& s, RenderedImage& image);
  /// With samples as the error or the time that was asked for wants them; false where they must be the
  /// application's own.
  bool cast_within_budget(compositor::RenderService& service, Substitution& s, RenderedImage& image);
  bool to_be_verified(const Substitution& s) const;
  void verify(Substitution& s, const volume::ImageView& image);
  void compare_whole(Substitution& s, const volume::ImageView& image);
  void compare_sentinels(Substitution& s, const volume::ImageView& image);
  /// Throws Refusal where the image is beyond the bound.
  void judge(KnownVolume& known, const ImageDifference& difference, double native_ms);
  void count_difference(KnownVolume& known, const ImageDifference& difference);
  /// The application draws this frame, and the volume is measured anew.
  [[noreturn]] void lose(KnownVolume& known, const ImageDifference& difference);
  NativeDrawing& sentinel_drawing(const Substitution& s);
  /// What the text of the run's program says now. Throws Refusal where it is not understood.
  const ProgramFindings& findings(const Substitution& s, std::span<const UniformValue> values);
  void explain(const Substitution& s, std::string_view beginning = {});
  void count_substituted(KnownVolume& known, const volume::FrameCounts& counts);

  // Volumes that lie in many textures: merging/merged_substitution.cc.
  void note_brick(const Substitution& s);
  void find_merged_volumes();
  void forget_merged_volume(GLuint texture);
  void forget_deleted_bricks();
  /// The run waits for the others of its volume, and is this unit's from now on.
  bool holds(std::unique_ptr<Run>& run, Substitution& s);
  struct HeldRun;
  bool shows_as_one(MergedVolume& merged, std::vector<HeldRun>& held);
  void compose_merged_request(MergedVolume& merged, const std::vector<HeldRun>& held, Substitution& whole);
  void upload_merged(MergedVolume& merged, const std::vector<HeldRun>& held,
                     compositor::RenderService& service);
  /// Needs the session's lock.
  void forget_single_bricks(const MergedVolume& merged);
  /// One run that waited, by whatever service there is.
  void show_alone(Substitution& s);

  /// The phase between runs.
  Phase resting_phase() const;
  void settle_depth(const Substitution& s);
  void leave(GLuint texture, const std::string& reason, bool say = true);
  /// Why the application draws the volume now, before anything is known of the draw; empty: there is no reason.
  std::string why_left(GLuint texture);
  void count_speed(GLuint texture, const FrameShares& spent);
  void forget_deleted_volumes();
  /// To what this context did since the last frame end, `change` is made.
  template <class Change>
  void note(Change change) {
    GLint framebuffer = 0;
    context().gl->GetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &framebuffer);
    session_->ledger().note(this, framebuffer == 0, change);
  }
  const ProgramStages& stages(GLuint program, const ProgramRecord& record);

  Chain& chain_;
  std::shared_ptr<RenderSession> session_;
  std::optional<GlContext> context_;
  std::unique_ptr<Presenter> presenter_;
  Records calls_;  ///< of the open run; kept between runs for its memory
  std::unique_ptr<Run> run_;
  std::map<GLuint, KnownVolume> known_;
  std::unique_ptr<Merging> merging_;
  bool stacks_watched_ = false;
  bool stacks_possible_ = false;  ///< while they are watched: rows of textures may still be one
  int frames_without_stack_ = 0;
  int other_stacks_ = 0;  ///< runs through many 2-D textures that were no volume, since the last that was
  ProgramSamplers samplers_;
  std::map<GLuint, std::pair<std::uint64_t, ProgramStages>>
      stages_;                                                     ///< by program, with the link they stem from
  std::map<GLuint, std::pair<std::uint64_t, ProgramText>> texts_;  ///< likewise
  std::unique_ptr<NativeDrawing> sentinel_drawing_;
  std::array<int, 4> sentinel_extent_{};  ///< of it: width, height, samples, whether its background is white
  std::minstd_rand random_;               ///< where sentinels stand
  GLuint depth_watched_ = 0;              ///< the volume whose slices' depth is watched for use; 0: none
  std::uint64_t saved_ = 0;
  std::uint64_t tidied_in_frame_ = 0;
  std::chrono::steady_clock::time_point frame_started_{};
  FrameClock clock_;
};

}  // namespace understudy::spu
