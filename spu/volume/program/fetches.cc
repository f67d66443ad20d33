// SPDX-License-Identifier: Apache-2.0
// Texture fetches of shaders, and their operations on images, buffers and counters.
#include <algorithm>
#include <utility>

#include "spu/volume/program/walk.h"

namespace understudy::spu::program {

using namespace glslang;

namespace {

/// Components of a coordinate, without the layer.
std::size_t dimensions_of(const TSampler& sampler) {
  switch (sampler.dim) {
    case Esd1D:
    case EsdBuffer:
      return 1;
    case Esd3D:
    case EsdCube:
      return 3;
    default:
      return 2;
  }
}

TextureShape shape_of(TSamplerDim dimension) {
  switch (dimension) {
    case Esd1D:
      return TextureShape::line;
    case Esd2D:
      return TextureShape::plane;
    case Esd3D:
      return TextureShape::space;
    case EsdCube:
      return TextureShape::cube;
    case EsdRect:
      return TextureShape::rectangle;
    case EsdBuffer:
      return TextureShape::buffer;
    default:
      return TextureShape::other;
  }
}

SamplerType type_of(const TSampler& sampler) {
  const TexelType texels = sampler.type == EbtInt    ? TexelType::integer
                           : sampler.type == EbtUint ? TexelType::natural
                                                     : TexelType::real;
  return {.shape = shape_of(sampler.dim),
          .texels = texels,
          .array = sampler.arrayed,
          .shadow = sampler.shadow,
          .multisample = sampler.ms};
}

}  // namespace

std::string Walk::name_of(const Scalar& opaque) {
  if (values_.numbers.is_leaf(opaque.number)) return variables_.source_of(opaque.number).name;
  for (const Dependence& dependence : values_.sets.members(opaque.on)) {
    if (dependence.source >= variables_.cells()) continue;
    const Source source = variables_.source_of(dependence.source);
    if (source.name.ends_with(']')) return source.name.substr(0, source.name.rfind('[')) + "[*]";
  }
  return {};
}

/// A sampler that is named where it is used is no source; what selects one of several is.
Scalar Walk::without_name(Scalar sampler) const {
  if (values_.numbers.is_leaf(sampler.number)) sampler.on = FlowSets::empty;
  return sampler;
}

Walk::FoundFetch& Walk::found_fetch(const TIntermAggregate& node, const Scalar& sampler) {
  const auto [known, is_new] = fetch_by_path_.emplace(point(node, 0), fetches_.size());
  if (!is_new) return fetches_[known->second];
  FoundFetch found;
  found.fetch.sampler = name_of(sampler);
  found.fetch.type = type_of(node.getSequence()[0]->getAsTyped()->getType().getSampler());
  found.fetch.loop = loop_;
  found.fetch.line = node.getLoc().line;
  found.first_source = variables_.cells() + std::uint32_t(own_sources_.size());
  for (int component = 0; component < 4; ++component)
    add_source({.kind = SourceKind::texel,
                .name = found.fetch.sampler,
                .component = component,
                .components = 4,
                .rows = 4,
                .number = known->second});
  fetches_.push_back(std::move(found));
  return fetches_.back();
}

Value Walk::fetch(const TIntermAggregate& node) {
  const std::vector<Value> arguments = evaluate_all(node.getSequence());
  FoundFetch& found = found_fetch(node, arguments.at(0).at(0));
  describe_fetch(found, node, arguments);
  std::vector<Number> key{std::uint32_t(node.getOp())};
  for (const Value& argument : arguments) {
    for (const Scalar& scalar : argument) key.push_back(scalar.number);
  }
  found.place = values_.numbers.of(ValueNumbers::place, key);
  Value texel;
  for (std::uint32_t i = 0; i < cells_of(node.getType()); ++i)
    texel.push_back({values_.sets.single(found.first_source + std::min(i, 3U)),
                     values_.numbers.of(ValueNumbers::component, {found.place, i})});
  return texel;
}

void Walk::describe_fetch(FoundFetch& found, const TIntermAggregate& node,
                          const std::vector<Value>& arguments) {
  const TSampler& sampler = node.getSequence()[0]->getAsTyped()->getType().getSampler();
  TCrackedTextureOp how{};
  node.crackTexture(sampler, how);
  Fetch& fetch = found.fetch;
  fetch.function = how.fetch    ? FetchFunction::exact
                   : how.gather ? FetchFunction::gathered
                                : FetchFunction::filtered;
  fetch.projected = how.proj;
  fetch.offset = how.offset || how.offsets;
  fetch.level = how.lod;
  fetch.gradient = how.grad;
  const Value& coordinate = arguments.at(1);
  const std::size_t components =
      std::min(dimensions_of(sampler) + (sampler.arrayed ? 1 : 0), coordinate.size());
  const Set divided_by = how.proj ? coordinate.back().on : FlowSets::empty;
  found.coordinate.resize(components);
  found.exact.assign(components, 0);
  for (std::size_t i = 0; i < components; ++i) {
    const Set on = values_.sets.join(coordinate[i].on, divided_by);
    found.coordinate[i] = values_.sets.join(found.coordinate[i], on);
    found.exact[i] = how.proj ? ~0U : coordinate[i].number;
  }
  Set others = without_name(arguments[0][0]).on;
  for (std::size_t i = components; i < coordinate.size(); ++i)
    others = values_.sets.join(others, coordinate[i].on);
  for (std::size_t i = 2; i < arguments.size(); ++i)
    others = values_.sets.join(others, values_.union_of(arguments[i]));
  const std::size_t expected = 2 + (how.lod || how.fetch ? 1 : 0) + (how.grad ? 2 : 0) +
                               (fetch.offset ? 1 : 0) + (how.gather && sampler.shadow ? 1 : 0);
  fetch.bias = !how.gather && !how.fetch && !how.lod && !how.grad && arguments.size() > expected;
  found.modifiers = values_.sets.join(found.modifiers, others);
  found.execution = values_.sets.join(found.execution, conditions());
}

Value Walk::query_texture(const TIntermOperator& node, const std::vector<Value>& arguments) {
  Set on = own_source(SourceKind::texture_size, name_of(arguments.at(0).at(0)));
  if (node.getOp() == EOpTextureQueryLod)
    on = values_.sets.join(on, own_source(SourceKind::derivative, "derivative"));
  std::vector<Value> operands = arguments;
  operands[0] = {without_name(arguments[0][0])};
  return values_.with(values_.mixed(node.getOp(), cells_of(node.getType()), operands), on);
}

Value Walk::use_image(const TIntermAggregate& node) {
  const std::vector<Value> arguments = evaluate_all(node.getSequence());
  const std::string name = name_of(arguments.at(0).at(0));
  const TOperator op = node.getOp();
  if (op == EOpImageQuerySize || op == EOpImageQuerySamples) return query_texture(node, arguments);
  if (op == EOpImageStore || op == EOpImageStoreLod) {
    add_side_effect(SideEffectKind::image_store, name, node.getLoc().line);
    return {};
  }
  Set on = own_source(SourceKind::image, name);
  if (op != EOpImageLoad && op != EOpImageLoadLod)
    add_side_effect(SideEffectKind::image_atomic, name, node.getLoc().line);
  for (const Value& argument : arguments) on = values_.sets.join(on, values_.union_of(argument));
  // A store between two loads changes what they return.
  return values_.with(unknown_value(node.getType(), {}), on);
}

Value Walk::change_atomically(const TIntermOperator& node, const std::vector<Value>& arguments,
                              SideEffectKind kind, std::string name) {
  Set on = own_source(SourceKind::atomic_counter, name);
  for (const Value& argument : arguments) on = values_.sets.join(on, values_.union_of(argument));
  add_side_effect(kind, std::move(name), node.getLoc().line);
  return values_.with(unknown_value(node.getType(), {}), on);
}

Value Walk::change_buffer_atomically(const TIntermAggregate& node, const std::vector<Value>& arguments) {
  const auto place = place_of(node.getSequence().at(0)->getAsTyped());
  std::string name;
  if (place && !place->parts.empty()) name = named(*place->variable, place->starts[0] + place->parts[0]).name;
  Value before = change_atomically(node, arguments, SideEffectKind::buffer_atomic, std::move(name));
  if (place) write(*place, before, node.getLoc().line);
  return before;
}

void Walk::add_side_effect(SideEffectKind kind, std::string name, int line) {
  const auto same = [&](const SideEffect& known) {
    return known.kind == kind && known.name == name && known.line == line;
  };
  if (std::ranges::none_of(side_effects_, same)) side_effects_.push_back({kind, std::move(name), line});
}

}  // namespace understudy::spu::program
