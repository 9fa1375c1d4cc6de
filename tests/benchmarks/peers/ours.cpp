// The contact module's own queries and forces. An engine knows the poses of both boxes in the world: their relative pose is
// made within the timed query.
#include "tests/benchmarks/peers/contender.h"

namespace quayside::peers {
namespace {

using namespace contact_nn;

std::unique_ptr<ContactModule> module_of(Model model, Law law) {
  ContactSettings settings;
  settings.model = model;
  settings.law = law;
  return make_contact_module(settings);
}

std::string share_of_fallbacks(const ContactCounters& counters) {
  if (counters.network_evaluations == 0) return "";
  return "; " + std::to_string(100.0 * static_cast<double>(counters.fallbacks) / static_cast<double>(counters.queries)) +
         " % of the calls fell back to exact";
}

class Ours : public Contender {
 public:
  Ours(const std::string& name, Model model, Law law) : Contender(name, Kind::ours), module_(module_of(model, law)) {}
  void load(const std::vector<Placed>& pairs) override {
    pairs_.clear();
    for (const Placed& x : pairs) pairs_.push_back({x.a, x.b, x.X_WA.pose(), x.X_WB.pose()});
  }

 protected:
  struct Pair {
    Box a, b;
    Pose X_WA, X_WB;
    Pose X_AB() const { return X_WA.inverse(Eigen::Isometry) * X_WB; }
  };

  std::unique_ptr<ContactModule> module_;
  std::vector<Pair> pairs_;
  std::size_t last_ = 0;
  ContactCounters counters_;
};

class Query final : public Ours {
 public:
  Query(const std::string& name, Model model) : Ours(name, model, Law::points) {}

  double query(std::size_t i) override {
    last_ = i;
    const Pair& x = pairs_[i];
    manifold_ = module_->query(x.a, x.b, x.X_AB(), counters_);
    return manifold_.gap;
  }

  Answer answer() const override {
    Answer answer;
    answer.touching = manifold_.count > 0;
    if (!answer.touching) return answer;
    const Pose& X_WA = pairs_[last_].X_WA;
    WeightedPoints points;
    for (int i = 0; i < manifold_.count; ++i) {
      const ManifoldPoint& point = manifold_.points[static_cast<std::size_t>(i)];
      points.add(X_WA * point.p_A, point.depth);
    }
    answer.count = manifold_.count;
    answer.depth = -manifold_.gap;
    answer.n_W = X_WA.linear() * manifold_.n_A;
    answer.point_W = points.mean();
    return answer;
  }

  std::string note() const override {
    return "ContactModule::query: gap, normal, class, up to 8 points" + share_of_fallbacks(counters_);
  }

 private:
  Manifold manifold_{};
};

class Force final : public Ours {
 public:
  Force(const std::string& name, Model model) : Ours(name, model, Law::potential) {
    V_.v_A = Eigen::Vector3d(0.01, 0.02, -0.1);
    V_.w_A = Eigen::Vector3d(0.01, 0.02, 0.03);
  }

  double query(std::size_t i) override {
    last_ = i;
    const Pair& x = pairs_[i];
    force_ = module_->force(x.a, x.b, x.X_AB(), V_, counters_);
    return force_.f_A[2];
  }

  // Friction and damping turn the force away from the normal: direction and point are taken at rest.
  Answer answer() const override {
    const Pair& x = pairs_[last_];
    ContactCounters ignored;
    const ContactForce at_rest = module_->force(x.a, x.b, x.X_AB(), RelativeVelocity{}, ignored);
    Answer answer;
    answer.touching = force_.touching;
    if (!answer.touching) return answer;
    answer.count = 1;
    answer.n_W = x.X_WA.linear() * at_rest.f_A.normalized();
    answer.point_W = x.X_WA * at_rest.impact_point_A;
    return answer;
  }

  std::string note() const override {
    return "ContactModule::force, law potential, with damping and friction" + share_of_fallbacks(counters_);
  }

 private:
  RelativeVelocity V_;
  ContactForce force_;
};

}  // namespace

void add_ours(Contenders& all) {
  all.push_back(std::make_unique<Query>("exact query", Model::exact));
  all.push_back(std::make_unique<Query>("committee query", Model::committee));
  all.push_back(std::make_unique<Force>("exact force", Model::exact));
  all.push_back(std::make_unique<Force>("committee force", Model::committee));
}

}  // namespace quayside::peers
