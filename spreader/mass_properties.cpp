#include "spreader/mass_properties.h"

namespace quayside::spreader {
namespace {

Eigen::Matrix3d point_mass(double mass, const Eigen::Vector3d& p) {
  return mass * (p.squaredNorm() * Eigen::Matrix3d::Identity() - p * p.transpose());
}

}  // namespace

MassProperties uniform_box(double mass, const Eigen::Vector3d& size) {
  const Eigen::Vector3d squares = size.cwiseAbs2();
  MassProperties box;
  box.mass = mass;
  box.I_BBcm_B = (mass / 12) * (squares.sum() * Eigen::Vector3d::Ones() - squares).asDiagonal();
  return box;
}

MassProperties moved(const MassProperties& in_B, const Eigen::Isometry3d& X_AB) {
  return {in_B.mass, X_AB * in_B.p_BBcm, X_AB.linear() * in_B.I_BBcm_B * X_AB.linear().transpose()};
}

MassProperties combined(const MassProperties& a, const MassProperties& b) {
  MassProperties both;
  both.mass = a.mass + b.mass;
  both.p_BBcm = (a.mass * a.p_BBcm + b.mass * b.p_BBcm) / both.mass;
  both.I_BBcm_B = a.I_BBcm_B + point_mass(a.mass, a.p_BBcm - both.p_BBcm) +  //
                  b.I_BBcm_B + point_mass(b.mass, b.p_BBcm - both.p_BBcm);
  return both;
}

}  // namespace quayside::spreader
