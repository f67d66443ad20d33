// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/program/element_names.h"

#include <algorithm>

namespace understudy::spu::program {
namespace {

/// Removes from the front of `name` the part before the next index, or that index with its brackets, and
/// returns it.
std::string_view take_part(std::string_view& name) {
  const std::size_t end = name.starts_with('[') ? std::min(name.find(']'), name.size() - 1) + 1
                                                : std::min(name.find('['), name.size());
  const std::string_view part = name.substr(0, end);
  name.remove_prefix(end);
  return part;
}

bool is_index(std::string_view name) {
  return name.starts_with('[');
}

}  // namespace

bool may_be_same_element(std::string_view a, std::string_view b) {
  while (!a.empty() || !b.empty()) {
    // An array as a whole stands for each of its elements.
    if (is_index(a) != is_index(b)) {
      take_part(is_index(a) ? a : b);
      continue;
    }
    const bool indices = is_index(a);
    const std::string_view of_a = take_part(a);
    const std::string_view of_b = take_part(b);
    if (of_a != of_b && !(indices && (of_a == "[*]" || of_b == "[*]"))) return false;
  }
  return true;
}

}  // namespace understudy::spu::program
