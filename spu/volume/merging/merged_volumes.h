// SPDX-License-Identifier: Apache-2.0
// Finds textures that are bricks of one volume. In the first frame each is a volume of its own; if they form a
// tiling, they are drawn as one volume from then on.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "spu/volume/geometry/recognised_run.h"
#include "spu/volume/known_volumes/known_volumes.h"
#include "spu/volume/merging/merged_volume.h"

namespace understudy::spu {

class ShareGroup;

class MergedVolumes {
 public:
  MergedVolumes(ShareGroup& group, RenderSession& session, KnownVolumes& volumes)
      : group_(group), session_(session), volumes_(volumes) {}

  /// Records a run of slices that was shown by itself with `request`: it may be a brick.
  void note_brick(const Pipeline& pipeline, const RecognisedRun& seen, const volume::RenderRequest& request,
                  const TextureDescription& texture);
  /// Searches for tilings among the bricks that were recorded since the last call.
  void find();

  /// Returns the volume that `texture` is a brick of; null if there is none.
  MergedVolume* volume_with(GLuint texture) const;
  /// Whether `texture` is a brick of a volume, or will be once find() is called.
  bool is_brick(GLuint texture);
  /// Returns why the application itself draws the bricks of `merged` with `program` in this frame, for the sake
  /// of speed; null if there is no reason.
  std::optional<Refusal> speed_refusal(MergedVolume& merged, GLuint program);
  /// `texture` has changed, or its slices read more `texels`: forgets its volume, and learns it anew.
  void learn_anew(GLuint texture, const volume::TexelBox& texels);

  void forget_deleted();
  void forget_all();

 private:
  /// Bricks that were shown one by one in this frame, and have one lattice and one classification.
  struct Group {
    std::vector<GLuint> textures;
    std::vector<DrawnBrick> bricks;
    volume::TexelType type{};
  };

  bool belongs(const Group& group, GLuint texture, const DrawnBrick& brick, volume::TexelType type,
               const volume::Classification& classification);
  bool may_be_one(const Group& group);
  std::unique_ptr<MergedVolume> merged(const Group& group);
  void forget(GLuint texture);
  void forget_texels(const MergedVolume& merged);

  ShareGroup& group_;
  RenderSession& session_;
  KnownVolumes& volumes_;
  std::vector<std::unique_ptr<MergedVolume>> merged_;
  std::vector<Group> groups_;
  std::map<GLuint, volume::TexelBox> shown_;    ///< texels that the slices of each texture have ever read
  std::map<GLuint, std::uint64_t> identities_;  ///< of these textures (ShareGroup)
  /// Tilings that hold for one view only are searched for less and less often.
  std::uint64_t next_search_ = 0;
  std::uint64_t pause_ = 1;
};

}  // namespace understudy::spu
