// SPDX-License-Identifier: Apache-2.0
#include "apps/viewer/description.h"

#include <GL/glew.h>
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "apps/viewer/model/error.h"

namespace viewer {

namespace {

using Json = nlohmann::ordered_json;

std::string gl_text(GLenum name) {
  const auto* text = reinterpret_cast<const char*>(glGetString(name));
  return text ? text : "";
}

Json describe_volume(const VolumeFacts& volume) {
  std::error_code no_path;
  const auto absolute = std::filesystem::absolute(volume.file, no_path);
  return {{"file", no_path ? volume.file : absolute.string()},
          {"size", volume.size},
          {"type", name_of(volume.type)},
          {"spacing", volume.spacing},
          {"value_at_0", volume.value_at_0},
          {"value_at_1", volume.value_at_1},
          {"not_finite", volume.not_finite}};
}

Json describe_matrices(ModeKind mode, const Matrices& matrices) {
  Json described = {{"modelview", to_float(matrices.modelview)}, {"projection", to_float(matrices.projection)}};
  // The core profile has no matrix stacks: its only uniform is the product.
  if (mode == ModeKind::core)
    described["modelview_projection"] = to_float(matrices.projection * matrices.modelview);
  return described;
}

Json describe_slices(const Box& box, const SliceStack& stack) {
  const Vec3 normal_texture = scale(stack.normal, box.edges);
  Json offsets = Json::array(), polygons = Json::array();
  for (const Slice& slice : stack.slices) {
    // Object space is centred at the origin, texture space at (1/2, 1/2, 1/2).
    offsets.push_back(slice.offset + 0.5 * (normal_texture[0] + normal_texture[1] + normal_texture[2]));
    Json polygon = Json::array();
    for (std::uint32_t i = slice.first; i < slice.first + slice.count; ++i)
      polygon.push_back(stack.vertices[i].texture);
    polygons.push_back(std::move(polygon));
  }
  return {{"order", stack.front_to_back ? "front to back" : "back to front"},
          {"count", stack.slices.size()},
          {"spacing_object", stack.spacing},
          {"normal_object", stack.normal},
          {"normal_texture", normal_texture},
          {"offsets", std::move(offsets)},
          {"polygons_texture", std::move(polygons)}};
}

Json describe_classification(ModeKind mode, const Scene& scene) {
  return {
      {"preset", scene.preset().name},
      {"applied", mode == ModeKind::rgba || mode == ModeKind::stacks ? "to each voxel, before interpolation"
                                                                     : "to each sample, after interpolation"},
      {"lookup", "entry i is texel value i/255, linear between entries, clamped"},
      {"alpha", "not premultiplied, per slice, opacity correction included"},
      {"entries_rgba8", scene.table()}};
}

Json describe_volumes(const std::vector<DrawnVolume>& volumes) {
  Json described = Json::array();
  for (const DrawnVolume& volume : volumes)
    described.push_back({{"object_from_texture", {{"scale", volume.scale}, {"translate", volume.translate}}},
                         {"entries_rgba8", volume.colours}});
  return described;
}

Json describe_solid(const OpaqueGeometry& geometry) {
  Json positions = Json::array(), colours = Json::array();
  for (std::size_t i = 0; i < geometry.triangles.size(); ++i) {
    positions.push_back(geometry.triangles[i].position);
    if (i % 3 == 0) colours.push_back(geometry.triangles[i].colour);
  }
  return {{"positions", std::move(positions)}, {"colours", std::move(colours)}};
}

Json describe_blend(Operator op) {
  const BlendNames names = blend_names(op);
  return {{"source", names.source}, {"destination", names.destination}, {"equation", names.equation}};
}

}  // namespace

void write_description(const std::string& path, const Options& options, const Scene& scene,
                       const DrawnFrame& frame, int frame_index) {
  const Box& box = scene.box();
  const Json description = {
      {"frame", frame_index},
      {"mode", name_of(options.mode)},
      {"volume", describe_volume(scene.volume())},
      {"texture",
       {{"size", scene.volume().size},
        {"internal_format", scene.texture_format()},
        {"filter", "GL_LINEAR"},
        {"wrap", "GL_CLAMP_TO_EDGE"}}},
      {"viewport", {0, 0, frame.width, frame.height}},
      {"camera",
       {{"azimuth", frame.camera.azimuth},
        {"elevation", frame.camera.elevation},
        {"distance", frame.camera.distance},
        {"orthographic", frame.camera.orthographic}}},
      {"matrices", describe_matrices(options.mode, frame.matrices)},
      {"object_from_texture", {{"scale", box.edges}, {"translate", -0.5 * box.edges}}},
      {"volumes", describe_volumes(frame.volumes)},
      {"slices", describe_slices(box, frame.stack)},
      {"solid", describe_solid(scene.opaque())},
      {"classification", describe_classification(options.mode, scene)},
      {"opacity_correction",
       {{"formula", "1 - (1 - alpha)^exponent"},
        {"reference_distance_object", box.finest_voxel_edge},
        {"exponent", scene.opacity_exponent()}}},
      {"blend", describe_blend(scene.op())},
      {"background", {options.background[0], options.background[1], options.background[2], 0.0}},
      {"frame_and_axes_drawn", options.frame_and_axes},
      {"opengl", {{"renderer", gl_text(GL_RENDERER)}, {"version", gl_text(GL_VERSION)}}},
  };
  std::ofstream file(path);
  // File names may be invalid UTF-8: replace invalid bytes instead of failing.
  file << description.dump(1, ' ', false, Json::error_handler_t::replace) << '\n';
  file.close();
  if (!file)
    throw Error(
        ExitCode::bad_file,
        fmt::format(
            "{}: the description cannot be written; check that the folder exists and the disk is not full",
            path));
}

}  // namespace viewer
