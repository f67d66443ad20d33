// SPDX-License-Identifier: Apache-2.0
// Method::adaptive: into how many equal parts a step is divided, and what a part shows.
//
// The error of samples in the middle of 2^d parts is estimated from the second differences b of the transfer
// function's entries. Where the value changes by w entries over a step, evenly, a bend errs by no more than
// b w / 8 / 4^d of what the step shows; bends among the values that the step has add up (sums over any range of
// values take constant time). The field itself bends at the faces of cells: on a step of l cells that adds
// f' w l / 24 / 4^d, or l / 24 / 4^d times how far the function goes up and down over these values. The values
// are those around the one in the step's middle, as far as the steepest slope in the block there leads.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "volume/brick/brick_store.h"
#include "volume/classification.h"
#include "volume/texel_type.h"

namespace understudy::volume {

/// Steps are divided into up to 2^4 parts.
constexpr int most_divisions = 4;

/// A transfer function made ready for the parts of steps: its entries, and more between them, for whole steps,
/// halves, quarters and so on.
class PartTable {
 public:
  PartTable(const TransferFunction& function, TexelType type);

  /// As of a TransferTable.
  float low() const { return low_; }
  float scale() const { return scale_; }
  float last() const { return float(entries_ - 1); }

  /// Per entry eight floats: RGBA and its difference to the next entry. Those for 2^d parts begin at entry d *
  /// entries(); the last of all shows nothing.
  const float* rows() const { return rows_.data(); }
  std::size_t entries() const { return entries_; }
  std::size_t neutral_entry() const { return entries_ * (most_divisions + 1); }

 private:
  float low_ = 0;
  float scale_ = 0;
  std::size_t entries_ = 0;
  std::vector<float> rows_;
};

/// How often steps are halved so that each errs by no more than `tolerance`, in colour and opacity, as far as
/// is estimated. Depends on the field and on places, not on who asks.
class StepDivision {
 public:
  /// Steps are up to `cells` long.
  StepDivision(const BrickStore& store, const TransferFunction& function, double tolerance, double cells);

  /// Per block 0 if no step whose middle lies in it is divided, and otherwise a class; three bytes more may be
  /// read after the last.
  const std::uint8_t* classes() const { return classes_.data(); }

  /// How often a step is halved, at class * bins + bin: `bin` is the place of the value in its middle, from 0
  /// at the table's low end to bins - 1 at its high one, rounded down. Three bytes more may be read.
  static constexpr int bins = 1024;
  const std::uint8_t* divisions() const { return divisions_.data(); }

 private:
  std::vector<std::uint8_t> classes_, divisions_;
};

}  // namespace understudy::volume
