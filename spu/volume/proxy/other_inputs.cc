// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/other_inputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>

#include "spu/volume/context/context.h"
#include "spu/volume/pipeline/block_members.h"
#include "spu/volume/program/element_names.h"

namespace understudy::spu {
namespace {

/// What a varying scalar does to samples.
enum class Role : std::uint8_t {
  none,
  colours,  ///< it is part of a colour, such as the direction of a light
  decides,  ///< by a branch or the end of a loop, it decides which samples there are, or between colours
  places,   ///< it is part of where samples lie
};

using InfluenceList = std::vector<program::Influence>;

/// Returns the role of the varying scalars that `is_meant` selects.
Role role_of(const program::RayFinding& ray, const std::function<bool(const program::Influence&)>& is_meant) {
  const auto places = [&](const program::Influence& influence) {
    return influence.flow == program::Flow::data && is_meant(influence);
  };
  if (std::ranges::any_of(ray.coordinates, places)) return Role::places;
  for (const InfluenceList* list : {&ray.branches, &ray.discards, &ray.loop_ends, &ray.coordinates}) {
    if (std::ranges::any_of(*list, is_meant)) return Role::decides;
  }
  return std::ranges::any_of(ray.data, is_meant) ? Role::colours : Role::none;
}

/// Rounds away the last three of 23 bits: what a vertex stage computes anew in every image may differ in them
/// each time, though it is constant.
float without_rounding(float value) {
  constexpr std::uint32_t half = 4;
  return std::bit_cast<float>((std::bit_cast<std::uint32_t>(value) + half) & ~(2 * half - 1));
}

/// Collects the inputs of one image.
class OtherInputs {
 public:
  OtherInputs(const MarchContext& measured, const CoordinateSpace& space, const ProgramFindings& says,
              MarchInputs& inputs)
      : measured_(measured), space_(space), says_(says), inputs_(inputs) {
    for (const StageInput& input : measured.stages.inputs) {
      std::array<Role, 4>& roles = roles_.emplace_back();
      for (int c = 0; c < std::min(input.components, 4); ++c)
        roles[std::size_t(c)] = role_of_component(input, c);
    }
    for (const program::UniformUse& use : says.ray->uniforms) {
      const program::Source& source = says.facts.sources[use.source];
      if (source.kind == program::SourceKind::uniform_block) members_read_.insert(source.name);
    }
  }

  void append() {
    for (const VertexUniform& vertex : measured_.stages.vertex_uniforms) {
      inputs_.begin_vector("vertex stage: " + vertex.uniform.name, decide(vertex.reaches));
      append_value(measured_, vertex.uniform, inputs_.varying);
    }
    for (const ProgramBlockMember& member : measured_.stages.block_members) append(member);
    inputs_.unreadable |= names_more_than_is_listed();
    if (measured_.seen == nullptr) return;
    for (std::size_t i = 0; i < roles_.size() && i < measured_.seen->offsets.size(); ++i) append_captured(i);
    for (std::size_t i = 0; i < measured_.seen->unprobed_offsets.size(); ++i) append_unprobed(i);
  }

 private:
  Role role_of_component(const StageInput& input, int component) const {
    return role_of(*says_.ray, [&](const program::Influence& influence) {
      const program::Source& source = says_.facts.sources[influence.source];
      return source.kind == program::SourceKind::varying && source.component == component &&
             is_named(input, source.name);
    });
  }

  /// For an input that is not probed.
  Role role_of_element(const std::string& name, int component) const {
    return role_of(*says_.ray, [&](const program::Influence& influence) {
      const program::Source& source = says_.facts.sources[influence.source];
      return source.kind == program::SourceKind::varying && source.component == component &&
             program::may_be_same_element(source.name, name);
    });
  }

  bool decide(std::span<const InputComponent> reached) const {
    return std::ranges::any_of(reached, [&](const InputComponent& one) {
      const std::vector<StageInput>& inputs = measured_.stages.inputs;
      const auto input = std::ranges::find(inputs, one.input, &StageInput::name);
      if (input == inputs.end()) return role_of_element(one.input, one.component) == Role::decides;
      return one.component < 4 &&
             roles_[std::size_t(input - inputs.begin())][std::size_t(one.component)] == Role::decides;
    });
  }

  bool is_read_by_fragments(const std::string& member) const {
    return std::ranges::any_of(
        members_read_, [&](const std::string& read) { return program::may_be_same_element(read, member); });
  }

