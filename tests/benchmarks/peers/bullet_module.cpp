// Bullet's box-box detector, as a module of its own: Debian's Bullet in single and that in double precision define the same
// symbols, so that one program cannot link both.
#include <array>
#include <deque>

#include <BulletCollision/CollisionDispatch/btBoxBoxDetector.h>
#include <BulletCollision/CollisionShapes/btBoxShape.h>

#include "tests/benchmarks/peers/contender.h"

namespace quayside::peers {
namespace {

using Eigen::Vector3d;

btVector3 bullet(const Vector3d& v) {
  return {static_cast<btScalar>(v[0]), static_cast<btScalar>(v[1]), static_cast<btScalar>(v[2])};
}

btTransform bullet(const Placement& X) {
  btMatrix3x3 R;
  for (int i = 0; i < 3; ++i) R[i] = bullet(Vector3d(X.R.row(i)));
  return btTransform(R, bullet(X.p));
}

struct Points final : btDiscreteCollisionDetectorInterface::Result {
  struct Point {
    btVector3 n, p;
    btScalar distance;
  };
  void setShapeIdentifiersA(int, int) override {}
  void setShapeIdentifiersB(int, int) override {}
  void addContactPoint(const btVector3& normal_on_b, const btVector3& p, btScalar distance) override {
    if (count < static_cast<int>(point.size())) point[static_cast<std::size_t>(count++)] = {normal_on_b, p, distance};
  }
  int count = 0;
  std::array<Point, 16> point;
};

class Bullet final : public Contender {
 public:
  Bullet() : Contender(sizeof(btScalar) == 4 ? "Bullet float" : "Bullet double", Kind::box_routine) {}

  void load(const std::vector<Placed>& pairs) override {
    pairs_.clear();
    for (const Placed& x : pairs) pairs_.emplace_back(x);
  }

  // As btBoxBoxCollisionAlgorithm does it, without its manifold cache.
  double query(std::size_t i) override {
    const Pair& x = pairs_[i];
    points_.count = 0;
    btDiscreteCollisionDetectorInterface::ClosestPointInput input;
    input.m_maximumDistanceSquared = BT_LARGE_FLOAT;
    input.m_transformA = x.X_WA;
    input.m_transformB = x.X_WB;
    btBoxBoxDetector detector(&x.a, &x.b);
    detector.getClosestPoints(input, points_, nullptr);
    return points_.count > 0 ? points_.point[0].distance : 0;
  }

  Answer answer() const override {
    Answer answer;
    answer.touching = points_.count > 0;
    if (!answer.touching) return answer;
    const auto eigen = [](const btVector3& v) { return Vector3d(v.x(), v.y(), v.z()); };
    WeightedPoints points;
    for (int k = 0; k < points_.count; ++k) {
      const Points::Point& point = points_.point[static_cast<std::size_t>(k)];
      points.add(eigen(point.p), -point.distance);
    }
    answer.count = points_.count;
    answer.depth = points.deepest();
    answer.n_W = -eigen(points_.point[0].n);
    answer.point_W = points.mean();
    return answer;
  }

  std::string note() const override { return "btBoxBoxDetector, up to 4 points, without the persistent manifold"; }

 private:
  struct Pair {
    explicit Pair(const Placed& x)
        : a(bullet(x.a.half)), b(bullet(x.b.half)), X_WA(bullet(x.X_WA)), X_WB(bullet(x.X_WB)) {}
    btBoxShape a, b;
    btTransform X_WA, X_WB;
  };
  std::deque<Pair> pairs_;  // shapes do not like to be moved
  Points points_;
};

}  // namespace
}  // namespace quayside::peers

extern "C" __attribute__((visibility("default"))) void add_contenders(quayside::peers::Contenders& all) {
  all.push_back(std::make_unique<quayside::peers::Bullet>());
}
