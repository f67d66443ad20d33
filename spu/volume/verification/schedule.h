// SPDX-License-Identifier: Apache-2.0
// Decides when a substituted volume is compared with what the application itself would draw.
//
//   whole image, before it is shown:
//     until an image that shows something was right; whenever something changed that the model does not
//     predict; when the volume covers much more of the window than before; when --verify=K requires it
//   sentinels, tiles of 16 x 16 pixels at random positions in the viewport, in all other frames:
//     as many as 1 % of the application's own time allows, 10 % while a measured input keeps changing
//
// An error that covers a share f of the viewport escapes n sentinels with the probability (1 - f)^n.
//
// A failed comparison is not final: the application draws that frame, and the volume is measured anew. After
// max_lost_comparisons without right_after_loss right images in between, it is handed back.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace understudy::spu {

/// In a row; ParaView's first two frames show a volume that is still being loaded.
constexpr int max_lost_comparisons = 5;
/// In total: a volume whose images are wrong again and again is not modelled correctly.
constexpr int max_lost_comparisons_ever = 12;
/// Right images in a row, after a failed comparison or an unproven measurement, before sentinels suffice again.
constexpr int right_after_loss = 8;
/// If the image was right each time after this many changes of one input, sentinels suffice for it.
constexpr int trusted_changes = 4;
/// Shares of the time that the application's own drawing takes alone, into floats, in its first frame. Into the
/// window, and later, it takes down to a third of that: together at most 1 and 10 % of a frame.
constexpr double sentinel_share = 0.003;
constexpr double dense_sentinel_share = 0.03;

class VerificationSchedule {
 public:
  /// The effect of a change of an input.
  enum class Effect : std::uint8_t {
    unknown,    ///< it may decide about fragments: the next image is compared whole
    decides,    ///< as unknown; it decides about samples by a branch, and may hide only few of them at first
    measured,   ///< it is measured anew, like a table's colours: compared whole until that was right a few
                ///< times
    predicted,  ///< a table that, according to the source, only samples address: measured anew, and sentinels
                ///< suffice, but more of them
    followed,   ///< it changes with what is observed in every frame, like the camera: sentinels suffice
  };
  /// What an image depends on, input by input: the program, textures and their contents, uniforms. If the
  /// number of inputs changes, all have changed.
  struct Input {
    float value = 0;  ///< compared; a NaN always differs
    Effect effect = Effect::measured;
  };
  using Inputs = std::vector<Input>;
  /// `strictness`: the image would have been right by the usual bound. This does not prove that the volume is
  /// modelled wrongly: the next attempt waits longer, and the volume is not handed back.
  enum class Loss : std::uint8_t { beyond_bound, strictness };

  /// Called before the next image is shown. `footprint`: pixels that it covers; `density`: of the samples on
  /// their rays, in a constant unit.
  void begin(const Inputs& inputs, std::size_t footprint, double density = 1);

  /// Whether the image is compared whole; otherwise sentinels() tiles are.
  bool whole_due() const { return !right_ || changed_ || grown_; }
  /// The largest severity of a right tile. Half of the usual one if something changed that decides about
  /// samples: a plane that has begun to cut may change the image by less than drivers may round.
  double bound() const;
  /// The number of tiles to compare now.
  int sentinels() const;

  /// The whole image was compared and right; `native_ms` is the time of the application's own drawing.
  void whole_was_right(bool anything_visible, double native_ms);
  void sentinels_took(int count, double ms);
  void lost(Loss loss = Loss::beyond_bound);
  /// What was measured now may be right in one view and wrong in another: right_after_loss images that show
  /// something must be right before sentinels suffice.
  void ask_for_several() {
    right_ = false;
    to_prove_ = right_after_loss;
  }
  /// The next image is compared whole, whatever was right before.
  void ask_for_whole() { right_ = false; }

  bool gives_up() const {
    return lost_in_a_row_ >= max_lost_comparisons || lost_ever_ >= max_lost_comparisons_ever;
  }
  int lost_in_a_row() const { return lost_in_a_row_ + strict_in_a_row_; }
  /// The time that the application's own drawing of the current image would take if it is proportional to the
  /// samples of the volume; empty: not known yet.
  std::optional<double> native_ms() const;

 private:
  /// An input that changes again and again.
  struct ChangingInput {
    std::size_t index;
    int right = 0;  ///< comparisons that were right after it had changed
  };
  bool is_trusted(std::size_t index) const;
  /// A change since the last image that was compared and right.
  struct Change {
    std::size_t index;
    bool decides;  ///< it was of Effect::decides when it changed; it may have changed back since
  };

  Inputs inputs_;  ///< of the current image
  std::vector<Change> now_changed_;
  std::vector<ChangingInput> changing_;
  std::size_t footprint_ = 0;        ///< of the current image
  double samples_ = 0;               ///< likewise, in a constant unit
  std::size_t right_footprint_ = 0;  ///< the largest of an image that was right
  bool right_ = false;               ///< an image that shows something was right, and none was wrong since
  bool changed_ = false;
  bool grown_ = false;
  bool dense_ = false;
  int to_prove_ = 1;  ///< number of images that show something and must still be right
  int lost_in_a_row_ = 0;
  int strict_in_a_row_ = 0;
  int lost_ever_ = 0;
  std::optional<double> measured_ms_;  ///< of the application's own drawing
  double measured_samples_ = 0;
  double credit_ms_ = 0;                 ///< time that sentinels may take
  std::optional<double> ms_a_sentinel_;  ///< unknown before the first
};

}  // namespace understudy::spu
