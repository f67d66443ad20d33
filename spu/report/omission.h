// What is left out of frames because nobody would see it, by name: the report counts each, and
// `--never-leave-out` has each done nevertheless, to see what it is worth and that the picture stays.
#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace understudy::spu {

enum class Omission : std::uint8_t {
  empty_blocks,
  hidden_samples,
  lesser_samples,
  footprints,
  unchanged_pictures,
  unchanged_texels,
  known_colours,
  absent_depth,
  unseen_depth,
};
constexpr std::size_t omission_count = 9;

struct OmissionText {
  const char* name;
  const char* unit;  ///< of what is counted, plural
  const char* what;  ///< is left out
  double tolerance;  ///< how far the picture, its brightest colour 1, may be off: 0 is bit for bit
};

/// In the order of Omission.
std::span<const OmissionText> omission_table();
const OmissionText& text_of(Omission omission);

using Omissions = std::bitset<omission_count>;

/// Names with commas between, or "all", or "none"; nothing where a name is unknown.
std::optional<Omissions> omissions_in(std::string_view names);

/// All names, with commas between.
std::string omission_names();

}  // namespace understudy::spu
