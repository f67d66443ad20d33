// SPDX-License-Identifier: Apache-2.0
// What all contexts of a process share that write into the same file.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>

namespace understudy::spu {

/// The T of this file, created as T(file) on first use. Never destroyed: an application may create contexts one
/// after another, and may call OpenGL until its very last instruction.
template <class T>
T& shared_by_file(const std::string& file) {
  struct Known {
    std::mutex mutex;
    std::map<std::string, std::unique_ptr<T>> by_file;
  };
  static Known& known = *new Known;
  const std::scoped_lock lock(known.mutex);
  auto& found = known.by_file[file];
  if (!found) found = std::make_unique<T>(file);
  return *found;
}

}  // namespace understudy::spu
