// SPDX-License-Identifier: Apache-2.0
#include "compositor/service/loads.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <utility>
#include <vector>

#include "volume/description.h"
#include "volume/file/file_error.h"
#include "volume/opening/open_volume.h"

namespace understudy::compositor {

namespace {

std::uint64_t peak_resident_bytes() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return std::uint64_t(usage.ru_maxrss) << 10U;
}

}  // namespace

void Loads::begin(VolumeKey key, const LoadRequest& request) {
  forget(key);
  std::unique_ptr<volume::VolumeFile> file = volume::open_volume(request.file, request.hints, files_, headers_);
  const volume::TexelMapping mapping = volume::mapping_of(file->description(), request.texels);
  const volume::VolumeDescription& wanted = request.volume;
  if (file->description().size != wanted.size || mapping.type != wanted.type ||
      wanted.stored != volume::TexelBox{{0, 0, 0}, wanted.size})
    throw volume::FileError(fmt::format(
        "{}: is not the volume of {} x {} x {} texels that was announced; it may have changed: ask again",
        request.file, wanted.size[0], wanted.size[1], wanted.size[2]));
  renderer_.begin(key.client, wanted);
  const std::vector<volume::TexelBox> share = renderer_.shares(key, {&wanted.stored, 1}, rank_);
  Load& load = loads_[key];
  load.stream.emplace(std::move(file), request.texels, share.empty() ? volume::TexelBox{} : share.front());
  load.figures.texels_in_all = load.stream->texels_in_all();
  load.figures.bytes_read = load.stream->bytes_read();
}

void Loads::read_on(VolumeKey key) {
  const auto found = loads_.find(key);
  if (found == loads_.end())
    throw RequestRefused(fmt::format("volume {} is not being loaded here", key.volume));
  Load& load = found->second;
  if (!load.stream || load.stream->done()) return;
  const bool is_there = load.stream->approach(passed_bytes);
  load.figures.bytes_read = load.stream->bytes_read();
  if (!is_there) return;
  const volume::TexelStream::SliceSegment slice_range = load.stream->next(part_bytes);
  renderer_.add_texels(key, {&slice_range.box, 1}, slice_range.texels);
  const volume::TexelFigures& figures = load.stream->figures();
  load.figures.texels_done = load.stream->texels_done();
  load.figures.bytes_read = load.stream->bytes_read();
  load.figures.low = figures.low;
  load.figures.high = figures.high;
  load.figures.largest_error = figures.largest_error;
  load.figures.not_numbers = figures.not_numbers;
}

RankLoad Loads::figures(VolumeKey key) const {
  const auto found = loads_.find(key);
  if (found == loads_.end()) return {};
  RankLoad figures = found->second.figures;
  figures.brick_bytes = renderer_.bytes(key);
  figures.peak_bytes = peak_resident_bytes();
  figures.cells = renderer_.cells(key);
  // Texels that several groups read count once.
  if (renderer_.arrangement(key).place(rank_).group > 0) figures.not_numbers = 0;
  return figures;
}

void Loads::drew(VolumeKey key, const volume::FrameCounts& counts) {
  const auto found = loads_.find(key);
  if (found == loads_.end()) return;
  found->second.figures.image_ms = counts.render_ms;
  found->second.figures.image_processor_ms = counts.processor_ms;
  found->second.figures.image_samples = counts.samples_taken;
}

void Loads::complete(VolumeKey key) {
  Load& load = loads_.at(key);
  if (!load.stream) return;
  load.stream.reset();
  renderer_.end(key);
}

void Loads::forget_client(std::uint64_t client) {
  std::erase_if(loads_, [&](const auto& entry) { return entry.first.client == client; });
  if (loads_.empty()) headers_ = {};
}

}  // namespace understudy::compositor
