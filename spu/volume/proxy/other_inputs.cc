// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/other_inputs.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <span>

#include "spu/volume/context/context.h"
#include "spu/volume/pipeline/block_members.h"
#include "spu/volume/program/element_names.h"

namespace understudy::spu {
namespace {

/// What a varying number does to samples.
enum class Role : std::uint8_t {
  none,
  colours,  ///< it is part of a colour, as the direction of a light
  decides,  ///< it decides, by a branch or by the end of a loop, which samples there are, or between colours
  places,   ///< it is part of where samples lie
};

using InfluenceList = std::vector<program::Influence>;

/// Of one component of an input of the fragment stage.
class RoleOf {
 public:
  RoleOf(const ProgramFindings& says, const StageInput& input, int component)
      : facts_(says.facts), input_(input), component_(component) {}

  bool is_meant(const program::Influence& influence) const {
    const program::Source& source = facts_.sources[influence.source];
    return source.kind == program::SourceKind::varying && source.component == component_ &&
           is_named(input_, source.name);
  }

  Role in(const program::RayFinding& ray) const {
    const auto meant = [this](const program::Influence& influence) { return is_meant(influence); };
    const auto places = [&](const program::Influence& influence) {
      return influence.flow == program::Flow::data && is_meant(influence);
    };
    if (std::ranges::any_of(ray.coordinates, places)) return Role::places;
    for (const InfluenceList* list : {&ray.branches, &ray.discards, &ray.loop_ends, &ray.coordinates}) {
      if (std::ranges::any_of(*list, meant)) return Role::decides;
    }
    return std::ranges::any_of(ray.data, meant) ? Role::colours : Role::none;
  }

 private:
  const program::StageFacts& facts_;
  const StageInput& input_;
  int component_;
};

/// What one image depends on, so far as it is seen here.
class OtherInputs {
 public:
  OtherInputs(const MarchContext& measured, const ProgramFindings& says, MarchInputs& inputs)
      : measured_(measured), says_(says), inputs_(inputs) {
    for (const StageInput& input : measured.stages.inputs) {
      std::array<Role, 4>& roles = roles_.emplace_back();
      for (int c = 0; c < std::min(input.components, 4); ++c)
        roles[std::size_t(c)] = RoleOf(says, input, c).in(*says.ray);
    }
  }

  void append() {
    for (const VertexUniform& vertex : measured_.stages.vertex_uniforms) {
      begin_vector(decide(vertex.reaches));
      append_value(measured_, vertex.uniform, inputs_.varying);
    }
    for (const ProgramBlockMember& member : measured_.stages.block_members) append(member);
    inputs_.unreadable |= says_more_than_is_listed();
    if (measured_.seen == nullptr) return;
    for (std::size_t i = 0; i < roles_.size() && i < measured_.seen->offsets.size(); ++i) append_captured(i);
  }

 private:
  void begin_vector(bool chooses) {
    inputs_.varying_begins.push_back(inputs_.varying.size());
    inputs_.varying_chooses.push_back(chooses);
  }

  bool decide(std::span<const InputComponent> reached) const {
    return std::ranges::any_of(reached, [&](const InputComponent& one) {
      const std::vector<StageInput>& inputs = measured_.stages.inputs;
      const auto input = std::ranges::find(inputs, one.input, &StageInput::name);
      return input != inputs.end() && one.component < 4 &&
             roles_[std::size_t(input - inputs.begin())][std::size_t(one.component)] == Role::decides;
    });
  }

  bool is_read_by_fragments(const std::string& member) const {
    return std::ranges::any_of(says_.ray->uniforms, [&](const program::UniformUse& use) {
      const program::Source& source = says_.facts.sources[use.source];
      return source.kind == program::SourceKind::uniform_block &&
             program::may_be_same_element(source.name, member);
    });
  }

  void append(const ProgramBlockMember& described) {
    const BlockMember& member = described.member;
    if (described.reaches.empty() && !is_read_by_fragments(member.name)) return;
    begin_vector(chooses_colours(says_, member.name) || decide(described.reaches));
    const auto& contents = contents_of(member.block);
    inputs_.unreadable |= !contents;
    const std::span<const std::byte> block = contents ? std::span(*contents) : std::span<const std::byte>();
    const std::size_t offset = std::min(member.offset, block.size());
    append_digest(block.subspan(offset, std::min(member.bytes, block.size() - offset)), inputs_.varying);
  }

  const std::optional<std::vector<std::byte>>& contents_of(GLuint block) {
    const auto [known, is_new] = contents_of_block_.try_emplace(block);
    if (is_new) known->second = block_contents(*measured_.context.gl, measured_.run.pipeline().program, block);
    return known->second;
  }

  /// Of an array of blocks, OpenGL lists "Clip.plane" alone, and the text names "Clip[1].plane".
  bool says_more_than_is_listed() const {
    return std::ranges::any_of(says_.ray->uniforms, [&](const program::UniformUse& use) {
      const program::Source& source = says_.facts.sources[use.source];
      const auto is_listed = [&](const ProgramBlockMember& listed) {
        return program::may_be_same_element(source.name, listed.member.name);
      };
      return source.kind == program::SourceKind::uniform_block &&
             std::ranges::none_of(measured_.stages.block_members, is_listed);
    });
  }

  /// Bounds over the draw, and what tells the values at its vertices, however many there are.
  void append_captured(std::size_t input) {
    const StageInput& described = measured_.stages.inputs[input];
    const std::array<Role, 4>& roles = roles_[input];
    const auto is_looked_at = [&](std::size_t c) {
      return roles[c] == Role::decides || roles[c] == Role::colours;
    };
    const bool any = is_looked_at(0) || is_looked_at(1) || is_looked_at(2) || is_looked_at(3);
    if (!described.written || !any) return;
    begin_vector(std::ranges::find(roles, Role::decides) != roles.end());
    const Capture& capture = *measured_.seen;
    std::vector<float> values;
    for (std::size_t c = 0; c < roles.size(); ++c) {
      if (!is_looked_at(c)) continue;
      inputs_.varying.insert(inputs_.varying.end(),
                             {capture.range.low[input][c], capture.range.high[input][c]});
      const std::size_t vertices =
          capture.stride == 0 || described.integer ? 0 : capture.data.size() / capture.stride;
      for (std::size_t v = 0; v < vertices; ++v) values.push_back(capture.value(v, input, c));
    }
    append_digest(std::as_bytes(std::span(values)), inputs_.varying);
  }

  const MarchContext& measured_;
  const ProgramFindings& says_;
  MarchInputs& inputs_;
  std::vector<std::array<Role, 4>> roles_;  ///< of the fragment stage's inputs
  std::map<GLuint, std::optional<std::vector<std::byte>>> contents_of_block_;
};

}  // namespace

void append_other_inputs(const MarchContext& measured, const ProgramFindings& says, MarchInputs& inputs) {
  OtherInputs(measured, says, inputs).append();
}

}  // namespace understudy::spu
