// SPDX-License-Identifier: Apache-2.0
// How long the processors worked for this process: on a machine that ranks share, a rank's own work, whatever
// the others do.
#pragma once

#include <ctime>

namespace understudy::compositor {

class ProcessorClock {
 public:
  /// Of all threads, since this was made.
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
