// SPDX-License-Identifier: Apache-2.0
#include "compositor/scene/exported_scene.h"

#include <fmt/format.h>

#include <filesystem>
#include <iterator>
#include <utility>

#include "compositor/scene/json_fields.h"
#include "compositor/scene/json_limits.h"
#include "compositor/service/node_protocol.h"
#include "compositor/service/request_message.h"
#include "compositor/transport/wire.h"

namespace understudy::compositor {
namespace {

constexpr const char* format_name = "understudy-scene";
constexpr const char* format_key = "format";
constexpr const char* version_key = "version";
constexpr const char* origin_key = "origin";
constexpr const char* volume_key = "volume";
constexpr const char* texels_key = "texels";
constexpr const char* request_key = "request";

/// Objects take a line for each key, and everything else one line.
void append(std::string& text, const Json& json, std::size_t indent) {
  constexpr auto replace = Json::error_handler_t::replace;  // names of programs may be invalid UTF-8
  if (!json.is_object() || json.empty()) {
    text += json.dump(-1, ' ', false, replace);
    return;
  }
  text += "{\n";
  for (auto member = json.begin(); member != json.end(); ++member) {
    text += std::string(indent + 1, ' ') + Json(member.key()).dump() + ": ";
    append(text, member.value(), indent + 1);
    text += std::next(member) == json.end() ? "\n" : ",\n";
  }
  text += std::string(indent, ' ') + "}";
}

Json json_of(const SceneOrigin& origin) {
  return {{"program", origin.program},
          {"frame", origin.frame},
          {"texture_format", origin.texture_format},
          {"psnr", origin.psnr ? Json(*origin.psnr) : Json(nullptr)}};
}

const Json& member(const Json& object, const char* name) {
  const auto found = object.find(name);
  if (found == object.end()) fail_at(name, "is missing");
  return *found;
}

void check_format(const Json& json) {
  const auto format = json.is_object() ? json.find(format_key) : json.end();
  if (format == json.end() || !format->is_string() || format->get_ref<const std::string&>() != format_name)
    throw SceneError(fmt::format("it is no scene that `understudy run --export` wrote: '{}' is not '{}'",
                                 format_key, format_name));
  const Json& version = member(json, version_key);
  if (!version.is_number()) fail_at(version_key, "is not a number");
  if (version != scene_format_version)
    fail_at(version_key,
            fmt::format("is {}; this version of Understudy reads {}", version.dump(), scene_format_version));
}

/// Informative only: what is missing or of another type stays empty.
SceneOrigin origin_in(const Json& json) {
  SceneOrigin origin;
  const auto found = json.find(origin_key);
  if (found == json.end() || !found->is_object()) return origin;
  const auto text = [&](const char* name) {
    const auto value = found->find(name);
    return value != found->end() && value->is_string() ? value->get<std::string>() : std::string();
  };
  origin.program = text("program");
  origin.texture_format = text("texture_format");
  const auto frame = found->find("frame");
  if (frame != found->end() && frame->is_number_unsigned()) origin.frame = frame->get<std::uint64_t>();
  const auto psnr = found->find("psnr");
  if (psnr != found->end() && psnr->is_number()) origin.psnr = psnr->get<double>();
  return origin;
}

/// The name of a file in the scene's folder: a scene must not make anybody read other files.
std::string file_name_in(const Json& json, const char* key) {
  const Json& name = member(json, key);
  if (!name.is_string()) fail_at(key, "is not the name of a file");
  const auto& text = name.get_ref<const std::string&>();
  const std::filesystem::path path(text);
  if (text.empty() || text == "." || text == ".." || path.filename() != path || text.find('\0') != text.npos)
    fail_at(key, "is not the name of a file in the scene's folder");
  return text;
}

/// Returns the values as a node would get them in messages, within its limits.
void check_limits(const ExportedScene& scene) {
  try {
    decode_volume(encode(scene.volume));
    decode_request(encode(scene.request));
  } catch (const MalformedMessage& malformed) {
    throw SceneError(fmt::format("a value is outside the limits of Understudy: {}", malformed.what()));
  }
}

ExportedScene read_scene(std::string_view text) {
  JsonLimits limits;
  Json::sax_parse(text, &limits);
  const Json json = Json::parse(text);
  check_format(json);
  ExportedScene scene;
  scene.origin = origin_in(json);
  scene.texels = file_name_in(json, texels_key);
  JsonReader volume(member(json, volume_key), volume_key);
  fields(volume, scene.volume);
  JsonReader request(member(json, request_key), request_key);
  fields(request, scene.request);
  scene.volume.id = scene.request.volume = 1;
  scene.volume.version = scene.request.version = 1;
  check_limits(scene);
  return scene;
}

}  // namespace

std::string scene_text(const ExportedScene& scene) {
  Json json{{format_key, format_name},
            {version_key, scene_format_version},
            {origin_key, json_of(scene.origin)},
            {texels_key, scene.texels}};
  JsonWriter volume(json[volume_key], volume_key);
  fields(volume, scene.volume);
  JsonWriter request(json[request_key], request_key);
  fields(request, scene.request);
  std::string text;
  append(text, json, 0);
  text += "\n";
  if (text.size() > max_scene_bytes)
    throw SceneError(fmt::format("the scene takes {} MiB as JSON, more than {}", text.size() >> 20U,
                                 max_scene_bytes >> 20U));
  return text;
}

ExportedScene scene_in(std::string_view text) {
  if (text.size() > max_scene_bytes)
    throw SceneError(fmt::format("it is longer than {} MiB", max_scene_bytes >> 20U));
  try {
    return read_scene(text);
  } catch (const nlohmann::json::exception& error) {
    throw SceneError(fmt::format("it is not valid JSON: {}", error.what()));
  }
}

}  // namespace understudy::compositor
