// SPDX-License-Identifier: Apache-2.0
// The JSON files of a Zarr folder, and metadata that both versions of the format encode in the same way.
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

/// Null if there is no such file. Throws FileError if it is not an object, or is nested deeper than metadata
/// can be.
nlohmann::json json_in(const std::string& folder, const char* name, const ReadableFiles& files);

/// Returns the result of `function`. Converts exceptions of nlohmann-json for values of unexpected types to
/// FileError.
template <typename Function>
auto with_json(const std::string& path, const Function& function) {
  try {
    return function();
  } catch (const nlohmann::json::exception& error) {
    fail_zarr(path, fmt::format("its metadata is damaged ({}); get it again", error.what()));
  }
}

/// Throws FileError for an unsupported codec.
ChunkCodec zarr_codec(const std::string& name, const std::string& path);

/// The beginning of a value, for messages.
std::string zarr_text(const nlohmann::json& value);

/// Integers, such as lengths along axes. Throws FileError.
std::vector<std::int64_t> zarr_lengths(const nlohmann::json& numbers, const std::string& path);

/// The scalar that fills missing chunks, of type `element.type`. Hexadecimal digits are the bits of an element
/// as it is stored; null is 0. Throws FileError for invalid values.
std::vector<std::byte> zarr_fill_value(const nlohmann::json& fill, const ElementType& element,
                                       const std::string& path);

inline std::string path_in(const std::string& folder, const std::string& name) {
  return (std::filesystem::path(folder) / name).string();
}

}  // namespace understudy::volume
