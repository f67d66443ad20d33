// Chains from text, as Chromium's configurations made them: "track volume driver".
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "spu/chain.h"
#include "spu/volume/render_session.h"

namespace understudy::spu {

/// Adds the units named in `description`, the one nearest to the application first; "driver" stands for the
/// real OpenGL and must be last. Returns what is wrong with the description, or nothing.
std::optional<std::string> assemble(Chain& chain, std::string_view description,
                                    std::shared_ptr<RenderSession> session);

}  // namespace understudy::spu
