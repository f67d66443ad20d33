// SPDX-License-Identifier: Apache-2.0
// A library of the system that is opened when asked for.
#pragma once

#include <initializer_list>
#include <stdexcept>
#include <string>

namespace understudy::volume::offscreen {

/// There is no such context on this machine; the message says why, and what to install.
class ContextUnavailable : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Never closed: drivers leave threads and exit handlers behind.
class SystemLibrary {
 public:
  /// Opens the first of `names` that can be opened; `packages` have it. Throws ContextUnavailable.
  SystemLibrary(std::initializer_list<const char*> names, const char* packages);

  /// Gives `function` the address of `name`. Throws ContextUnavailable where it is missing: `version` of the
  /// library has it.
  template <class Function>
  void find(const char* name, const char* version, Function& function) const {
    function = reinterpret_cast<Function>(address(name, version));
  }

 private:
  void* address(const char* name, const char* version) const;

  void* handle_ = nullptr;
  std::string name_;
};

}  // namespace understudy::volume::offscreen
