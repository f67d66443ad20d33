// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/verification/schedule.h"

#include <algorithm>

namespace understudy::spu {
namespace {

/// Credit is kept for this many images between two sentinels; more would be spent in a burst after a rest.
constexpr double most_credited_images = 100;
constexpr int most_sentinels_at_once = 8;
/// The footprint has grown if it is larger by this factor than in any image that was compared.
constexpr double grown_footprint = 1.5;

std::vector<std::size_t> changes(const VerificationSchedule::Inputs& before,
                                 const VerificationSchedule::Inputs& now) {
  std::vector<std::size_t> changed;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (now[i].effect == VerificationSchedule::Effect::followed) continue;
    // A NaN differs from itself.
    if (!(before[i].value == now[i].value)) changed.push_back(i);
  }
  return changed;
}

}  // namespace

bool VerificationSchedule::is_trusted(std::size_t index) const {
  if (inputs_[index].effect == Effect::predicted) return true;
  return inputs_[index].effect != Effect::unknown && inputs_[index].effect != Effect::decides &&
         std::any_of(changing_.begin(), changing_.end(), [&](const ChangingInput& input) {
           return input.index == index && input.right >= trusted_changes;
         });
}

void VerificationSchedule::begin(const Inputs& inputs, std::size_t footprint, double density) {
  if (inputs_.size() != inputs.size()) {
    right_ = false;
    inputs_.clear();
    changing_.clear();
    now_changed_.clear();
  }
  const std::vector<std::size_t> changed = changes(inputs_, inputs);
  inputs_ = inputs;
  // Changes of an image that was not compared are kept for the next.
  if (!changed_) now_changed_.clear();
  for (const std::size_t index : changed) {
    const bool decides = inputs_[index].effect == Effect::decides;
    const auto known = std::ranges::find(now_changed_, index, &Change::index);
    if (known == now_changed_.end())
      now_changed_.push_back({index, decides});
    else
      known->decides |= decides;
  }
  changed_ = std::ranges::any_of(now_changed_, [&](const Change& change) { return !is_trusted(change.index); });
  dense_ = !changed.empty();
  footprint_ = footprint;
  samples_ = density * double(footprint);
  grown_ = double(footprint) > grown_footprint * double(right_footprint_);
  if (const auto native = native_ms()) {
    const double share = dense_ ? dense_sentinel_share : sentinel_share;
    credit_ms_ = std::min(credit_ms_ + share * *native, most_credited_images * sentinel_share * *native);
  }
}

double VerificationSchedule::bound() const {
  return std::ranges::any_of(now_changed_, &Change::decides) ? 0.5 : 1;
}

std::optional<double> VerificationSchedule::native_ms() const {
  if (!measured_ms_ || measured_samples_ == 0) return measured_ms_;
  return *measured_ms_ * samples_ / measured_samples_;
}

int VerificationSchedule::sentinels() const {
  if (!ms_a_sentinel_) return credit_ms_ > 0 ? 1 : 0;
  return std::clamp(int(credit_ms_ / *ms_a_sentinel_), 0, most_sentinels_at_once);
}

void VerificationSchedule::whole_was_right(bool anything_visible, double native_ms) {
  const auto expected = this->native_ms();
  measured_ms_ = expected ? 0.5 * (*expected + native_ms) : native_ms;
  measured_samples_ = samples_;
  // An empty image proves nothing.
  if (!anything_visible) return;
  if (--to_prove_ <= 0) {
    right_ = true;
    lost_in_a_row_ = strict_in_a_row_ = 0;
  }
  right_footprint_ = std::max(right_footprint_, footprint_);
  for (const auto& [index, decides] : now_changed_) {
    const auto known =
        std::find_if(changing_.begin(), changing_.end(),
                     [index = index](const ChangingInput& input) { return input.index == index; });
    if (known == changing_.end()) {
      changing_.push_back({index, 1});
    } else {
      ++known->right;
    }
  }
  now_changed_.clear();
  changed_ = grown_ = false;
}

void VerificationSchedule::sentinels_took(int count, double ms) {
  if (count == 0) return;
  const double one = ms / count;
  if (!ms_a_sentinel_) ms_a_sentinel_ = one;
  // A stall of the machine is not charged.
  credit_ms_ -= count * std::min(one, 2 * *ms_a_sentinel_);
  // Smoothed: a single tile is not a measurement.
  *ms_a_sentinel_ += 0.2 * (one - *ms_a_sentinel_);
}

void VerificationSchedule::lost(Loss loss) {
  right_ = false;
  to_prove_ = right_after_loss;
  right_footprint_ = 0;
  changing_.clear();
  if (loss == Loss::strictness) {
    ++strict_in_a_row_;
    return;
  }
  ++lost_in_a_row_;
  ++lost_ever_;
}

}  // namespace understudy::spu
