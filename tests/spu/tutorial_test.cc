// The unit of docs/new-spu.md, tested as the page says, and the page: its code is the code here, to the letter.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

// The tutorial's code begins here.
#include "spu/unit_description.h"

namespace understudy::spu {
extern const UnitDescription wireframe_description;
}

namespace understudy::spu {

class Wireframe final : public Unit {
 public:
  static constexpr char tag = 'w';

  Wireframe(Chain& chain, double width) : chain_(chain), width_(GLfloat(width)) {}

  const char* tag_address() const override { return &tag; }
  void fill(Phase, DispatchTable& table) override {
    table.Clear = clear;
    table.PolygonMode = polygon_mode;
  }

 private:
  static void APIENTRY clear(GLbitfield mask) {
    const Wireframe& unit = *Chain::current()->find<Wireframe>();
    const DispatchTable& next = unit.chain_.below(unit);
    next.Clear(mask);
    next.LineWidth(unit.width_);
    next.PolygonMode(GL_FRONT_AND_BACK, GL_LINE);
  }
  static void APIENTRY polygon_mode(GLenum, GLenum) {}

  Chain& chain_;
  const GLfloat width_;
};

constexpr UnitOption wireframe_options[] = {{.name = "width",
                                             .type = OptionType::number,
                                             .fallback = "1",
                                             .low = 0.5,
                                             .high = 10,
                                             .help = "of the lines, in pixels"}};

constinit const UnitDescription wireframe_description{
    .name = "wireframe",
    .help = "draws the edges of polygons alone",
    .options = wireframe_options,
    .make = [](const UnitPlace& place) -> std::unique_ptr<Unit> {
      return std::make_unique<Wireframe>(place.chain, place.options.number("width"));
    }};

}  // namespace understudy::spu

#include "spu/assemble.h"
#include "spu/driver/driver.h"
#include "spu/track/share_group.h"
#include "tests/spu/mock_driver.h"

namespace understudy::spu {

TEST(Wireframe, DrawsLinesFromTheFirstClearOn) {
  testing::MockDriver driver;
  Chain chain(driver.table(), std::make_shared<ShareGroup>(), testing::install);
  const UnitDescription* units[] = {&driver_description, &wireframe_description};
  ASSERT_EQ(assemble(chain, "wireframe(width=2) driver", nullptr, units).value_or(""), "");
  chain.make_current();
  const DispatchTable& gl = testing::installed();

  gl.Clear(GL_COLOR_BUFFER_BIT);
  gl.PolygonMode(GL_FRONT_AND_BACK, GL_FILL);

  ASSERT_THAT(driver.called(), ::testing::ElementsAre(CallId::Clear, CallId::LineWidth, CallId::PolygonMode));
  EXPECT_EQ(driver.calls()[2].words[1], std::uint64_t(GL_LINE));
  EXPECT_EQ(gl.Vertex3f, driver.table().Vertex3f) << "what the unit leaves alone costs nothing";
}

}  // namespace understudy::spu
// The tutorial's code ends here.

namespace {

std::string contents(const char* path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// What stands between each line `begin` and the next line `end`, one after the other.
std::string between(const std::string& text, const std::string& begin, const std::string& end) {
  std::string found;
  std::size_t start = 0;
  while ((start = text.find("\n" + begin + "\n", start)) != std::string::npos) {
    start += begin.size() + 2;
    const std::size_t stop = text.find("\n" + end + "\n", start - 1);
    if (stop == std::string::npos) return "not closed: " + begin;
    found += text.substr(start, stop + 1 - start) + "\n";
    start = stop;
  }
  return found;
}

/// Without the empty lines, which separate blocks of the page.
std::string without_empty_lines(std::string text) {
  for (std::size_t place = 0; (place = text.find("\n\n")) != std::string::npos;) text.erase(place, 1);
  return text.substr(text.find_first_not_of('\n'));
}

TEST(Tutorial, ShowsTheCodeThatIsTested) {
  const std::string page = between(contents(TUTORIAL_PAGE), "```cpp", "```");
  const std::string source = between(contents(TUTORIAL_SOURCE), "// The tutorial's code begins here.",
                                     "// The tutorial's code ends here.");
  ASSERT_THAT(page, ::testing::HasSubstr("class Wireframe"));
  EXPECT_EQ(without_empty_lines(page), without_empty_lines(source));
}

}  // namespace
