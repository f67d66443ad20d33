#include "spu/track/share_group.h"

namespace understudy::spu {

std::uint64_t ShareGroup::texture_version(GLuint texture) const {
  const std::scoped_lock lock(mutex_);
  const auto found = textures_.find(texture);
  // Both counters only grow; their sum therefore changes whenever either does.
  return (found == textures_.end() ? 0 : found->second.version) + epoch_.load(std::memory_order_relaxed);
}

void ShareGroup::texture_changed(GLuint texture) {
  const std::scoped_lock lock(mutex_);
  textures_[texture].version = ++changes_;
}

void ShareGroup::texture_deleted(GLuint texture) {
  const std::scoped_lock lock(mutex_);
  textures_.erase(texture);
}

void ShareGroup::volume_defined(GLuint texture) {
  const std::scoped_lock lock(mutex_);
  textures_[texture].volume = true;
  has_volumes_.store(true, std::memory_order_relaxed);
}

bool ShareGroup::is_volume(GLuint texture) const {
  const std::scoped_lock lock(mutex_);
  const auto found = textures_.find(texture);
  return found != textures_.end() && found->second.volume;
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

void ShareGroup::program_linked(GLuint program, ProgramRecord record) {
  const std::scoped_lock lock(mutex_);
  record.link = ++links_;
  programs_[program] = std::make_unique<ProgramRecord>(std::move(record));
}

void ShareGroup::program_deleted(GLuint program) {
  const std::scoped_lock lock(mutex_);
  programs_.erase(program);
}

const ProgramRecord* ShareGroup::program(GLuint program) const {
  const std::scoped_lock lock(mutex_);
  const auto found = programs_.find(program);
  return found == programs_.end() ? nullptr : found->second.get();
}

void ShareGroup::list_defined(GLuint list, const ListRecord& record) {
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
