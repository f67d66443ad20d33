// Volumes that the application cut into many 3-D textures, and draws brick by brick: in the first frame each is
// a volume of its own; where they turn out to be a tiling, the requests of later frames wait until the last
// brick is drawn, and one request for the whole takes their place.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "spu/volume/merging/tiling.h"
#include "spu/volume/substitution.h"
#include "volume/texel_box.h"
#include "volume/texel_type.h"

namespace understudy::spu {

/// A volume of several textures.
struct MergedVolume {
  std::vector<GLuint> textures;
  std::vector<TextureDescription> descriptions;  ///< as the tiling was found for
  std::vector<std::uint64_t> versions;           ///< of the textures, whose texels the service has
  std::vector<volume::TexelBox> shown;           ///< of each texture's own texels
  Tiling tiling;
  KnownVolume volume;       ///< the whole
  std::string handed_back;  ///< why it is drawn brick by brick for good; empty: it is not

  std::optional<std::size_t> place_of(GLuint texture) const;
};

/// A run that has been understood, and is not shown yet. Its calls are gone.
struct VolumeUnit::HeldRun {
  std::unique_ptr<Run> run;
  Substitution s;
};

struct VolumeUnit::Merging {
  /// Bricks that were shown one by one in this frame and have one lattice and one classification.
  struct Group {
    std::vector<GLuint> textures;
    std::vector<DrawnBrick> bricks;
    volume::TexelType type{};
  };

  std::vector<std::unique_ptr<MergedVolume>> volumes;
  std::vector<Group> groups;
  /// What each texture's slices ever read, in its texels.
  std::map<GLuint, volume::TexelBox> shown;
  std::vector<HeldRun> held;
  MergedVolume* held_volume = nullptr;   ///< of which the held runs are bricks
  std::unique_ptr<NativeDrawing> drawn;  ///< what they draw themselves, in frames that are verified
  /// Tilings that hold for one view only are found ever more rarely.
  std::uint64_t next_search = 0;
  std::uint64_t pause = 1;

  MergedVolume* volume_with(GLuint texture) const;
};

}  // namespace understudy::spu
