// SPDX-License-Identifier: Apache-2.0
// Metadata of Zarr arrays, version 3: zarr-specs.readthedocs.io/en/latest/v3.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "volume/file/chunks/zarr_array.h"

namespace understudy::volume {

/// Interprets the contents of `path`, a zarr.json. Throws FileError, or the exceptions of nlohmann-json.
ZarrArray array_of_version_3(const nlohmann::json& metadata, const std::string& path);

}  // namespace understudy::volume
