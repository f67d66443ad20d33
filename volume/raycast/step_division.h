// SPDX-License-Identifier: Apache-2.0
// Method::adaptive: into how many equal parts a step is divided, and the colour of a part.
//
// The error of samples in the middle of 2^d parts is estimated from the second differences b of the transfer
// function's entries. Where the value changes linearly by w entries over a step, a bend causes an error of at
// most b w / 8 / 4^d of the step's contribution; bends within the step's range of values add up (prefix sums
// give the sum over any range in constant time). The field itself bends at the faces of cells: on a step of l
// cells this adds f' w l / 24 / 4^d, or l / 24 / 4^d times the total variation of the function over these
// values. The values are those around the one in the step's middle, as far as the steepest slope in its block
// can change them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "volume/brick/brick_store.h"
#include "volume/classification.h"
#include "volume/texel_type.h"

namespace understudy::volume {

/// Steps are divided into at most 2^4 parts.
constexpr int most_divisions = 4;

/// A transfer function prepared for parts of steps: its entries, and additional ones in between, for whole
/// steps, halves, quarters and so on.
class PartTable {
 public:
  PartTable(const TransferFunction& function, TexelType type);

  /// As in TransferTable.
  float low() const { return low_; }
  float scale() const { return scale_; }
  float last() const { return float(entries_ - 1); }

  /// Eight floats per entry: RGBA and its difference to the next entry. The entries for 2^d parts begin at d *
  /// entries(); the very last entry shows nothing.
  const float* rows() const { return rows_.data(); }
  std::size_t entries() const { return entries_; }
  std::size_t neutral_entry() const { return entries_ * (most_divisions + 1); }

 private:
  float low_ = 0;
  float scale_ = 0;
  std::size_t entries_ = 0;
  std::vector<float> rows_;
};

/// How often steps are halved so that the estimated error of each is at most `tolerance`, in colour and
/// opacity. Depends only on the field and the position, not on the partition.
class StepDivision {
 public:
  /// Steps are at most `cells` long.
  StepDivision(const BrickStore& store, const TransferFunction& function, double tolerance, double cells);

  /// Per block, 0 if no step with its middle in the block is divided, otherwise a class; followed by three
  /// padding bytes that may be read.
  const std::uint8_t* classes() const { return classes_.data(); }

  /// How often a step is halved, at class * bins + bin. `bin` is the position of the value in its middle, from
  /// 0 at the table's low end to bins - 1 at the high end, rounded down. Three padding bytes follow.
  static constexpr int bins = 1024;
  const std::uint8_t* divisions() const { return divisions_.data(); }

 private:
  std::vector<std::uint8_t> classes_, divisions_;
};

}  // namespace understudy::volume
