// SPDX-License-Identifier: Apache-2.0
#include "spu/track/share_group.h"

#include <algorithm>
#include <limits>

namespace understudy::spu {
namespace {

/// Limit for separate boxes per texture.
constexpr std::size_t most_changes = 16;

}  // namespace

std::uint64_t ShareGroup::texture_version(GLuint texture) const {
  const std::scoped_lock lock(mutex_);
  const auto found = textures_.find(texture);
  return std::max(found == textures_.end() ? 0 : found->second.version, some_changed_.load());
}

void ShareGroup::texture_changed(GLuint texture) {
  const std::scoped_lock lock(mutex_);
  TextureRecord& record = known(texture);
  record.version = record.changed_wholly = ++changes_;
  record.changes.clear();
}

void ShareGroup::texture_changed(GLuint texture, const volume::TexelBox& box) {
  const std::scoped_lock lock(mutex_);
  TextureRecord& record = known(texture);
  record.version = ++changes_;
  auto& changes = record.changes;
  if (!changes.empty()) {
    // Parts that are uploaded one after another form one box.
    const volume::TexelBox both = volume::enclosing(changes.back().box, box);
    if (volume::texels_in(both) <= volume::texels_in(changes.back().box) + volume::texels_in(box)) {
      changes.back() = {record.version, both};
      return;
    }
  }
  changes.push_back({record.version, box});
  if (changes.size() <= most_changes) return;
  // The two oldest are merged: a caller that checks every frame has already seen the oldest.
  changes[1].box = volume::enclosing(changes[0].box, changes[1].box);
  changes.erase(changes.begin());
}

std::optional<std::vector<volume::TexelBox>> ShareGroup::changes_since(GLuint texture,
                                                                       std::uint64_t version) const {
  const std::scoped_lock lock(mutex_);
  const auto found = textures_.find(texture);
  if (found == textures_.end() || found->second.changed_wholly > version || some_changed_.load() > version)
    return std::nullopt;
  std::vector<volume::TexelBox> boxes;
  for (const auto& change : found->second.changes) {
    if (change.version > version) boxes.push_back(change.box);
  }
  return boxes;
}

void ShareGroup::some_texture_changed() {
  if (!has_volumes()) return;
  // Two threads may store their versions in the wrong order; both are newer than any version read before.
  some_changed_.store(++changes_, std::memory_order_relaxed);
}

void ShareGroup::texture_deleted(GLuint texture) {
  // Records of the texture were made earlier, because the application itself orders its uses of the name.
  if (texture == 0 || !textures_are_known_.load(std::memory_order_relaxed)) return;
  const std::scoped_lock lock(mutex_);
  if (textures_.erase(texture) == 0) return;
  deletions_.fetch_add(1, std::memory_order_relaxed);
  textures_are_known_.store(!textures_.empty(), std::memory_order_relaxed);
}

ShareGroup::TextureRecord& ShareGroup::known(GLuint texture) {
  textures_are_known_.store(true, std::memory_order_relaxed);
  return textures_[texture];
}

std::uint64_t ShareGroup::identity(GLuint texture) {
  const std::scoped_lock lock(mutex_);
  TextureRecord& record = known(texture);
  if (record.identity == 0) record.identity = ++changes_;
  return record.identity;
}

bool ShareGroup::is(GLuint texture, std::uint64_t identity) const {
  const std::scoped_lock lock(mutex_);
  const auto found = textures_.find(texture);
  return found != textures_.end() && found->second.identity == identity;
}

void ShareGroup::texture_rendered_to(GLuint texture) {
  const std::scoped_lock lock(mutex_);
  known(texture).rendered_to = true;
}

bool ShareGroup::is_rendered_to(GLuint texture) const {
  const std::scoped_lock lock(mutex_);
  const auto found = textures_.find(texture);
  return found != textures_.end() && found->second.rendered_to;
}

void ShareGroup::list_defined(GLuint list, const ListRecord& record) {
  if (record.changes_textures) lists_change_textures_.store(true, std::memory_order_relaxed);
  const std::scoped_lock lock(mutex_);
  lists_[list] = record;
}

void ShareGroup::lists_deleted(GLuint first, GLsizei count) {
  if (count <= 0) return;
  const std::uint64_t end = std::uint64_t(first) + std::uint64_t(count);  // may be beyond the last name
  const std::scoped_lock lock(mutex_);
  lists_.erase(lists_.lower_bound(first),
               end > std::numeric_limits<GLuint>::max() ? lists_.end() : lists_.lower_bound(GLuint(end)));
}

std::optional<ListRecord> ShareGroup::list(GLuint list) const {
  const std::scoped_lock lock(mutex_);
  const auto found = lists_.find(list);
  return found == lists_.end() ? std::nullopt : std::optional(found->second);
}

}  // namespace understudy::spu
