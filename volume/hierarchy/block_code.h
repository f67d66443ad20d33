// SPDX-License-Identifier: Apache-2.0
// Encodes one block of a level as bytes: the residuals of the samples that the next level does not have.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "volume/hierarchy/byte_planes.h"
#include "volume/hierarchy/interpolation.h"
#include "volume/hierarchy/residual.h"

namespace understudy::volume {

/// How a block's samples are encoded.
struct BlockCoding {
  Prediction prediction = Prediction::linear;
  /// Of a Quantiser, in sample values; 0: lossless.
  double quantum = 0;
};

/// Extracts the samples of a block, x fastest, from its points.
template <typename Sample>
std::vector<Sample> samples_inside(const BlockExtent& extent, std::span<const Sample> points) {
  std::vector<Sample> samples;
  samples.reserve(extent.samples());
  for (int z = 0; z < extent.inside[2]; ++z)
    for (int y = 0; y < extent.inside[1]; ++y) {
      const auto row = points.begin() + std::ptrdiff_t(extent.at(0, y, z));
      samples.insert(samples.end(), row, row + extent.inside[0]);
    }
  return samples;
}

/// Encodes `wanted`, the samples of a block, x fastest. The even points of `points` must be set; afterwards all
/// samples of the block are set to the values that a reader will decode. Empty if the error bound of the
/// quantum cannot be kept.
template <typename Sample>
std::optional<std::vector<std::byte>> coded_block(const BlockExtent& extent, const BlockCoding& coding,
                                                  std::span<const Sample> wanted, int effort,
                                                  std::span<Sample> points) {
  using U = Residual<Sample>;
  std::vector<U> residuals;
  residuals.reserve(extent.predicted());
  const Quantiser<Sample> quantiser(coding.quantum);
  bool kept = true;
  const auto correct = [&](const std::array<int, 3>& place, int stride, Sample* row, int count) {
    const auto [x, y, z] = place;
    const Sample* own =
        wanted.data() +
        (std::size_t(z) * std::size_t(extent.inside[1]) + std::size_t(y)) * std::size_t(extent.inside[0]) +
        std::size_t(x);
    for (int i = 0; i < count; ++i, own += stride) {
      if (coding.quantum == 0) {
        residuals.push_back(exact_residual(*own, row[i]));
        row[i] = *own;
        continue;
      }
      const auto residual = quantiser.residual(*own, row[i]);
      kept = kept && residual;
      residuals.push_back(residual.value_or(U(0)));
      row[i] = quantiser.sample(residuals.back(), row[i]);
    }
  };
  fill_between(extent, coding.prediction, points.data(), correct);
  if (!kept) return std::nullopt;
  return packed_planes(std::as_bytes(std::span(residuals)), sizeof(U), effort);
}

/// Fills in the samples of a block whose even points are set. Returns false if `packed` is not such a block.
template <typename Sample>
bool decode_block(const BlockExtent& extent, const BlockCoding& coding, std::span<const std::byte> packed,
                  std::span<Sample> points) {
  using U = Residual<Sample>;
  std::vector<U> residuals(extent.predicted());
  if (!unpack_planes(packed, sizeof(U), std::as_writable_bytes(std::span(residuals)))) return false;
  const U* next = residuals.data();
  const Quantiser<Sample> quantiser(coding.quantum);
  const auto correct = [&](const std::array<int, 3>&, int, Sample* row, int count) {
    if (coding.quantum == 0) {
      for (int i = 0; i < count; ++i) row[i] = exact_sample(next[i], row[i]);
    } else {
      for (int i = 0; i < count; ++i) row[i] = quantiser.sample(next[i], row[i]);
    }
    next += count;
  };
  fill_between(extent, coding.prediction, points.data(), correct);
  return true;
}

/// The single block of the coarsest level: each sample is predicted by the previous one.
template <typename Sample>
std::vector<std::byte> coded_coarsest(std::span<const Sample> samples, int effort) {
  std::vector<Residual<Sample>> residuals;
  residuals.reserve(samples.size());
  Sample before{};
  for (const Sample sample : samples) {
    residuals.push_back(exact_residual(sample, before));
    before = sample;
  }
  return packed_planes(std::as_bytes(std::span(residuals)), sizeof(Sample), effort);
}
template <typename Sample>
bool decode_coarsest(std::span<const std::byte> packed, std::span<Sample> samples) {
  std::vector<Residual<Sample>> residuals(samples.size());
  if (!unpack_planes(packed, sizeof(Sample), std::as_writable_bytes(std::span(residuals)))) return false;
  Sample before{};
  for (std::size_t i = 0; i < samples.size(); ++i) before = samples[i] = exact_sample(residuals[i], before);
  return true;
}

}  // namespace understudy::volume
