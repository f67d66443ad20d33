// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/merging/merged_volumes.h"

#include <algorithm>
#include <utility>

#include "spu/track/share_group.h"
#include "spu/volume/texture/value_range.h"
#include "volume/texel_box.h"

namespace understudy::spu {
namespace {

constexpr std::uint64_t longest_pause = 1024;
/// Comparing all pairs of more bricks would take longer than drawing them one by one.
constexpr std::size_t most_bricks = 1024;

}  // namespace

MergedVolume* MergedVolumes::volume_with(GLuint texture) const {
  for (const auto& merged : merged_) {
    if (merged->place_of(texture)) return merged.get();
  }
  return nullptr;
}

bool MergedVolumes::belongs(const Group& group, GLuint texture, const DrawnBrick& brick, volume::TexelType type,
                            const volume::Classification& classification) {
  const KnownVolume* const first = volumes_.find(group.textures.front());
  if (first == nullptr || !first->colours.probed) return false;
  // The transfer function covers the values of its own brick.
  const bool same_colours = has_value_range(type) || first->colours.probed->classification == classification;
  return group.type == type && same_colours && group.textures.size() < most_bricks &&
         std::find(group.textures.begin(), group.textures.end(), texture) == group.textures.end() &&
         lattice_offset(group.bricks.front(), brick);
}

void MergedVolumes::note_brick(const Pipeline& pipeline, const RecognisedRun& seen,
                               const volume::RenderRequest& request, const TextureDescription& texture) {
  const bool plain = !seen.ray_caster && !pipeline.stack && !request.slice_segment && !request.fog &&
                     !(pipeline.depth_test && pipeline.depth_write);
  if (!plain) return;
  const GLuint name = pipeline.volume.texture;
  identities_.try_emplace(name, group_.identity(name));
  volume::TexelBox& shown = shown_[name];
  shown = volume::enclosing(volume::intersection(shown, {{0, 0, 0}, texture.size}),
                            texels_read(seen.slices.region, texture.size, texture.filter));
  const DrawnBrick brick{texture.size, seen.fit->texture_to_clip, seen.slices.region, shown};
  for (Group& group : groups_) {
    if (!belongs(group, name, brick, texture.type, request.classification)) continue;
    group.textures.push_back(name);
    group.bricks.push_back(brick);
    return;
  }
  groups_.push_back({{name}, {brick}, texture.type});
}

bool MergedVolumes::may_be_one(const Group& group) {
  if (group.textures.size() < 2) return false;
  const bool all_known = std::all_of(group.textures.begin(), group.textures.end(), [&](GLuint texture) {
    const KnownVolume* const brick = volumes_.find(texture);
    return brick != nullptr && brick->refusals.handed_back.empty();
  });
  const MergedVolume* const before = volume_with(group.textures.front());
  return all_known && (before == nullptr || before->textures.size() < group.textures.size());
}

std::unique_ptr<MergedVolume> MergedVolumes::merged(const Group& group) {
  const SentVolume& first = volumes_.find(group.textures.front())->sent;
  auto merged = std::make_unique<MergedVolume>();
  SentVolume& whole = merged->volume.sent;
  merged->textures = group.textures;
  whole.range = first.range;
  for (const GLuint texture : group.textures) {
    const SentVolume& brick = volumes_.find(texture)->sent;
    if (!alike(brick.texture, first.texture)) return nullptr;
    merged->descriptions.push_back(brick.texture);
    merged->versions.push_back(brick.texture_version);
    merged->shown.push_back(shown_[texture]);
    whole.range[0] = std::min(whole.range[0], brick.range[0]);
    whole.range[1] = std::max(whole.range[1], brick.range[1]);
  }
  auto tiling = find_tiling(group.bricks, first.texture.filter, first.texture.wrap);
  if (!std::holds_alternative<Tiling>(tiling)) return nullptr;
  merged->tiling = std::get<Tiling>(std::move(tiling));
  whole.texture = first.texture;
  whole.texture.size = merged->tiling.size;
  whole.range = value_range(whole.texture, whole.range);
  return merged;
}

void MergedVolumes::find() {
  const std::vector<Group> groups = std::exchange(groups_, {});
  if (session_.ledger().frames() < next_search_) return;
  for (const Group& group : groups) {
    if (!may_be_one(group)) continue;
    auto found = merged(group);
    if (!found) continue;
    for (const GLuint texture : group.textures) forget(texture);
    std::vector<VolumeCounters*> counters;
    for (const GLuint texture : group.textures) counters.push_back(volumes_.find(texture)->counters);
    found->volume.counters = &count_as_one(counters);
    for (const GLuint texture : group.textures) volumes_.find(texture)->counters = found->volume.counters;
    merged_.push_back(std::move(found));
  }
}

std::optional<Refusal> MergedVolumes::speed_refusal(MergedVolume& merged, GLuint program) {
  const std::uint64_t frames = session_.ledger().frames();
  if (merged.frames_at_verdict == frames) return merged.verdict;
  merged.frames_at_verdict = frames;
  merged.verdict = spu::speed_refusal(merged.volume, state_of(merged.textures, program, group_));
  return merged.verdict;
}

bool MergedVolumes::is_brick(GLuint texture) {
  if (volume_with(texture) != nullptr) return true;
  return std::ranges::any_of(groups_, [&](const Group& group) {
    return std::ranges::find(group.textures, texture) != group.textures.end() && may_be_one(group) &&
           merged(group) != nullptr;
  });
}

void MergedVolumes::learn_anew(GLuint texture, const volume::TexelBox& texels) {
  forget(texture);
  volume::TexelBox& shown = shown_[texture];
  shown = volume::enclosing(shown, texels);
  // Some bricks of this frame have been shown already, and are not recorded.
  next_search_ = session_.ledger().frames() + 1 + pause_;
  pause_ = std::min(2 * pause_, longest_pause);
}

void MergedVolumes::forget_texels(const MergedVolume& merged) {
  const SentVolume& sent = merged.volume.sent;
  if (sent.generation == 0) return;
  const auto lock = session_.lock();
  if (sent.generation == session_.generation()) session_.forget(sent.description.id);
}

void MergedVolumes::forget(GLuint texture) {
  const MergedVolume* const merged = volume_with(texture);
  if (merged == nullptr) return;
  forget_texels(*merged);
  std::erase_if(merged_, [&](const auto& each) { return each.get() == merged; });
}

void MergedVolumes::forget_deleted() {
  std::vector<GLuint> gone;
  for (const auto& [texture, identity] : identities_) {
    if (!group_.is(texture, identity)) gone.push_back(texture);
  }
  for (const GLuint texture : gone) {
    shown_.erase(texture);
    identities_.erase(texture);
    const MergedVolume* const merged = volume_with(texture);
    if (merged == nullptr) continue;
    leave_behind(*merged->volume.counters);
    // The remaining bricks are counted individually again.
    for (const GLuint other : merged->textures) {
      if (KnownVolume* const brick = volumes_.find(other)) brick->counters = nullptr;
    }
    forget(texture);
  }
}

void MergedVolumes::forget_all() {
  for (const auto& merged : merged_) forget_texels(*merged);
  merged_.clear();
  groups_.clear();
  shown_.clear();
  identities_.clear();
  next_search_ = 0;
  pause_ = 1;
}

}  // namespace understudy::spu
