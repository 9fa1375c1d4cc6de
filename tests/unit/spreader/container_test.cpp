#include "spreader/container.h"

#include <gtest/gtest.h>

#include "spreader/spreader.h"

namespace quayside::spreader {
namespace {

constexpr ContainerSize kAll[] = {ContainerSize::iso20, ContainerSize::iso40, ContainerSize::iso40_high_cube,
                                  ContainerSize::iso45};

TEST(Container, AperturesLieInTheCornerCastings) {
  // Castings are 178 mm long and 162 mm wide: an aperture's centre lies that much inside the outline at most.
  for (const ContainerSize size : kAll) {
    const ContainerData& data = container_data(size);
    const Eigen::Vector2d inset = (data.size.head<2>() - data.apertures) / 2;
    EXPECT_GT(inset.minCoeff(), 0);
    EXPECT_LT(inset.x(), 0.178);
    EXPECT_LT(inset.y(), 0.162);
  }
}

TEST(Container, SizesFollowTheStandard) {
  EXPECT_EQ(container_data(ContainerSize::iso20).size, Eigen::Vector3d(6.058, 2.438, 2.591));
  EXPECT_EQ(container_data(ContainerSize::iso40).size, Eigen::Vector3d(12.192, 2.438, 2.591));
  // A high cube differs from a 40 ft box in height alone, so that one spreader serves both.
  EXPECT_EQ(container_data(ContainerSize::iso40_high_cube).size, Eigen::Vector3d(12.192, 2.438, 2.896));
  EXPECT_EQ(aperture_centres(ContainerSize::iso40), aperture_centres(ContainerSize::iso40_high_cube));
  EXPECT_EQ(container_data(ContainerSize::iso45).size, Eigen::Vector3d(13.716, 2.438, 2.896));
}

TEST(Spreader, PinsMeetTheApertures) {
  const Eigen::Vector3d p_BT(0, 0, 1.2955);
  const Lock lock = twistlock_lock({}, ContainerSize::iso40, 30480, p_BT);
  ASSERT_EQ(lock.pins.size(), 4u);
  for (const auto& pin : lock.pins) {
    EXPECT_EQ(pin.p_A + p_BT, pin.p_B);
    EXPECT_EQ(std::abs(pin.p_A.x()), 11.985 / 2);
    EXPECT_EQ(std::abs(pin.p_A.y()), 2.259 / 2);
  }
  // 299 kN on 4e8 N/m.
  EXPECT_NEAR(hanging_stretch(lock, 30480 * 9.81), 0.7475e-3, 1e-7);
  // The load on all four: ζ = C/(2 √(K m)).
  EXPECT_NEAR(4 * lock.damping / (2 * std::sqrt(4 * lock.stiffness * 30480)), 0.05, 1e-12);
}

TEST(Spreader, HasTheMassOfItsParts) {
  Spreader spreader;
  spreader.mass = 10e3;
  const MassProperties properties = mass_properties(spreader);
  EXPECT_NEAR(properties.mass, 10e3, 1e-9);
  // 7.5 t at 0.3 m, 2.5 t at 0.85 m.
  EXPECT_NEAR(properties.p_BBcm.z(), 0.75 * 0.3 + 0.25 * 0.85, 1e-12);
}

}  // namespace
}  // namespace quayside::spreader
