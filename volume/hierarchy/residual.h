// SPDX-License-Identifier: Apache-2.0
// The difference between a sample and its prediction, as an unsigned number that is small for small
// differences.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <type_traits>

namespace understudy::volume {

template <std::size_t bytes>
using UnsignedOf =
    std::conditional_t<bytes == 1, std::uint8_t,
                       std::conditional_t<bytes == 2, std::uint16_t,
                                          std::conditional_t<bytes == 4, std::uint32_t, std::uint64_t>>>;

/// As wide as a sample.
template <typename Sample>
using Residual = UnsignedOf<sizeof(Sample)>;

/// Maps samples to unsigned numbers of the same order, one to one, including NaN.
template <typename Sample>
Residual<Sample> ordered(Sample sample) {
  using U = Residual<Sample>;
  constexpr U top = U(U(1) << (8 * sizeof(U) - 1));
  const U bits = std::bit_cast<U>(sample);
  if constexpr (std::is_floating_point_v<Sample>) return (bits & top) != 0 ? U(~bits) : U(bits | top);
  if constexpr (std::is_signed_v<Sample>) return U(bits ^ top);
  return bits;
}

template <typename Sample>
Sample of_ordered(Residual<Sample> number) {
  using U = Residual<Sample>;
  constexpr U top = U(U(1) << (8 * sizeof(U) - 1));
  if constexpr (std::is_floating_point_v<Sample>)
    return std::bit_cast<Sample>((number & top) != 0 ? U(number ^ top) : U(~number));
  if constexpr (std::is_signed_v<Sample>) return std::bit_cast<Sample>(U(number ^ top));
  return std::bit_cast<Sample>(number);
}

/// 0, -1, 1, -2, 2, ... become 0, 1, 2, 3, 4, ...
template <typename U>
U folded(U difference) {
  return U(U(difference << 1) ^ U(0 - U(difference >> (8 * sizeof(U) - 1))));
}
template <typename U>
U unfolded(U residual) {
  return U(U(residual >> 1) ^ U(0 - U(residual & 1)));
}

/// Lossless.
template <typename Sample>
Residual<Sample> exact_residual(Sample sample, Sample predicted) {
  using U = Residual<Sample>;
  return folded(U(ordered(sample) - ordered(predicted)));
}
template <typename Sample>
Sample exact_sample(Residual<Sample> residual, Sample predicted) {
  using U = Residual<Sample>;
  return of_ordered<Sample>(U(ordered(predicted) + unfolded(residual)));
}

/// Differences as multiples of a quantum: the error of a sample is at most half of it. For integers the quantum
/// must be odd.
template <typename Sample>
class Quantiser {
 public:
  explicit Quantiser(double quantum) : quantum_(quantum) {}

  Sample sample(Residual<Sample> residual, Sample predicted) const {
    using S = std::make_signed_t<Residual<Sample>>;
    constexpr auto least = double(std::numeric_limits<Sample>::lowest());
    constexpr auto greatest = double(std::numeric_limits<Sample>::max());
    const double value = double(predicted) + double(S(unfolded(residual))) * quantum_;
    return Sample(std::clamp(value, least, greatest));
  }
  /// Empty if no multiple is close enough, e.g. for values that are not finite.
  std::optional<Residual<Sample>> residual(Sample wanted, Sample predicted) const {
    using U = Residual<Sample>;
    constexpr double most = 1 << 30;
    const double steps = std::round((double(wanted) - double(predicted)) / quantum_);
    constexpr double limit = std::min(most, double(std::numeric_limits<std::make_signed_t<U>>::max()));
    if (!(std::abs(steps) <= limit)) return std::nullopt;
    const U number = folded(U(std::int64_t(steps)));
    if (!(std::abs(double(sample(number, predicted)) - double(wanted)) <= quantum_ / 2)) return std::nullopt;
    return number;
  }

 private:
  double quantum_;
};

}  // namespace understudy::volume
