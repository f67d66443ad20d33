// SPDX-License-Identifier: Apache-2.0
// The viewer's error messages and exit statuses.
#pragma once

#include <stdexcept>
#include <string>

namespace viewer {

/// Exit statuses of the program; 0 is success.
enum class ExitCode {
  success = 0,
  bad_file = 1,          ///< a volume could not be read or does not fit, or an output could not be written
  bad_command_line = 2,  ///< options missing, unknown or out of range
  no_opengl = 3,         ///< no display, no context, or OpenGL reported an error
};

/// Message for the user: what went wrong, where, and what to do next.
class Error : public std::runtime_error {
 public:
  Error(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  ExitCode code() const { return code_; }

 private:
  ExitCode code_;
};

}  // namespace viewer
