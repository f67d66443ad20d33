// SPDX-License-Identifier: Apache-2.0
// Makes a driver whose window has a single colour buffer, a front buffer, look as if the window had the back
// buffer of the recorded application's window.
//
// Applications name the back buffer to draw into it, to read from it and to query it. Each name is replaced on
// its way to the driver and restored in the results of queries. No state is kept, so display lists and
// glPushAttrib hold the driver's names. An application that names the front buffer draws into the same memory,
// and queries then return the back buffer.
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
  /// Declares whether the context that is current on this thread from now on has a back buffer.
  void made_current(bool double_buffered);

 private:
  struct Slots;

  const DispatchTable driver_;
  DispatchTable table_;
};

}  // namespace understudy::spu
