// SPDX-License-Identifier: Apache-2.0
// Local names of a stream's objects: the driver may assign other names, locations and addresses than when the
// stream was recorded.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>

#include "dispatch/call_shape.h"

namespace understudy::spu {

class ObjectNames {
 public:
  /// Returns the local name of an object of the stream; unchanged if no call returned it, as with names that
  /// the application chose.
  std::uint64_t here(ObjectKind kind, std::uint64_t there) const {
    const auto& names = names_[std::size_t(kind)];
    const auto found = names.find(there);
    return found == names.end() ? there : found->second;
  }
  void set(ObjectKind kind, std::uint64_t there, std::uint64_t here) {
    // Display lists keep their names, because glNewList accepts any name.
    if (kind != ObjectKind::none && kind != ObjectKind::display_list) names_[std::size_t(kind)][there] = here;
  }

  void forget(ObjectKind kind, std::uint64_t there) { names_[std::size_t(kind)].erase(there); }

  /// Uniform locations belong to a program (its local name). Elements of an array follow its first one.
  std::int32_t location_here(std::uint64_t program, std::int32_t there) const {
    const auto found = locations_.upper_bound({program, there});
    if (there < 0 || found == locations_.begin()) return there;
    const auto& [key, here] = *std::prev(found);
    return key.first == program ? here + (there - key.second) : there;
  }
  void set_location(std::uint64_t program, std::int32_t there, std::int32_t here) {
    if (there >= 0) locations_[{program, there}] = here;
  }

  /// Creates a name for a sync object, because the driver's names are addresses.
  std::uint64_t new_sync_name() { return ++sync_names_; }

  /// The memory of a mapped buffer.
  struct Mapping {
    std::byte* first = nullptr;
    std::size_t bytes = 0;
    std::uint32_t buffer = 0;  ///< its local name
  };
  /// A buffer has one mapping: an earlier one has ended.
  void set_mapping(std::uint64_t there, Mapping mapping) {
    drop_mapping(mapping.buffer);
    mappings_[there] = mapping;
  }
  Mapping mapping(std::uint64_t there) const {
    const auto found = mappings_.find(there);
    return found == mappings_.end() ? Mapping{} : found->second;
  }

  bool has_mappings() const { return !mappings_.empty(); }
  void drop_mapping(std::uint32_t buffer) {
    std::erase_if(mappings_, [&](const auto& entry) { return entry.second.buffer == buffer; });
  }

  std::uint64_t current_program = 0;  ///< the local name

 private:
  std::array<std::map<std::uint64_t, std::uint64_t>, std::size_t(ObjectKind::display_list) + 1> names_;
  std::map<std::pair<std::uint64_t, std::int32_t>, std::int32_t> locations_;
  std::map<std::uint64_t, Mapping> mappings_;
  std::uint64_t sync_names_ = 0;
};

}  // namespace understudy::spu
