// SPDX-License-Identifier: Apache-2.0
// The JSON files of a Zarr folder, and what both versions of the format say in the same way.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "volume/file/chunks/chunk_codec.h"
#include "volume/file/chunks/element_type.h"
#include "volume/file/file_error.h"
#include "volume/file/readable_files.h"

namespace understudy::volume {

[[noreturn]] void fail_zarr(const std::string& path, const std::string& what);

/// Null where there is no such file. Throws FileError where it is no object, or nests deeper than metadata
/// does.
nlohmann::json json_in(const std::string& folder, const char* name, const ReadableFiles& files);

/// What `function` gives; what nlohmann-json throws of values of other types than they should have as a
/// FileError.
template <typename Function>
auto with_json(const std::string& path, const Function& function) {
  try {
    return function();
  } catch (const nlohmann::json::exception& error) {
    fail_zarr(path, fmt::format("its metadata is damaged ({}); get it again", error.what()));
  }
}

/// Throws FileError for a codec that is not read.
ChunkCodec zarr_codec(const std::string& name, const std::string& path);

/// A value as messages show it: its beginning.
std::string zarr_text(const nlohmann::json& value);

/// Whole numbers, such as lengths along axes. Throws FileError.
std::vector<std::int64_t> zarr_lengths(const nlohmann::json& numbers, const std::string& path);

/// The scalar that missing chunks consist of, of type `element.type`. Hexadecimal digits are the bits of an
/// element as it is stored; null is 0. Throws FileError for what is no value of such an element.
std::vector<std::byte> zarr_fill_value(const nlohmann::json& fill, const ElementType& element,
                                       const std::string& path);

inline std::string path_in(const std::string& folder, const std::string& name) {
  return (std::filesystem::path(folder) / name).string();
}

}  // namespace understudy::volume
