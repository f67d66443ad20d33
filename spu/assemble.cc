#include "spu/assemble.h"

#include <fmt/format.h>

#include <sstream>

#include "spu/track/track.h"
#include "spu/volume/volume_unit.h"

namespace understudy::spu {

std::optional<std::string> assemble(Chain& chain, std::string_view description,
                                    std::shared_ptr<RenderSession> session) {
  std::istringstream words{std::string(description)};
  std::string name;
  bool driver = false;
  while (words >> name) {
    if (driver) return fmt::format("chain \"{}\": the driver must be last", description);
    if (name == "track") {
      chain.add<Track>();
    } else if (name == "volume") {
      if (chain.find<Track>() == nullptr)
        return fmt::format("chain \"{}\": volume needs track before it", description);
      chain.add<VolumeUnit>(session);
    } else if (name == "driver") {
      driver = true;
    } else {
      return fmt::format("chain \"{}\": no unit is named {}; there are track, volume and driver", description,
                         name);
    }
  }
  if (!driver) return fmt::format("chain \"{}\": it must end in driver", description);
  return std::nullopt;
}

}  // namespace understudy::spu
