// SPDX-License-Identifier: Apache-2.0
#include "spu/plugin/unit_of_plugin.h"

#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include "spu/chain.h"

namespace understudy::spu {

/// Each plugin is a separate type of unit, identified by its address.
class UnitOfPlugin final : public Unit {
 public:
  UnitOfPlugin(Chain& chain, const UnitPlugin& plugin, std::unique_ptr<PluginUnit> unit)
      : chain_(chain), plugin_(plugin), unit_(std::move(unit)) {
    unit_->host_ = plugin.host;
    unit_->place_ = this;
  }

  static const char* tag_of(const UnitPlugin& plugin) { return reinterpret_cast<const char*>(&plugin); }
  static PluginUnit* current(const UnitPlugin& plugin) {
    return static_cast<const UnitOfPlugin*>(Chain::current()->find(tag_of(plugin)))->unit_.get();
  }
  static const DispatchTable& next(const void* place) {
    const auto& unit = *static_cast<const UnitOfPlugin*>(place);
    return unit.chain_.below(unit);
  }

  const char* tag_address() const override { return tag_of(plugin_); }
  void fill(Phase, DispatchTable& table) override { unit_->fill(table); }
  void settle() override { unit_->settle(); }
  void frame_ended(FrameEnd) override { unit_->frame_ended(); }
  void abandon() override { unit_->abandon(); }
  void give_up() override { unit_->settle(); }

 private:
  Chain& chain_;
  const UnitPlugin& plugin_;
  std::unique_ptr<PluginUnit> unit_;
};

namespace {

constexpr UnitPluginHost host{&UnitOfPlugin::current, &UnitOfPlugin::next};

UnitPluginOption value_of(const UnitOption& option, const OptionValues& values) {
  const auto of_number = [&](double number) { return UnitPluginOption{option.name, number, number, ""}; };
  switch (option.type) {
    case OptionType::on_off:
      return of_number(values.is_on(option.name) ? 1 : 0);
    case OptionType::integer:
      return of_number(double(values.integer(option.name)));
    case OptionType::number:
      return of_number(values.number(option.name));
    case OptionType::range:
      return {option.name, double(values.range(option.name).first), double(values.range(option.name).last), ""};
    case OptionType::text:
    case OptionType::file:
    case OptionType::choice:
      return {option.name, 0, 0, values.text(option.name).c_str()};
  }
  return of_number(0);
}

std::unique_ptr<Unit> make(const UnitPlace& place) {
  const UnitPlugin& plugin = *place.description.plugin;
  std::vector<UnitPluginOption> options;
  options.reserve(plugin.options.size());
  for (const UnitOption& option : plugin.options) options.push_back(value_of(option, place.options));
  std::unique_ptr<PluginUnit> unit(plugin.make(options));
  if (!unit) throw std::runtime_error("it makes no unit");
  return std::make_unique<UnitOfPlugin>(place.chain, plugin, std::move(unit));
}

}  // namespace

UnitDescription description_of(UnitPlugin& plugin) {
  // Other threads may already draw with its units.
  if (plugin.host != &host) plugin.host = &host;
  return {.name = plugin.name, .help = plugin.help, .options = plugin.options, .make = make, .plugin = &plugin};
}

}  // namespace understudy::spu
