// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/file_scene/file_hints.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace understudy::launcher {

void add_file_hints(CLI::App& subcommand, FileHintOptions& hints) {
  subcommand.add_option("--volume-size", hints.size, "size of a raw volume, in voxels")
      ->type_name("X Y Z")
      ->expected(3);
  subcommand.add_option(
      "--type", hints.type,
      "type of the scalars of a raw volume: u8, i8, u16, i16, u32, i32, u64, i64, f32 or f64");
  subcommand.add_flag("--big-endian", hints.big_endian,
                      "the scalars of a raw volume have the most significant byte first");
  subcommand
      .add_option("--channel", hints.channel, "channel to read, of an image with several, counted from 0")
      ->type_name("N")
      ->check(CLI::NonNegativeNumber);
}

volume::FileHints file_hints(const FileHintOptions& hints) {
  volume::FileHints told;
  if (!hints.size.empty()) {
    told.size.emplace();
    std::ranges::copy(hints.size, told.size->begin());
  }
  if (!hints.type.empty()) {
    told.type = volume::scalar_type_named(hints.type);
    if (!told.type)
      throw std::invalid_argument(fmt::format(
          "there is no type '{}'; give u8, i8, u16, i16, u32, i32, u64, i64, f32 or f64", hints.type));
  }
  if (hints.big_endian) told.big_endian = true;
  told.channel = hints.channel;
  return told;
}

}  // namespace understudy::launcher
