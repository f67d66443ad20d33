// SPDX-License-Identifier: Apache-2.0
// The memory that an application's images go to, as every rank of the group sees it: ranks on rank 0's
// machine map it too, and put their regions there themselves; the others send theirs to rank 0.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "compositor/exchange/communicator.h"
#include "compositor/exchange/settings.h"
#include "compositor/service/image_buffer.h"

namespace understudy::compositor {

class ImageBuffers {
 public:
  struct Memory {
    std::size_t floats = 0;        ///< that it holds
    std::span<float> here;         ///< as this rank sees it; empty where it does not
    std::vector<bool> reached_by;  ///< by rank, the same on all ranks
  };

  ImageBuffers(Communicator& communicator, Gather gather) : communicator_(communicator), gather_(gather) {}

  /// Collective. `given` is, on rank 0, what the application gave: empty when that was no use. It takes the
  /// place of what the application gave before.
  void share(std::uint64_t client, ImageBuffer given);
  void forget_client(std::uint64_t client) { memories_.erase(client); }

  /// Without floats where the application has given none.
  const Memory& of(std::uint64_t client) const;

 private:
  struct Kept {
    ImageBuffer mapped;
    Memory memory;
  };

  Communicator& communicator_;
  Gather gather_;
  std::map<std::uint64_t, Kept> memories_;
};

}  // namespace understudy::compositor
