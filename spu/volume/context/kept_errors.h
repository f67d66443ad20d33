// SPDX-License-Identifier: Apache-2.0
// Keeps our own OpenGL errors apart from those of the application, which share one queue in the driver.
#pragma once

#include <vector>

#include "dispatch/table.h"

namespace understudy::spu {

/// Empties the driver's queue. Returns the first error; GL_NO_ERROR: there was none.
GLenum take_error(const DispatchTable& gl);

/// The errors of the application that were in the driver's queue when our own calls began.
class KeptErrors {
 public:
  /// Returns one of them for glGetError, and forgets it; GL_NO_ERROR if there is none.
  GLenum take();

 private:
  friend class OwnErrors;
  std::vector<GLenum> errors_;  ///< each at most once, as in the driver
  int nested_ = 0;
};

/// Exists while we make calls of our own: takes the application's errors out of the queue before, and discards
/// our own after. May be nested.
class OwnErrors {
 public:
  OwnErrors(const DispatchTable& gl, KeptErrors& kept);
  ~OwnErrors();
  OwnErrors(const OwnErrors&) = delete;
  OwnErrors& operator=(const OwnErrors&) = delete;

 private:
  const DispatchTable& gl_;
  KeptErrors& kept_;
};

}  // namespace understudy::spu
