// SPDX-License-Identifier: Apache-2.0
#include "interceptor/remote/config_attributes.h"

#include "interceptor/remote/context.h"

namespace understudy::interceptor {
namespace {

const ConfigAttribute* find(std::span<const ConfigAttribute> table, int name) {
  for (const ConfigAttribute& attribute : table) {
    if (attribute.name == name) return &attribute;
  }
  return nullptr;
}

bool meets(Match match, int has, int wanted) {
  switch (match) {
    case Match::at_least:
      return has >= wanted;
    case Match::exact:
      return has == wanted;
    case Match::all_bits:
      return (has & wanted) == wanted;
    case Match::disregarded:
      return true;
  }
  return false;
}

}  // namespace

bool attribute_of(std::span<const ConfigAttribute> table, const RemoteConfig& config, int name, int* value) {
  const ConfigAttribute* attribute = find(table, name);
  if (attribute == nullptr) return false;
  *value = attribute->value(config);
  return true;
}

bool meets_all(std::span<const ConfigAttribute> table, const RemoteConfig& config, const int* list, int end,
               int any) {
  for (; list != nullptr && list[0] != end; list += 2) {
    const ConfigAttribute* attribute = find(table, list[0]);
    if (attribute == nullptr || list[1] == any) continue;
    if (!meets(attribute->match, attribute->value(config), list[1])) return false;
  }
  return true;
}

int config_value::largest_side(const RemoteConfig&) {
  return largest_remote_side;
}

int config_value::largest_area(const RemoteConfig&) {
  return largest_remote_side * largest_remote_side;
}

}  // namespace understudy::interceptor
