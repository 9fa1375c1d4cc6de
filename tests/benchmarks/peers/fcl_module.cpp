// FCL: its box routine, its methods for any convex bodies, and triangle meshes in trees of oriented boxes.
//
// A module of its own: Debian compiles FCL for a narrower vector width than ours, and so with another layout of Eigen's types.
#include <array>
#include <chrono>
#include <cmath>
#include <map>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/narrowphase/collision.h>

#include "tests/benchmarks/peers/contender.h"

namespace quayside::peers {
namespace {

using Eigen::Vector3d;

class FclBox final : public Contender {
 public:
  FclBox() : Contender("FCL box", Kind::box_routine), request_(8, true) {}

  void load(const std::vector<Placed>& pairs) override {
    pairs_.clear();
    for (const Placed& x : pairs) {
      pairs_.push_back({fcl::Boxd(2 * x.a.half), fcl::Boxd(2 * x.b.half), x.X_WA.pose(), x.X_WB.pose()});
    }
  }

  double query(std::size_t i) override {
    const Pair& x = pairs_[i];
    result_.clear();
    fcl::collide(&x.a, x.X_WA, &x.b, x.X_WB, request_, result_);
    return static_cast<double>(result_.numContacts());
  }

  Answer answer() const override {
    Answer answer;
    answer.touching = result_.isCollision();
    if (!answer.touching) return answer;
    WeightedPoints points;
    for (std::size_t k = 0; k < result_.numContacts(); ++k) {
      points.add(result_.getContact(k).pos, result_.getContact(k).penetration_depth);
    }
    answer.count = points.count();
    answer.depth = points.deepest();
    answer.n_W = result_.getContact(0).normal;
    answer.point_W = points.mean();
    return answer;
  }

  std::string note() const override { return "fcl::collide of two Boxd, up to 8 points"; }

 private:
  struct Pair {
    fcl::Boxd a, b;
    fcl::Transform3d X_WA, X_WB;
  };
  std::vector<Pair> pairs_;
  fcl::CollisionRequestd request_;
  fcl::CollisionResultd result_;
};

// A box as FCL's general convex body; as a Boxd it would be given to FCL's box routine.
fcl::Convexd convex(const Box& box) {
  auto corners = std::make_shared<std::vector<Vector3d>>();
  for (int i = 0; i < 8; ++i) {
    corners->push_back(box.half.cwiseProduct(Vector3d(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1)));
  }
  const auto faces = std::make_shared<std::vector<int>>(std::vector<int>{4, 0, 4, 6, 2, 4, 1, 3, 7, 5, 4, 0, 1, 5, 4,
                                                                         4, 2, 6, 7, 3, 4, 0, 2, 3, 1, 4, 4, 5, 7, 6});
  return fcl::Convexd(corners, 6, faces, true);
}

class FclConvex final : public Contender {
 public:
  FclConvex(const std::string& name, fcl::GJKSolverType solver, std::string note)
      : Contender(name, Kind::convex), request_(1, true, 1, false, true, solver), in_frame_of_a_(solver == fcl::GST_INDEP),
        note_(std::move(note)) {}

  void load(const std::vector<Placed>& pairs) override {
    pairs_.clear();
    for (const Placed& x : pairs) pairs_.push_back({convex(x.a), convex(x.b), x.X_WA.pose(), x.X_WB.pose()});
  }

  double query(std::size_t i) override {
    last_ = i;
    const Pair& x = pairs_[i];
    result_.clear();
    fcl::collide(&x.a, x.X_WA, &x.b, x.X_WB, request_, result_);
    return static_cast<double>(result_.numContacts());
  }

  Answer answer() const override {
    Answer answer;
    answer.touching = result_.isCollision();
    if (!answer.touching) return answer;
    const fcl::Contactd& contact = result_.getContact(0);
    answer.count = 1;
    answer.depth = std::abs(contact.penetration_depth);  // GST_INDEP gives it a minus sign
    answer.n_W = in_frame_of_a_ ? Vector3d(pairs_[last_].X_WA.linear() * contact.normal) : Vector3d(contact.normal);
    answer.point_W = contact.pos;
    return answer;
  }

  std::string note() const override { return note_; }

 private:
  struct Pair {
    fcl::Convexd a, b;
    fcl::Transform3d X_WA, X_WB;
  };
  std::vector<Pair> pairs_;
  fcl::CollisionRequestd request_;
  fcl::CollisionResultd result_;
  std::size_t last_ = 0;
  bool in_frame_of_a_;  // FCL 0.7 gives the normal of GST_INDEP in A's frame, not in the world
  std::string note_;
};

// ---- What the paper sets out to replace: the faces of both boxes cut into n × n squares, each into two triangles. To place
// the impact point within r edges, n is the integer part of √2 / r (the paper's section II).

using Model = fcl::BVHModel<fcl::OBBd>;

constexpr std::array<double, 6> kResolutions{0.5, 0.2, 0.1, 0.05, 0.02, 0.01};  // r, in edges

int squares_per_edge(double r) { return static_cast<int>(std::sqrt(2.0) / r); }

std::shared_ptr<Model> grid(const Box& box, int n) {
  std::vector<Vector3d> corners;
  std::vector<fcl::Triangle> triangles;
  for (int axis = 0; axis < 3; ++axis) {
    for (const int side : {-1, 1}) {
      const std::size_t first = corners.size();
      const auto at = [&](int i, int j) { return first + static_cast<std::size_t>(i * (n + 1) + j); };
      for (int i = 0; i <= n; ++i) {
        for (int j = 0; j <= n; ++j) {
          Vector3d p;
          p[axis] = side * box.half[axis];
          p[(axis + 1) % 3] = (2.0 * i / n - 1) * box.half[(axis + 1) % 3];
          p[(axis + 2) % 3] = (2.0 * j / n - 1) * box.half[(axis + 2) % 3];
          corners.push_back(p);
        }
      }
      const auto triangle = [&](std::size_t a, std::size_t b, std::size_t c) {  // normals outward
        triangles.push_back(side > 0 ? fcl::Triangle(a, b, c) : fcl::Triangle(a, c, b));
      };
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
          triangle(at(i, j), at(i + 1, j), at(i + 1, j + 1));
          triangle(at(i, j), at(i + 1, j + 1), at(i, j + 1));
        }
      }
    }
  }
  const auto model = std::make_shared<Model>();
  model->beginModel(static_cast<int>(triangles.size()), static_cast<int>(corners.size()));
  model->addSubModel(corners, triangles);
  model->endModel();
  return model;
}

