// SPDX-License-Identifier: Apache-2.0
// What is wrong with a volume's file, or with what was said about it.
#pragma once

#include <stdexcept>

namespace understudy::volume {

/// The text names the file, what is wrong with it, and what to do next.
class FileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace understudy::volume
