// SPDX-License-Identifier: Apache-2.0
#include "compositor/service/node_protocol.h"

#include <array>
#include <string>

#include "compositor/service/limits.h"
#include "compositor/service/rect_fields.h"
#include "compositor/transport/wire.h"
#include "volume/cell_lattice.h"

namespace understudy::compositor {

namespace {

using namespace volume;

constexpr std::array<const char*, 3> x_y_z{"x", "y", "z"};

}  // namespace

std::vector<std::byte> encode(const VolumeDescription& volume) {
  Writer out;
  out.integer(std::int64_t(volume.id));
  out.integer(std::int64_t(volume.version));
  for (const int extent : volume.size) out.integer(extent);
  out.integer(std::int64_t(volume.type));
  for (const Wrap wrap : volume.wrap) out.integer(std::int64_t(wrap));
  for (const float value : volume.border) out.real(value);
  for (const int value : volume.stored.low) out.integer(value);
  for (const int value : volume.stored.high) out.integer(value);
  out.integer(volume.ghost_layer);
  out.integer(volume.part.has_value());
  if (volume.part)
    for (const std::array<int, 3>& corner : {volume.part->low, volume.part->high})
      for (const int cell : corner) out.integer(cell);
  return out.bytes();
}

VolumeDescription decode_volume(std::span<const std::byte> payload) {
  Reader in("begin volume", payload);
  VolumeDescription volume;
  volume.id = in.word("id");
  volume.version = in.word("version");
  for (std::size_t axis = 0; axis < 3; ++axis)
    volume.size[axis] = in.small(std::string("size.") + x_y_z[axis], 1, max_axis_texels);
  volume.type = in.enumerator("type", TexelType::rgba8);
  for (Wrap& wrap : volume.wrap) wrap = in.enumerator("wrap", Wrap::repeat);
  for (float& value : volume.border) value = in.real32("border");
  for (std::size_t axis = 0; axis < 3; ++axis)
    volume.stored.low[axis] = in.small(std::string("stored.low.") + x_y_z[axis], 0, volume.size[axis] - 1);
  for (std::size_t axis = 0; axis < 3; ++axis)
    volume.stored.high[axis] =
        in.small(std::string("stored.high.") + x_y_z[axis], volume.stored.low[axis] + 1, volume.size[axis]);
  volume.ghost_layer = in.small("ghost_layer", 0, max_axis_texels);
  if (in.flag("part")) {
    volume.part.emplace();
    for (std::array<int, 3>* corner : {&volume.part->low, &volume.part->high})
      for (int& cell : *corner) cell = in.small("part", -1, max_axis_texels + 1);
  }
  in.end();
  return volume;
}

std::vector<std::byte> encode(const Change& change) {
  Writer out;
  out.integer(std::int64_t(change.volume));
  out.integer(std::int64_t(change.version));
  return out.bytes();
}

Change decode_change(std::span<const std::byte> payload) {
  Reader in("begin change", payload);
  Change change;
  change.volume = in.word("volume");
  change.version = in.word("version");
  in.end();
  return change;
}

std::vector<std::byte> encode_texels_head(const Texels& texels) {
  Writer out;
  out.integer(std::int64_t(texels.volume));
  out.integer(std::int64_t(texels.boxes.size()));
  for (const TexelBox& box : texels.boxes) {
    for (const int value : box.low) out.integer(value);
    for (const int value : box.high) out.integer(value);
  }
  out.integer(std::int64_t(texels.texels.size()));
  return out.bytes();
}

Texels decode_texels(std::span<const std::byte> payload) {
  Reader in("texels", payload);
  Texels texels;
  texels.volume = in.word("volume");
  texels.boxes.resize(std::size_t(in.integer("boxes", 1, limits::max_boxes_per_message)));
  for (TexelBox& box : texels.boxes) {
    for (int& value : box.low) value = in.small("boxes.low", 0, max_axis_texels - 1);
    for (std::size_t axis = 0; axis < 3; ++axis)
      box.high[axis] = in.small("boxes.high", box.low[axis] + 1, max_axis_texels);
  }
  texels.texels = in.run("texels", limits::max_slice_bytes);
  in.end();
  return texels;
}

std::vector<std::byte> encode(const RenderedReply& reply) {
  Writer out;
  write(out, reply.rect);
  const FrameCounts& counts = reply.counts;
  for (const std::uint64_t value :
       {counts.rays, counts.rays_terminated, counts.samples, counts.samples_taken, counts.samples_hidden,
        counts.dominated_samples, counts.blocks, counts.blocks_empty, counts.nodes_idle, counts.bytes_exchanged,
        counts.bytes_of_whole_windows, counts.messages, counts.messages_of_whole_windows})
    out.integer(std::int64_t(value));
  out.real(counts.division_ms);
  out.real(counts.render_ms);
  out.real(counts.processor_ms);
  out.real(counts.composite_ms);
  out.integer(reply.lossy);
  return out.bytes();
}

RenderedReply decode_rendered(std::span<const std::byte> payload) {
  Reader in("rendered", payload);
  RenderedReply reply;
  reply.rect = read_pixels(in, "rect");
  FrameCounts& counts = reply.counts;
  for (std::uint64_t* value :
       {&counts.rays, &counts.rays_terminated, &counts.samples, &counts.samples_taken, &counts.samples_hidden,
        &counts.dominated_samples, &counts.blocks, &counts.blocks_empty, &counts.nodes_idle,
        &counts.bytes_exchanged, &counts.bytes_of_whole_windows, &counts.messages,
        &counts.messages_of_whole_windows})
    *value = in.word("counts");
  counts.division_ms = in.real("counts.division_ms");
  counts.render_ms = in.real("counts.render_ms");
  counts.processor_ms = in.real("counts.processor_ms");
  counts.composite_ms = in.real("counts.composite_ms");
  reply.lossy = in.flag("lossy");
  in.end();
  return reply;
}

std::vector<std::byte> encode_id(VolumeId id) {
  Writer out;
  out.integer(std::int64_t(id));
  return out.bytes();
}

VolumeId decode_id(std::span<const std::byte> payload) {
  Reader in("volume id", payload);
  const VolumeId id = in.word("id");
  in.end();
  return id;
}

std::vector<std::byte> encode_size(std::uint64_t bytes) {
  Writer out;
  out.integer(std::int64_t(bytes));
  return out.bytes();
}

std::uint64_t decode_size(std::span<const std::byte> payload) {
  Reader in("image buffer", payload);
  const auto size = in.integer("bytes", 1, std::int64_t(limits::max_window_pixels * 4 * sizeof(float)));
  in.end();
  return std::uint64_t(size);
}

}  // namespace understudy::compositor
