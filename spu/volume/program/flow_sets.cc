// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/program/flow_sets.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace understudy::spu::program {
namespace {

std::uint64_t hash_of(std::span<const std::uint32_t> members) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const std::uint32_t member : members) hash = (hash ^ member) * 0x100000001b3U;
  return hash;
}

constexpr std::uint64_t both(std::uint32_t a, std::uint32_t b) {
  return std::uint64_t(a) << 32U | b;
}

}  // namespace

FlowSets::FlowSets(std::uint32_t leaves) {
  sets_.reserve(2 * std::size_t(leaves) + 1);
  intern({});
  for (std::uint32_t leaf = 0; leaf < leaves; ++leaf) intern({pack(leaf, Flow::data)});
}

FlowSets::Set FlowSets::intern(std::vector<Packed> members) {
  const std::uint64_t hash = hash_of(members);
  const auto [first, last] = by_hash_.equal_range(hash);
  for (auto known = first; known != last; ++known) {
    if (sets_[known->second] == members) return known->second;
  }
  kept_ += members.size();
  if (kept_ > max_dependences_kept) throw TooLarge();
  const Set set = Set(sets_.size());
  sets_.push_back(std::move(members));
  by_hash_.emplace(hash, set);
  return set;
}

FlowSets::Set FlowSets::single(std::uint32_t source, Flow flow) {
  return intern({pack(source, flow)});
}

FlowSets::Set FlowSets::join(Set a, Set b) {
  if (a == b || b == empty) return a;
  if (a == empty) return b;
  const std::uint64_t key = both(std::min(a, b), std::max(a, b));
  if (const auto known = joins_.find(key); known != joins_.end()) return known->second;
  std::vector<Packed> members;
  members.reserve(packed(a).size() + packed(b).size());
  std::ranges::set_union(packed(a), packed(b), std::back_inserter(members));
  const Set set = intern(std::move(members));
  joins_.emplace(key, set);
  return set;
}

FlowSets::Set FlowSets::join(std::span<const Set> sets) {
  std::vector<Packed> members;
  for (const Set set : sets) members.insert(members.end(), packed(set).begin(), packed(set).end());
  std::ranges::sort(members);
  members.erase(std::unique(members.begin(), members.end()), members.end());
  return intern(std::move(members));
}

FlowSets::Set FlowSets::by(Flow flow, Set set) {
  if (set == empty) return empty;
  const std::uint64_t key = both(set, std::uint32_t(flow));
  if (const auto known = flows_.find(key); known != flows_.end()) return known->second;
  std::vector<Packed> members;
  for (const Packed member : packed(set)) {
    const Packed other = pack(member / 4, std::max(Flow(member % 4), flow));
    if (members.empty() || members.back() != other) members.push_back(other);
  }
  const Set converted = intern(std::move(members));
  flows_.emplace(key, converted);
  return converted;
}

Dependences FlowSets::members(Set set) const {
  Dependences list;
  for (const Packed member : packed(set)) list.push_back({member / 4, Flow(member % 4)});
  return list;
}

}  // namespace understudy::spu::program
