// SPDX-License-Identifier: Apache-2.0
#include "spu/track/program_sources.h"

#include <algorithm>
#include <functional>
#include <string_view>
#include <utility>

namespace understudy::spu {
namespace {

void add_shader_source(ProgramRecord& record, GLenum type, const std::string* source) {
  const std::string text = source != nullptr ? *source : std::string();
  if (type == GL_VERTEX_SHADER) {
    record.vertex_shader = true;
    record.vertex_sources.push_back(text);
  } else if (type == GL_FRAGMENT_SHADER) {
    record.fragment_source_known =
        !text.empty() && (record.fragment_sources.empty() || record.fragment_source_known);
    record.fragment_sources.push_back(text);
  } else {
    record.other_shader_stages = true;
  }
}

std::size_t hash_of(std::span<const std::byte> binary) {
  return std::hash<std::string_view>()({reinterpret_cast<const char*>(binary.data()), binary.size()});
}

}  // namespace

void ProgramSources::shader_created(GLuint shader, GLenum type) {
  if (shader == 0) return;
  const std::scoped_lock lock(mutex_);
  shaders_[shader] = {.type = type, .given = nullptr, .compiled = nullptr};
}

void ProgramSources::source_given(GLuint shader, std::string source) {
  const std::scoped_lock lock(mutex_);
  const auto found = shaders_.find(shader);
  if (found != shaders_.end()) found->second.given = std::make_shared<const std::string>(std::move(source));
}

void ProgramSources::shader_compiled(GLuint shader) {
  const std::scoped_lock lock(mutex_);
  const auto found = shaders_.find(shader);
  if (found != shaders_.end()) found->second.compiled = found->second.given;
}

void ProgramSources::binary_given(GLuint shader) {
  const std::scoped_lock lock(mutex_);
  const auto found = shaders_.find(shader);
  if (found != shaders_.end()) found->second.compiled = nullptr;
}

void ProgramSources::shader_deleted(GLuint shader) {
  const std::scoped_lock lock(mutex_);
  const auto found = shaders_.find(shader);
  if (found == shaders_.end()) return;
  found->second.deleted = true;
  if (found->second.attached_to == 0) shaders_.erase(found);
}

void ProgramSources::program_created(GLuint program) {
  if (program == 0) return;
  const std::scoped_lock lock(mutex_);
  programs_[program] = {};
}

void ProgramSources::shader_attached(GLuint program, GLuint shader) {
  const std::scoped_lock lock(mutex_);
  const auto found = programs_.find(program);
  const auto part = shaders_.find(shader);
  if (found == programs_.end() || part == shaders_.end()) return;
  std::vector<GLuint>& shaders = found->second.shaders;
  if (std::find(shaders.begin(), shaders.end(), shader) != shaders.end()) return;
  shaders.push_back(shader);
  ++part->second.attached_to;
}

void ProgramSources::shader_detached(GLuint program, GLuint shader) {
  const std::scoped_lock lock(mutex_);
  const auto found = programs_.find(program);
  if (found != programs_.end() && std::erase(found->second.shaders, shader) > 0) detached(shader);
}

void ProgramSources::detached(GLuint shader) {
  const auto found = shaders_.find(shader);
  if (found != shaders_.end() && --found->second.attached_to == 0 && found->second.deleted)
    shaders_.erase(found);
}

void ProgramSources::program_linked(GLuint program) {
  const std::scoped_lock lock(mutex_);
  const auto found = programs_.find(program);
  if (found == programs_.end()) return;
  auto record = std::make_shared<ProgramRecord>();
  record->link = ++links_;
  for (const GLuint shader : found->second.shaders) {
    const Shader& part = shaders_.at(shader);
    add_shader_source(*record, part.type, part.compiled.get());
  }
  found->second.linked = std::move(record);
}

void ProgramSources::program_linked_from(GLuint program, GLenum type, const std::string& source) {
  if (program == 0) return;
  const std::scoped_lock lock(mutex_);
  auto record = std::make_shared<ProgramRecord>();
  record->link = ++links_;
  add_shader_source(*record, type, &source);
  programs_[program] = {.shaders = {}, .linked = std::move(record)};
}

void ProgramSources::program_loaded(GLuint program, std::span<const std::byte> binary) {
  const std::scoped_lock lock(mutex_);
  const auto found = programs_.find(program);
  if (found == programs_.end()) return;
  const auto taken = binaries_.find(hash_of(binary));
  auto record = std::make_shared<ProgramRecord>(taken == binaries_.end() ? ProgramRecord{} : *taken->second);
  record->link = ++links_;
  found->second.linked = std::move(record);
}

void ProgramSources::binary_taken(GLuint program, std::span<const std::byte> binary) {
  const std::scoped_lock lock(mutex_);
  const auto found = programs_.find(program);
  if (found != programs_.end() && found->second.linked) binaries_[hash_of(binary)] = found->second.linked;
}

bool ProgramSources::knows_binary(std::span<const std::byte> binary) const {
  const std::scoped_lock lock(mutex_);
  return binaries_.contains(hash_of(binary));
}

void ProgramSources::program_deleted(GLuint program) {
  const std::scoped_lock lock(mutex_);
  const auto found = programs_.find(program);
  if (found == programs_.end()) return;
  for (const GLuint shader : found->second.shaders) detached(shader);
  programs_.erase(found);
}

std::shared_ptr<const ProgramRecord> ProgramSources::program(GLuint program) const {
  const std::scoped_lock lock(mutex_);
  const auto found = programs_.find(program);
  return found == programs_.end() ? nullptr : found->second.linked;
}

std::string joined(GLsizei count, const GLchar* const* strings, const GLint* lengths) {
  std::string text;
  for (GLsizei i = 0; i < count; ++i) {
    if (strings == nullptr || strings[i] == nullptr) return {};
    if (lengths != nullptr && lengths[i] >= 0) {
      text.append(strings[i], std::size_t(lengths[i]));
    } else {
      text.append(strings[i]);
    }
  }
  return text;
}

}  // namespace understudy::spu
