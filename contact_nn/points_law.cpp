#include "contact_nn/points_law.h"

#include <algorithm>
#include <cmath>

namespace quayside::contact_nn {

ContactForce points_force(const Manifold& manifold, const Pose& X_AB, const RelativeVelocity& V_AB,
                          const LawParameters& law) {
  ContactForce result;
  const Eigen::Vector3d& n = manifold.n_A;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double elastic_load = 0;
  for (int i = 0; i < manifold.count; ++i) {
    const ManifoldPoint& point = manifold.points[i];
    if (point.depth <= 0) continue;
    const double elastic = law.stiffness / manifold.count * point.depth;
    const Eigen::Vector3d v = V_AB.v_A + V_AB.w_A.cross(point.p_A - X_AB.translation());
    const double approach = -n.dot(v);
    const double N = elastic * std::max(0.0, 1 + law.damping * approach);
    const Eigen::Vector3d v_t = v + approach * n;
    const double drag =
        law.friction * N / std::sqrt(v_t.squaredNorm() + law.transition_speed * law.transition_speed);
    const Eigen::Vector3d f = N * n - drag * v_t;

    result.touching = true;
    result.f_A += f;
    result.t_A += point.p_A.cross(f);
    result.normal_force += N;
    result.potential_energy += 0.5 * elastic * point.depth;
    result.dissipated_power += (N - elastic) * approach + drag * v_t.squaredNorm();
    centre += elastic * point.p_A;
    elastic_load += elastic;
  }
  if (!result.touching) return result;
  result.impact_point_A = centre / elastic_load;
  if (!law.pressure_radius) return result;
  for (int i = 0; i < manifold.count; ++i) {
    const ManifoldPoint& point = manifold.points[i];
    if (point.depth <= 0) continue;
    const double share = law.stiffness / manifold.count * point.depth / elastic_load;
    result.pressure_radius2 += share * n.cross(point.p_A - result.impact_point_A).squaredNorm();
  }
  return result;
}

}  // namespace quayside::contact_nn
