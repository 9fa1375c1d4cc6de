// Methods of libccd for any convex bodies: GJK with EPA, and MPR.
#include <cmath>

#include <ccd/ccd.h>

#include "tests/benchmarks/peers/contender.h"

namespace quayside::peers {
namespace {

using Eigen::Vector3d;

// libccd asks for the farthest point in a direction: for a box a corner, by three signs.
struct CcdBox {
  Vector3d half;
  Eigen::Matrix3d R;
  Vector3d p;
};

void support(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* out) {
  const auto& box = *static_cast<const CcdBox*>(object);
  const Vector3d d = box.R.transpose() * Vector3d(direction->v[0], direction->v[1], direction->v[2]);
  Vector3d corner;
  for (int i = 0; i < 3; ++i) corner[i] = std::copysign(box.half[i], d[i]);
  const Vector3d p = box.p + box.R * corner;
  ccdVec3Set(out, p[0], p[1], p[2]);
}

void centre(const void* object, ccd_vec3_t* out) {
  const Vector3d& p = static_cast<const CcdBox*>(object)->p;
  ccdVec3Set(out, p[0], p[1], p[2]);
}

using Penetration = int (*)(const void*, const void*, const ccd_t*, ccd_real_t*, ccd_vec3_t*, ccd_vec3_t*);

// Iterations after which libccd gives up: its own default is never, which a tight tolerance does not survive.
constexpr unsigned long kMostIterations = 500;

class Ccd final : public Contender {
 public:
  Ccd(const std::string& name, Penetration penetration, double tolerance)
      : Contender(name, Kind::convex), penetration_(penetration) {
    CCD_INIT(&ccd_);
    ccd_.support1 = ccd_.support2 = support;
    ccd_.center1 = ccd_.center2 = centre;
    ccd_.max_iterations = kMostIterations;
    ccd_.epa_tolerance = ccd_.mpr_tolerance = tolerance;
    // Its EPA's point is a mean over many corners, and far off (its issues 17 and 73).
    if (penetration == ccdGJKPenetration) check_point_tolerance = 0.5;
  }

  void load(const std::vector<Placed>& pairs) override {
    pairs_.clear();
    for (const Placed& x : pairs) {
      pairs_.push_back({{x.a.half, x.X_WA.R, x.X_WA.p}, {x.b.half, x.X_WB.R, x.X_WB.p}});
    }
  }

  double query(std::size_t i) override {
    touching_ = penetration_(&pairs_[i].first, &pairs_[i].second, &ccd_, &depth_, &direction_, &point_) == 0;
    return touching_ ? depth_ : 0;
  }

  Answer answer() const override {
    Answer answer;
    answer.touching = touching_;
    if (!answer.touching) return answer;
    answer.count = 1;
    answer.depth = depth_;
    answer.n_W = Vector3d(direction_.v).normalized();
    answer.point_W = Vector3d(point_.v);
    return answer;
  }

  std::string note() const override {
    return std::string(penetration_ == ccdMPRPenetration ? "ccdMPRPenetration" : "ccdGJKPenetration") + ", tolerance " +
           (ccd_.epa_tolerance < 1e-4 ? "1e-8" : "1e-4 (the default)") + ", one point";
  }

 private:
  Penetration penetration_;
  ccd_t ccd_;
  std::vector<std::pair<CcdBox, CcdBox>> pairs_;
  bool touching_ = false;
  ccd_real_t depth_ = 0;
  ccd_vec3_t direction_{}, point_{};
};

}  // namespace

void add_libccd(Contenders& all) {
  all.push_back(std::make_unique<Ccd>("libccd GJK/EPA", ccdGJKPenetration, 1e-4));
  all.push_back(std::make_unique<Ccd>("libccd GJK/EPA tight", ccdGJKPenetration, 1e-8));
  all.push_back(std::make_unique<Ccd>("libccd MPR", ccdMPRPenetration, 1e-4));
  all.push_back(std::make_unique<Ccd>("libccd MPR tight", ccdMPRPenetration, 1e-8));
}

}  // namespace quayside::peers
