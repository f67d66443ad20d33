// SPDX-License-Identifier: Apache-2.0
// A unit that draws only the edges of polygons.
#include <spu/plugin/unit_plugin.h>

namespace {

using understudy::spu::DispatchTable;
using understudy::spu::OptionType;
using understudy::spu::PluginUnit;
using understudy::spu::UnitOption;
using understudy::spu::UnitPluginOption;

class Wireframe final : public PluginUnit {
 public:
  explicit Wireframe(double width) : width_(GLfloat(width)) {}

  void fill(DispatchTable& table) override {
    table.Clear = clear;
    table.PolygonMode = polygon_mode;
  }

 private:
  static void APIENTRY clear(GLbitfield mask);
  static void APIENTRY polygon_mode(GLenum /*face*/, GLenum /*mode*/) {}

  const GLfloat width_;
};

constexpr UnitOption options[] = {{.name = "width",
                                   .type = OptionType::number,
                                   .fallback = "1",
                                   .low = 0.5,
                                   .high = 10,
                                   .help = "of the lines, in pixels"}};

}  // namespace

UNDERSTUDY_EXPORT_UNIT{.name = "wireframe",
                       .help = "draws the edges of polygons alone",
                       .options = options,
                       .make = [](std::span<const UnitPluginOption> values) -> PluginUnit* {
                         return new Wireframe(values[0].number);
                       }};

namespace {

void APIENTRY Wireframe::clear(GLbitfield mask) {
  const auto& unit = understudy::spu::current_unit<Wireframe>(understudy_unit);
  const DispatchTable& next = unit.next();
  next.Clear(mask);
  next.LineWidth(unit.width_);
  next.PolygonMode(GL_FRONT_AND_BACK, GL_LINE);
}

}  // namespace