// One model for every size of box, shared by all contenders of one resolution.
class Grids {
 public:
  explicit Grids(double r) : n_(squares_per_edge(r)) {}

  std::shared_ptr<Model> of(const Box& box) {
    std::shared_ptr<Model>& model = models_[{box.half[0], box.half[1], box.half[2]}];
    if (!model) {
      const auto start = std::chrono::steady_clock::now();
      model = grid(box, n_);
      seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }
    return model;
  }

  std::string note() const {
    std::string text = "n = " + std::to_string(n_) + ", " + std::to_string(12 * n_ * n_) + " triangles a box";
    if (models_.empty()) return text;
    const Model& model = *models_.begin()->second;
    const auto triangles = static_cast<std::size_t>(model.num_tris);
    const std::size_t bytes = static_cast<std::size_t>(model.getNumBVs()) * sizeof(fcl::BVNode<fcl::OBBd>) +
                              static_cast<std::size_t>(model.num_vertices) * sizeof(Vector3d) +
                              triangles * (sizeof(fcl::Triangle) + sizeof(unsigned));
    return text + ", built in " + std::to_string(static_cast<int>(1e3 * seconds_ / static_cast<double>(models_.size()))) +
           " ms, " + std::to_string(bytes / 1000) + " kB";
  }

 private:
  int n_;
  std::map<std::array<double, 3>, std::shared_ptr<Model>> models_;
  double seconds_ = 0;
};

class Mesh final : public Contender {
 public:
  Mesh(const std::string& name, double r, bool all, std::shared_ptr<Grids> grids)
      : Contender(name, Kind::mesh), request_(all ? kEveryContact : 1, true), grids_(std::move(grids)), all_(all) {
    mesh_resolution = r;
  }

  void load(const std::vector<Placed>& pairs) override {
    pairs_.clear();
    for (const Placed& x : pairs) pairs_.push_back({grids_->of(x.a), grids_->of(x.b), x.X_WA.pose(), x.X_WB.pose()});
  }

  double query(std::size_t i) override {
    const Pair& x = pairs_[i];
    result_.clear();
    fcl::collide(x.a.get(), x.X_WA, x.b.get(), x.X_WB, request_, result_);
    return static_cast<double>(result_.numContacts());
  }

  Answer answer() const override {
    Answer answer;
    answer.touching = result_.isCollision();
    if (!answer.touching) return answer;
    WeightedPoints points;
    Vector3d normal = Vector3d::Zero();
    for (std::size_t k = 0; k < result_.numContacts(); ++k) {
      const fcl::Contactd& contact = result_.getContact(k);
      points.add(contact.pos, contact.penetration_depth);
      normal += contact.normal;
    }
    answer.count = points.count();
    answer.depth = points.deepest();
    answer.n_W = normal.normalized();
    answer.point_W = points.mean();
    return answer;
  }

  std::string note() const override {
    return std::string("fcl::collide of BVHModel<OBBd>, ") + (all_ ? "all contacts" : "first contact") + ", " + grids_->note();
  }

 private:
  static constexpr std::size_t kEveryContact = std::size_t{1} << 30;
  struct Pair {
    std::shared_ptr<Model> a, b;
    fcl::Transform3d X_WA, X_WB;
  };
  std::vector<Pair> pairs_;
  fcl::CollisionRequestd request_;
  fcl::CollisionResultd result_;
  std::shared_ptr<Grids> grids_;
  bool all_;
};

std::string named(const char* what, double r) {
  std::string number = std::to_string(r);
  number.erase(number.find_last_not_of('0') + 1);
  return std::string(what) + " r=" + number;
}

}  // namespace
}  // namespace quayside::peers

extern "C" __attribute__((visibility("default"))) void add_contenders(quayside::peers::Contenders& all) {
  using namespace quayside::peers;
  all.push_back(std::make_unique<FclBox>());
  all.push_back(std::make_unique<FclConvex>(
      "FCL GJK/EPA", fcl::GST_INDEP, "fcl::collide of two Convexd with GST_INDEP, tolerance 1e-6 (the default), one point"));
  all.push_back(std::make_unique<FclConvex>(
      "FCL MPR", fcl::GST_LIBCCD, "fcl::collide of two Convexd with GST_LIBCCD, tolerance 1e-6 (the default), one point"));
  for (const double r : kResolutions) {
    const auto grids = std::make_shared<Grids>(r);
    all.push_back(std::make_unique<Mesh>(named("mesh all", r), r, true, grids));
    all.push_back(std::make_unique<Mesh>(named("mesh first", r), r, false, grids));
  }
}
