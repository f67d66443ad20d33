// SPDX-License-Identifier: Apache-2.0
// When a substituted volume is compared with what the application itself would draw.
//
//   whole image, before it is shown:
//     until an image that shows something was right; whenever something changed that the model does not
//     predict; when the volume covers much more of the window than it did; when --verify=K asks for it
//   sentinels, tiles of 16² pixels at random places of the viewport, in all other frames:
//     as many as 1 % of the application's own time buys, 10 % while an input that is measured keeps changing
//
// An error that covers a share f of the viewport survives n sentinels with the probability (1 - f)^n.
//
// A lost comparison is no verdict: the application draws that frame, and the volume is measured anew. After
// max_lost_comparisons without right_after_loss right images in between, it is handed back.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace understudy::spu {

/// In a row; ParaView's first two frames show a volume that is still being loaded.
constexpr int max_lost_comparisons = 5;
/// In all: a volume whose images are wrong again and again is not understood.
constexpr int max_lost_comparisons_ever = 12;
/// In a row, after a lost comparison or where what was measured is unproven, before sentinels suffice again.
constexpr int right_after_loss = 8;
/// The same input has changed this often and the image was right each time: sentinels suffice for it.
constexpr int trusted_changes = 4;
/// Of what the application's own drawing takes by itself, into floats, in its first frame. Into the window, and
/// later, it takes down to a third of that: together at most 1 and 10 % of a frame.
constexpr double sentinel_share = 0.003;
constexpr double dense_sentinel_share = 0.03;

class VerificationSchedule {
 public:
  /// What a change of an input does.
  enum class Effect : std::uint8_t {
    unknown,    ///< it may decide about fragments: the next image is compared whole
    decides,    ///< as unknown; it decides, by a branch, about samples, and may hide only few of them at first
    measured,   ///< it is measured anew, as a table's colours: compared whole until that was right a few times
    predicted,  ///< a table of which the text says that samples alone address it: measured anew, and sentinels
                ///< suffice, more of them
    followed,   ///< it moves with what is observed in every frame, as the camera: sentinels suffice
  };
  /// What an image depends on, input by input: the program, textures and their contents, uniforms. Where the
  /// number of inputs changes, all have changed.
  struct Input {
    float value = 0;  ///< compared; not a number: always another
    Effect effect = Effect::measured;
  };
  using Inputs = std::vector<Input>;
  /// `strictness`: the image would have been right to the usual bound. It is no proof that the volume is not
  /// understood: the next attempt waits longer, and the volume is not handed back.
  enum class Loss : std::uint8_t { beyond_bound, strictness };

  /// The next image is about to be shown. `footprint`: pixels that it covers; `density`: of the samples on
  /// their rays, in a unit that stays.
  void begin(const Inputs& inputs, std::size_t footprint, double density = 1);

  /// Whether it is compared whole; else sentinels() many tiles are.
  bool whole_due() const { return !right_ || changed_ || grown_; }
  /// The severity of a tile that is still right. Half of the usual where something changed that decides about
  /// samples: a plane that has begun to cut shows less of itself than drivers may round.
  double bound() const;
  /// How many tiles are to be compared now.
  int sentinels() const;

  /// The whole image was compared; `native_ms` is what the application's own took.
  void whole_was_right(bool anything_visible, double native_ms);
  void sentinels_took(int count, double ms);
  void lost(Loss loss = Loss::beyond_bound);
  /// What was measured now may be right in one view and wrong in another: so many images that show something
  /// must be right before sentinels suffice.
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
  /// What the application's own drawing of the image that is begun would take, as far as time goes by the
  /// samples of a volume; empty: not known yet.
  std::optional<double> native_ms() const;

 private:
  /// An input that changes again and again.
  struct ChangingInput {
    std::size_t index;
    int right = 0;  ///< comparisons that were right after it had changed
  };
  bool is_trusted(std::size_t index) const;
  /// Since the last image that was compared and right.
  struct Change {
    std::size_t index;
    bool decides;  ///< it was of Effect::decides when it changed; it may have come back since
  };

  Inputs inputs_;  ///< of the last image that was begun
  std::vector<Change> now_changed_;
  std::vector<ChangingInput> changing_;
  std::size_t footprint_ = 0;        ///< of the image that is begun
  double samples_ = 0;               ///< likewise, in a unit that stays
  std::size_t right_footprint_ = 0;  ///< the largest that was right
  bool right_ = false;               ///< an image that shows something was right, and none was wrong since
  bool changed_ = false;
  bool grown_ = false;
  bool dense_ = false;
  int to_prove_ = 1;  ///< so many images that show something must be right yet
  int lost_in_a_row_ = 0;
  int strict_in_a_row_ = 0;
  int lost_ever_ = 0;
  std::optional<double> measured_ms_;  ///< of the application's own drawing
  double measured_samples_ = 0;
  double credit_ms_ = 0;                 ///< that sentinels may take
  std::optional<double> ms_a_sentinel_;  ///< not known before the first
};

}  // namespace understudy::spu
