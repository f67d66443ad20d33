// SPDX-License-Identifier: Apache-2.0
// Sets of dependences, each kept once: sets are equal if their numbers are, and each union is computed once.
#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "spu/volume/program/facts.h"

namespace understudy::spu::program {

/// Limit of an analysis: shaders that are worth the time never need more.
constexpr std::size_t max_dependences_kept = 1'000'000;

/// Thrown when an analysis exceeds its limits. Never leaves analyse().
struct TooLarge {};

class FlowSets {
 public:
  using Set = std::uint32_t;
  static constexpr Set empty = 0;

  /// Set 1 + n is {data from source n}, for the first `leaves` sources.
  explicit FlowSets(std::uint32_t leaves);

  Set single(std::uint32_t source, Flow flow = Flow::data);
  Set join(Set a, Set b);
  /// Does not keep intermediate unions.
  Set join(std::span<const Set> sets);
  /// All members of `set`, with their flow raised to `flow` at least.
  Set by(Flow flow, Set set);

  Dependences members(Set set) const;

 private:
  /// Source and flow in one integer, which keeps their order.
  using Packed = std::uint32_t;
  static constexpr Packed pack(std::uint32_t source, Flow flow) { return source * 4 + Packed(flow); }

  std::span<const Packed> packed(Set set) const { return sets_[set]; }
  Set intern(std::vector<Packed> members);

  std::vector<std::vector<Packed>> sets_;
  std::unordered_multimap<std::uint64_t, Set> by_hash_;
  std::unordered_map<std::uint64_t, Set> joins_;
  std::unordered_map<std::uint64_t, Set> flows_;
  std::size_t kept_ = 0;
};

}  // namespace understudy::spu::program
