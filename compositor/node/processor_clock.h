// SPDX-License-Identifier: Apache-2.0
// Processor time of this process: a rank's own work, even on a machine that ranks share.
#pragma once

#include <ctime>

namespace understudy::compositor {

class ProcessorClock {
 public:
  /// Of all threads, since construction.
  double ms() const { return now() - start_; }

 private:
  static double now() {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return 1e3 * double(time.tv_sec) + 1e-6 * double(time.tv_nsec);
  }

  double start_ = now();
};

}  // namespace understudy::compositor