  void append(const ProgramBlockMember& described) {
    const BlockMember& member = described.member;
    if (described.reaches.empty() && !is_read_by_fragments(member.name)) return;
    inputs_.begin_vector("buffer: " + member.name,
                         chooses_colours(says_, member.name) || decide(described.reaches));
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

  /// Whether the text names more members than OpenGL lists: of an array of blocks, OpenGL lists "Clip.plane"
  /// alone, and the text names "Clip[1].plane".
  bool names_more_than_is_listed() const {
    return std::ranges::any_of(members_read_, [&](const std::string& read) {
      return std::ranges::none_of(measured_.stages.block_members, [&](const ProgramBlockMember& listed) {
        return program::may_be_same_element(read, listed.member.name);
      });
    });
  }

  /// Whether this is the position in the volume, or the eye if the ray's direction is passed on: these are
  /// measured with the box.
  bool is_place(const StageInput& input, std::size_t component) const {
    return component < 3 && (input.name == space_.input || input.name == space_.origin);
  }

  /// The scalars of one varying, each with its role; they lie `offset` floats behind the beginning of each
  /// vertex.
  struct HandedOn {
    std::string name;
    std::vector<Role> roles;
    std::size_t offset = 0;
  };

  /// Returns these components of all vertices, one vertex after the other.
  std::vector<float> values_of(std::size_t offset, std::span<const std::size_t> components) const {
    const Capture& capture = *measured_.seen;
    std::vector<float> values;
    for (std::size_t at = offset; at < capture.data.size(); at += capture.stride) {
      for (const std::size_t component : components)
        values.push_back(without_rounding(capture.data[at + component]));
    }
    return values;
  }

  /// Scalars of one role form one vector: while an eye turns about an axis, one of its components stays.
  void append_handed_on(const HandedOn& handed) {
    for (const Role role : {Role::colours, Role::decides, Role::places}) {
      std::vector<std::size_t> components;
      for (std::size_t c = 0; c < handed.roles.size(); ++c) {
        if (handed.roles[c] == role) components.push_back(c);
      }
      if (!components.empty()) append_group(handed, role, components);
    }
  }

  void append_group(const HandedOn& handed, Role role, std::span<const std::size_t> components) {
    const std::vector<float> values = values_of(handed.offset, components);
    const bool constant = std::ranges::adjacent_find(values, std::not_equal_to()) == values.end();
    // An eye position would have three components.
    const bool may_be_step = constant && components.size() == 1;
    inputs_.begin_vector(fmt::format("varying: {} {}", handed.name, int(role)), role == Role::decides,
                         may_be_step);
    append_digest(std::as_bytes(std::span(values)), inputs_.varying);
  }

  void append_captured(std::size_t input) {
    const StageInput& described = measured_.stages.inputs[input];
    if (!described.written) return;
    HandedOn handed{described.name, {}, measured_.seen->offsets[input]};
    for (std::size_t c = 0; c < std::size_t(described.components); ++c)
      handed.roles.push_back(is_place(described, c) ? Role::none : roles_[input][c]);
    append_handed_on(handed);
  }

  void append_unprobed(std::size_t input) {
    const UnprobedInput& described = measured_.stages.unprobed[input];
    for (std::size_t element = 0; element < described.elements; ++element) {
      HandedOn handed{described.element(element), {}, 0};
      for (std::size_t c = 0; c < described.components; ++c)
        handed.roles.push_back(role_of_element(handed.name, int(c)));
      if (described.floats() > 0) {
        handed.offset = measured_.seen->unprobed_offsets[input] + element * described.components;
        append_handed_on(handed);
      } else if (described.written) {
        inputs_.unreadable |= std::ranges::any_of(handed.roles, [](Role role) { return role != Role::none; });
      }
    }
  }

  const MarchContext& measured_;
  const CoordinateSpace& space_;
  const ProgramFindings& says_;
  MarchInputs& inputs_;
  std::vector<std::array<Role, 4>> roles_;  ///< of the fragment stage's inputs
  std::set<std::string> members_read_;      ///< of uniform blocks, by the fragment stage
  std::map<GLuint, std::optional<std::vector<std::byte>>> contents_of_block_;
};

}  // namespace

void append_other_inputs(const MarchContext& measured, const CoordinateSpace& space,
                         const ProgramFindings& says, MarchInputs& inputs) {
  OtherInputs(measured, space, says, inputs).append();
}

}  // namespace understudy::spu
