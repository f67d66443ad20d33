// SPDX-License-Identifier: Apache-2.0
// A driver whose window has one colour buffer, a front buffer, made to look as if there were the back buffer of
// the recorded application's window.
//
// Applications name the back buffer to draw into it, to read from it and to ask about it. Each name is replaced
// on its way down and put back into what is answered; nothing is remembered, so display lists and
// glPushAttrib hold what the driver knows. An application that names the front buffer draws into the same
// memory, and is told afterwards that it is the back buffer.
#pragma once

#include "dispatch/table.h"

namespace understudy::spu {

class OneBuffer {
 public:
  explicit OneBuffer(const DispatchTable& driver);
  ~OneBuffer();
  OneBuffer(const OneBuffer&) = delete;
  OneBuffer& operator=(const OneBuffer&) = delete;

  const DispatchTable& table() const { return table_; }
  /// The context that is current on this thread from now on has, or has not, a back buffer.
  void made_current(bool double_buffered);

 private:
  struct Slots;

  const DispatchTable driver_;
  DispatchTable table_;
};

}  // namespace understudy::spu
