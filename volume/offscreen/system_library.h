// SPDX-License-Identifier: Apache-2.0
// A system library that is opened on request.
#pragma once

#include <initializer_list>
#include <stdexcept>
#include <string>

namespace understudy::volume::offscreen {

/// No such context is available on this machine; the message has the reason, and what to install.
class ContextUnavailable : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Never closed: drivers leave threads and exit handlers behind.
class SystemLibrary {
 public:
  /// Opens the first of `names` that can be opened; `packages` provide it. Throws ContextUnavailable.
  SystemLibrary(std::initializer_list<const char*> names, const char* packages);

  /// Sets `function` to the address of `name`. Throws ContextUnavailable if it is missing, with `version` as
  /// the version of the library that has it.
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
