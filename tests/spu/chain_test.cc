#include "spu/chain.h"

#include <gtest/gtest.h>

#include "dispatch/call_id.h"
#include "dispatch/pass_through.h"
#include "spu/track/calls.h"
#include "spu/track/share_group.h"

namespace understudy::spu {
namespace {

int driver_clears = 0;
int unit_clears = 0;
const DispatchTable* installed = nullptr;

void APIENTRY driver_clear(GLbitfield) {
  ++driver_clears;
}
void install(const DispatchTable* table) {
  installed = table;
}

/// A driver without a driver: every slot is distinct from null, glClear counts.
DispatchTable mock_driver() {
  struct Nowhere {
    static const DispatchTable& before(CallId) { return *installed; }
  };
  DispatchTable table;
  PassThrough<Nowhere>::fill(table);
  table.Clear = driver_clear;
  return table;
}

class CountsClears final : public Unit {
 public:
  static constexpr char tag = 'c';
  explicit CountsClears(Chain&) {}
  const char* tag_address() const override { return &tag; }
  void fill(Phase phase, DispatchTable& table) override {
    if (phase == Phase::watching) table.Clear = clear;
  }
  static void APIENTRY clear(GLbitfield mask) {
    ++unit_clears;
    Chain* chain = Chain::current();
    chain->below(*chain->find<CountsClears>()).Clear(mask);
  }
};

TEST(Chain, ASlotThatNobodyOverridesIsTheDriversPointer) {
  const DispatchTable driver = mock_driver();
  Chain chain(driver, std::make_shared<ShareGroup>(), install);
  chain.add<CountsClears>();
  for (std::size_t i = 0; i < call_count; ++i) {
    ASSERT_EQ(slot(chain.head(Phase::plain), CallId(i)), slot(driver, CallId(i))) << call_name(CallId(i));
    if (CallId(i) == CallId::Clear) continue;
    ASSERT_EQ(slot(chain.head(Phase::watching), CallId(i)), slot(driver, CallId(i))) << call_name(CallId(i));
  }
}

TEST(Chain, APhaseChangesWhatTheApplicationCalls) {
  const DispatchTable driver = mock_driver();
  Chain chain(driver, std::make_shared<ShareGroup>(), install);
  chain.add<CountsClears>();
  chain.make_current();
  driver_clears = unit_clears = 0;
  installed->Clear(0);
  EXPECT_EQ(driver_clears, 1);
  EXPECT_EQ(unit_clears, 0);
  chain.set_phase(Phase::watching);
  installed->Clear(0);
  EXPECT_EQ(driver_clears, 2);
  EXPECT_EQ(unit_clears, 1);
}

TEST(Chain, WithoutUnitsTheDriverIsTheChain) {
  const DispatchTable driver = mock_driver();
  Chain chain(driver, std::make_shared<ShareGroup>(), install);
  chain.make_current();
  EXPECT_EQ(installed, &driver);
  Chain::release_current();
  EXPECT_EQ(installed, nullptr);
  EXPECT_EQ(Chain::current(), nullptr);
}

TEST(Calls, AreToldApartByName) {
  EXPECT_EQ(kind_of(CallId::Vertex3f), CallKind::vertex);
  EXPECT_EQ(kind_of(CallId::TexCoord3fv), CallKind::vertex);
  EXPECT_EQ(kind_of(CallId::VertexAttrib4f), CallKind::vertex);
  EXPECT_EQ(kind_of(CallId::VertexPointer), CallKind::not_compiled);
  EXPECT_EQ(kind_of(CallId::Begin), CallKind::draw);
  EXPECT_EQ(kind_of(CallId::DrawArrays), CallKind::draw);
  EXPECT_EQ(kind_of(CallId::TexSubImage3D), CallKind::bound_texture);
  EXPECT_EQ(texture_dimensions(CallId::TexSubImage3D), 3);
  EXPECT_EQ(texture_dimensions(CallId::TexImage1D), 1);
  EXPECT_EQ(kind_of(CallId::TextureSubImage3D), CallKind::unknown_texture);
  EXPECT_EQ(kind_of(CallId::LoadMatrixf), CallKind::other);
  EXPECT_EQ(kind_of(CallId::BlendFunc), CallKind::other);
  EXPECT_EQ(kind_of(CallId::ColorMask), CallKind::other);
  EXPECT_EQ(kind_of(CallId::ColorPointer), CallKind::not_compiled);
  EXPECT_EQ(kind_of(CallId::Color4ubv), CallKind::vertex);
}

TEST(ShareGroup, AVersionNeverComesBack) {
  ShareGroup group;
  group.texture_changed(7);
  const auto first = group.texture_version(7);
  group.texture_changed(7);
  const auto second = group.texture_version(7);
  EXPECT_GT(second, first);
  group.all_textures_changed();
  EXPECT_GT(group.texture_version(7), second);
  const auto last = group.texture_version(7);
  group.texture_deleted(7);
  group.texture_changed(7);
  EXPECT_GT(group.texture_version(7), last);
}

TEST(ShareGroup, DeletedTexturesAreNoVolumes) {
  ShareGroup group;
  EXPECT_FALSE(group.has_volumes());
  group.volume_defined(3);
  EXPECT_TRUE(group.has_volumes());
  EXPECT_TRUE(group.is_volume(3));
  group.texture_deleted(3);
  EXPECT_FALSE(group.is_volume(3));
}

}  // namespace
}  // namespace understudy::spu
