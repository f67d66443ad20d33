// SPDX-License-Identifier: Apache-2.0
#include "compositor/service/load_protocol.h"

#include <array>
#include <stdexcept>

#include "compositor/service/limits.h"
#include "compositor/service/node_protocol.h"
#include "compositor/transport/wire.h"
#include "volume/cell_lattice.h"
#include "volume/file/series.h"

namespace understudy::compositor {

namespace {

constexpr std::uint64_t max_path_bytes = 4096;
constexpr std::uint64_t max_description_bytes = 4096;

}  // namespace

std::vector<std::byte> encode(const LoadRequest& request) {
  Writer out;
  out.run(encode(request.volume));
  out.run(std::as_bytes(std::span(request.file)));
  out.integer(request.hints.size.has_value());
  if (request.hints.size)
    for (const int extent : *request.hints.size) out.integer(extent);
  out.integer(request.hints.type.has_value());
  if (request.hints.type) out.integer(std::int64_t(*request.hints.type));
  out.integer(request.hints.big_endian.has_value());
  if (request.hints.big_endian) out.integer(*request.hints.big_endian);
  out.integer(request.hints.level);
  out.integer(request.hints.time_step);
  out.integer(request.hints.channel.has_value());
  if (request.hints.channel) out.integer(*request.hints.channel);
  out.integer(request.texels.type.has_value());
  if (request.texels.type) out.integer(std::int64_t(*request.texels.type));
  out.integer(request.texels.range.has_value());
  if (request.texels.range)
    for (const double value : *request.texels.range) out.real(value);
  return out.bytes();
}

LoadRequest decode_load_request(std::span<const std::byte> payload) {
  Reader in("load_volume", payload);
  LoadRequest request;
  request.volume = decode_volume(in.run("volume", max_description_bytes));
  const std::span<const std::byte> file = in.run("file", max_path_bytes);
  request.file.assign(reinterpret_cast<const char*>(file.data()), file.size());
  if (request.file.find('\0') != std::string::npos) in.fail("file", "holds a zero");
  if (in.flag("hints.size")) {
    request.hints.size.emplace();
    for (int& extent : *request.hints.size) extent = in.small("hints.size", 1, volume::max_axis_texels);
  }
  if (in.flag("hints.type")) request.hints.type = in.enumerator("hints.type", volume::ScalarType::f64);
  if (in.flag("hints.big_endian")) request.hints.big_endian = in.flag("hints.big_endian");
  constexpr int most_levels = 16;
  request.hints.level = in.small("hints.level", 0, most_levels);
  request.hints.time_step = in.small("hints.time_step", 0, int(volume::max_time_steps) - 1);
  constexpr int most_channels = 1 << 20;
  if (in.flag("hints.channel")) request.hints.channel = in.small("hints.channel", 0, most_channels);
  if (in.flag("texels.type")) request.texels.type = in.enumerator("texels.type", volume::TexelType::rgba8);
  if (in.flag("texels.range")) {
    request.texels.range.emplace();
    for (double& value : *request.texels.range) value = in.real("texels.range");
  }
  in.end();
  return request;
}

std::vector<std::byte> encode(std::span<const RankLoad> ranks) {
  Writer out;
  out.integer(std::int64_t(ranks.size()));
  for (const RankLoad& rank : ranks) {
    for (const std::uint64_t value : {rank.texels_done, rank.texels_in_all, rank.bytes_read, rank.brick_bytes,
                                      rank.peak_bytes, rank.not_numbers})
      out.integer(std::int64_t(value));
    for (const double value : {rank.low, rank.high, rank.largest_error}) out.real(value);
    for (const std::array<int, 3>& corner : {rank.cells.low, rank.cells.high})
      for (const int cell : corner) out.integer(cell);
    out.real(rank.image_ms);
    out.real(rank.image_processor_ms);
    out.integer(std::int64_t(rank.image_samples));
  }
  return out.bytes();
}

std::vector<RankLoad> decode_loads(std::span<const std::byte> payload) {
  Reader in("loading", payload);
  std::vector<RankLoad> ranks;
  const int count = in.small("ranks", 1, limits::max_ranks);
  for (int i = 0; i < count; ++i) {
    RankLoad& rank = ranks.emplace_back();
    for (std::uint64_t* value : {&rank.texels_done, &rank.texels_in_all, &rank.bytes_read, &rank.brick_bytes,
                                 &rank.peak_bytes, &rank.not_numbers})
      *value = in.word("figures of a rank");
    for (double* value : {&rank.low, &rank.high, &rank.largest_error}) *value = in.real("values of a rank");
    for (std::array<int, 3>* corner : {&rank.cells.low, &rank.cells.high})
      for (int& cell : *corner) cell = in.small("cells of a rank", -1, volume::max_axis_texels + 1);
    rank.image_ms = in.real("image_ms of a rank");
    rank.image_processor_ms = in.real("image_processor_ms of a rank");
    rank.image_samples = in.word("image_samples of a rank");
  }
  in.end();
  return ranks;
}

std::vector<std::byte> encode(const HistogramQuestion& question) {
  Writer out;
  out.integer(std::int64_t(question.volume));
  out.real(question.bins.low);
  out.real(question.bins.high);
  out.integer(question.bins.count);
  return out.bytes();
}

HistogramQuestion decode_histogram_question(std::span<const std::byte> payload) {
  Reader in("histogram", payload);
  HistogramQuestion question;
  question.volume = in.word("volume");
  question.bins.low = in.real("low");
  question.bins.high = in.real("high");
  question.bins.count = in.small("count", 1, volume::max_histogram_bins);
  try {
    volume::check(question.bins);
  } catch (const std::invalid_argument& error) {
    in.fail("bins", error.what());
  }
  in.end();
  return question;
}

std::vector<std::byte> encode_histogram(std::span<const std::uint64_t> counts) {
  Writer out;
  out.run(std::as_bytes(counts));
  return out.bytes();
}

std::vector<std::uint64_t> decode_histogram(std::span<const std::byte> payload) {
  Reader in("histogram's reply", payload);
  std::vector<std::uint64_t> counts = in.values<std::uint64_t>("counts", volume::max_histogram_bins);
  in.end();
  return counts;
}

}  // namespace understudy::compositor
