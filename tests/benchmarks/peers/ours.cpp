// The contact module's own queries and forces. An engine knows the poses of both boxes in the world: their relative pose is
// made within the timed query.
#include "contact_nn/batch.h"
#include "contact_nn/learned_potential.h"
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

class Force : public Ours {
 public:
  Force(const std::string& name, Model model, Law law) : Ours(name, model, law), law_(law) {
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
    if (law_ == Law::learned)
      return "ContactModule::force, law learned (a network; exact outside its domain), with damping and friction; passes in "
             "batches of 64; " + std::to_string(100.0 * static_cast<double>(counters_.network_evaluations) /
                                              static_cast<double>(std::max<std::uint64_t>(counters_.queries, 1))) +
             " % of the calls in the network's domain";
    return "ContactModule::force, law potential, with damping and friction" + share_of_fallbacks(counters_);
  }

 protected:
  RelativeVelocity V_;

 private:
  Law law_;
  ContactForce force_;
};

// Passes in batches of 64.
constexpr std::size_t kBatch = 64;

class LearnedForce final : public Force {
 public:
  LearnedForce() : Force("learned force", Model::exact, Law::learned) {
    batch_.fill({{Eigen::Vector3d::Ones()}, {Eigen::Vector3d::Ones()}, Pose::Identity(), V_});
  }

  double pass(std::size_t count) override {
    const auto& learned = dynamic_cast<const LearnedModule&>(*module_);
    double sum = 0;
    for (std::size_t first = 0; first < count; first += kBatch) {
      const std::size_t n = std::min(kBatch, count - first);
      for (std::size_t i = 0; i < n; ++i) {
        const Pair& x = pairs_[first + i];
        batch_[i].a = x.a;
        batch_[i].b = x.b;
        batch_[i].X_AB = x.X_AB();
      }
      learned.forces(batch_.data(), n, forces_.data(), counters_);
      for (std::size_t i = 0; i < n; ++i) sum += forces_[i].f_A[2];
    }
    return sum;
  }

 private:
  std::array<LearnedPair, kBatch> batch_;
  std::array<ContactForce, kBatch> forces_;
};

// The separating-axis test alone, eight pairs at a time: gap and axis, no points.
class Separations final : public Ours {
 public:
  Separations() : Ours("separations", Model::exact, Law::points) {
    gives_point = false;
    batch_.fill({{Eigen::Vector3d::Ones()}, {Eigen::Vector3d::Ones()}, Pose::Identity()});
  }

  double query(std::size_t i) override {
    last_ = i;
    const Pair& x = pairs_[i];
    const AxisSeparation s = largest_separation(x.a, x.b, x.X_AB());
    found_ = s;
    return s.gap;
  }

  double pass(std::size_t count) override {
    double sum = 0;
    for (std::size_t first = 0; first < count; first += kBatch) {
      const std::size_t n = std::min(kBatch, count - first);
      for (std::size_t i = 0; i < n; ++i) {
        const Pair& x = pairs_[first + i];
        batch_[i].a = x.a;
        batch_[i].b = x.b;
        batch_[i].X_AB = x.X_AB();
      }
      separations(batch_.data(), n, answers_.data());
      for (std::size_t i = 0; i < n; ++i) sum += answers_[i].gap;
    }
    return sum;
  }

  Answer answer() const override {
    Answer answer;
    answer.touching = found_.gap < 0;
    if (!answer.touching) return answer;
    answer.depth = -found_.gap;
    answer.n_W = pairs_[last_].X_WA.linear() * found_.n_A;
    return answer;
  }

  std::string note() const override {
    return "largest_separation: gap, axis and normal of 15, no points; passes in batches of 64 (gap and axis)";
  }

 private:
  AxisSeparation found_{};
  std::array<BoxPair, kBatch> batch_;
  std::array<GapAndAxis, kBatch> answers_{};
};

}  // namespace

void add_ours(Contenders& all) {
  all.push_back(std::make_unique<Query>("exact query", Model::exact));
  all.push_back(std::make_unique<Query>("committee query", Model::committee));
  all.push_back(std::make_unique<Separations>());
  all.push_back(std::make_unique<Force>("exact force", Model::exact, Law::potential));
  all.push_back(std::make_unique<Force>("committee force", Model::committee, Law::potential));
  all.push_back(std::make_unique<LearnedForce>());
}

}  // namespace quayside::peers
