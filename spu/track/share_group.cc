#include "spu/track/share_group.h"

#include <algorithm>

namespace understudy::spu {

std::uint64_t ShareGroup::texture_version(GLuint texture) const {
  const std::scoped_lock lock(mutex_);
  const auto found = textures_.find(texture);
  return std::max(found == textures_.end() ? 0 : found->second.version, some_changed_.load());
}

void ShareGroup::texture_changed(GLuint texture) {
  const std::scoped_lock lock(mutex_);
  textures_[texture].version = ++changes_;
}

void ShareGroup::some_texture_changed() {
  // Two threads may store in the wrong order; both changes are then newer than whatever was read before them.
  some_changed_.store(++changes_, std::memory_order_relaxed);
}

void ShareGroup::texture_deleted(GLuint texture) {
  ++deletions_;
  const std::scoped_lock lock(mutex_);
  textures_.erase(texture);
}

void ShareGroup::remember(GLuint texture) {
  const std::scoped_lock lock(mutex_);
  textures_.try_emplace(texture);
}

bool ShareGroup::remembers(GLuint texture) const {
  const std::scoped_lock lock(mutex_);
  return textures_.contains(texture);
}

void ShareGroup::texture_rendered_to(GLuint texture) {
  const std::scoped_lock lock(mutex_);
  textures_[texture].rendered_to = true;
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
  const std::scoped_lock lock(mutex_);
  if (count > 0) lists_.erase(lists_.lower_bound(first), lists_.lower_bound(first + GLuint(count)));
}

std::optional<ListRecord> ShareGroup::list(GLuint list) const {
  const std::scoped_lock lock(mutex_);
  const auto found = lists_.find(list);
  return found == lists_.end() ? std::nullopt : std::optional(found->second);
}

}  // namespace understudy::spu
