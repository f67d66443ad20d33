// SPDX-License-Identifier: Apache-2.0
// The exception for problems with a volume's file, or with hints about it.
#pragma once

#include <stdexcept>

namespace understudy::volume {

/// The message names the file, the problem, and what to do next.
class FileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace understudy::volume
