// The contact module alone: where do two 40 ft containers touch, and with which force?
#include <cstdio>

#include "contact_nn/contact.h"

int main() {
  using namespace quayside::contact_nn;
  const Box container{{6.096, 1.219, 1.2955}};
  Pose X_AB = Pose::Identity();
  X_AB.translation() = Eigen::Vector3d(0.1, 0, 2 * 1.2955 - 0.002);  // B lies on A, 2 mm deep

  const auto module = make_contact_module(ContactSettings{});
  ContactCounters counters;
  const Manifold manifold = module->query(container, container, X_AB, counters);
  std::printf("gap %.6f m, normal (%.3f, %.3f, %.3f)\n", manifold.gap, manifold.n_A.x(), manifold.n_A.y(), manifold.n_A.z());
  for (int i = 0; i < manifold.count; ++i) {
    const ManifoldPoint& point = manifold.points[i];
    std::printf("point (%.3f, %.3f, %.3f) m, %.6f m deep\n", point.p_A.x(), point.p_A.y(), point.p_A.z(), point.depth);
  }
  const ContactForce force = module->force(container, container, X_AB, RelativeVelocity{}, counters);
  std::printf("normal force %.1f kN at (%.3f, %.3f, %.3f) m\n", 1e-3 * force.normal_force, force.impact_point_A.x(),
              force.impact_point_A.y(), force.impact_point_A.z());
}
