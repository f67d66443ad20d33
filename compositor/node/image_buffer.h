// SPDX-License-Identifier: Apache-2.0
// The image buffers of applications, as every rank sees them: ranks on rank 0's machine map them too, and write
// their regions there themselves; the others send theirs to rank 0.
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
    std::size_t floats = 0;        ///< size of the buffer
    std::span<float> here;         ///< as this rank maps it; empty if it does not
    std::vector<bool> reached_by;  ///< by rank, the same on all ranks
  };

  ImageBuffers(Communicator& communicator, Gather gather) : communicator_(communicator), gather_(gather) {}

  /// Collective. On rank 0, `given` is what the application gave, empty if that was unusable. It replaces the
  /// application's previous buffer.
  void share(std::uint64_t client, ImageBuffer given);
  void forget_client(std::uint64_t client) { memories_.erase(client); }

  /// Zero floats if the application has given no buffer.
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
