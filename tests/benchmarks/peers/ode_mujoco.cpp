// The routines for two boxes of ODE and MuJoCo.
#include <array>
#include <cstring>
#include <stdexcept>

#include <mujoco/mujoco.h>
#include <ode/ode.h>

#include "tests/benchmarks/peers/contender.h"

namespace quayside::peers {
namespace {

using Eigen::Vector3d;

class Ode final : public Contender {
 public:
  Ode() : Contender("ODE", Kind::box_routine) {}

  void load(const std::vector<Placed>& pairs) override {
    pairs_.clear();
    for (const Placed& x : pairs) pairs_.push_back({posed(x.a, x.X_WA), posed(x.b, x.X_WB)});
  }

  double query(std::size_t i) override {
    const Posed &a = pairs_[i].first, &b = pairs_[i].second;
    int code;
    count_ = dBoxBox(a.p, a.R, a.side, b.p, b.R, b.side, normal_, &depth_, &code, kMostPoints, points_.data(),
                     sizeof(dContactGeom));
    return count_ > 0 ? depth_ : 0;
  }

  Answer answer() const override {
    Answer answer;
    answer.touching = count_ > 0;
    if (!answer.touching) return answer;
    WeightedPoints points;
    for (int k = 0; k < count_; ++k) {
      const dContactGeom& c = points_[static_cast<std::size_t>(k)];
      points.add(Vector3d(c.pos[0], c.pos[1], c.pos[2]), c.depth);
    }
    answer.count = count_;
    answer.depth = depth_;
    answer.n_W = Vector3d(normal_[0], normal_[1], normal_[2]);  // of dBoxBox itself; dCollide turns it round
    answer.point_W = points.mean();
    return answer;
  }

  std::string note() const override { return "dBoxBox, double precision, up to 8 points"; }

 private:
  static constexpr int kMostPoints = 8;
  struct Posed {
    dVector3 p, side;
    dMatrix3 R;
  };
  static Posed posed(const Box& box, const Placement& X) {
    Posed out{};
    for (int i = 0; i < 3; ++i) {
      out.p[i] = X.p[i];
      out.side[i] = 2 * box.half[i];
      for (int j = 0; j < 3; ++j) out.R[4 * i + j] = X.R(i, j);
    }
    return out;
  }

  std::vector<std::pair<Posed, Posed>> pairs_;
  int count_ = 0;
  dReal depth_ = 0;
  dVector3 normal_{};
  std::array<dContactGeom, kMostPoints> points_{};
};

// Two free boxes. Their sizes and poses are written into MuJoCo's model and data, which takes some nanoseconds of the
// timed query.
class Mujoco final : public Contender {
 public:
  enum class Part { routine, stage };

  Mujoco(const std::string& name, Part part) : Contender(name, Kind::box_routine), part_(part) {
    const std::string mjcf = R"(<mujoco>
      <worldbody>
        <body><freejoint/><geom type="box" size="1 1 1" mass="1"/></body>
        <body pos="0 0 4"><freejoint/><geom type="box" size="1 1 1" mass="1"/></body>
      </worldbody>
    </mujoco>)";
    const char* file = "two_boxes.xml";
    const auto vfs = std::make_unique<mjVFS>();
    mj_defaultVFS(vfs.get());
#if mjVERSION_HEADER >= 310
    mj_addBufferVFS(vfs.get(), file, mjcf.data(), static_cast<int>(mjcf.size()));
#else
    mj_makeEmptyFileVFS(vfs.get(), file, static_cast<int>(mjcf.size()));
    std::memcpy(vfs->filedata[mj_findFileVFS(vfs.get(), file)], mjcf.data(), mjcf.size());
#endif
    char error[1000] = "";
    model_.reset(mj_loadXML(file, vfs.get(), error, sizeof(error)));
    mj_deleteVFS(vfs.get());
    if (!model_) throw std::runtime_error(std::string("MuJoCo refuses two boxes: ") + error);
    if (mj_version() == 222) reported_depth = 0.5;  // of faces that lie or stand on each other; that of Debian 12
    data_.reset(mj_makeData(model_.get()));
    mj_forward(model_.get(), data_.get());
  }

  void load(const std::vector<Placed>& pairs) override {
    pairs_.clear();
    for (const Placed& x : pairs) {
      Pair pair{};
      const auto put = [&pair](int k, const Box& box, const Placement& X) {
        pair.reach[k] = box.half.norm();
        for (int i = 0; i < 3; ++i) {
          pair.size[3 * k + i] = box.half[i];
          pair.p[3 * k + i] = X.p[i];
          for (int j = 0; j < 3; ++j) pair.R[9 * k + 3 * i + j] = X.R(i, j);
        }
      };
      put(0, x.a, x.X_WA);
      put(1, x.b, x.X_WB);
      pairs_.push_back(pair);
    }
  }

  double query(std::size_t i) override {
    const Pair& x = pairs_[i];
    mjModel* m = model_.get();
    mjData* d = data_.get();
    std::memcpy(m->geom_size, x.size, sizeof x.size);
    std::memcpy(d->geom_xpos, x.p, sizeof x.p);
    std::memcpy(d->geom_xmat, x.R, sizeof x.R);
    if (part_ == Part::routine) {
      contacts_ = routine_contacts_.data();
      count_ = mjCOLLISIONFUNC[mjGEOM_BOX][mjGEOM_BOX](m, d, routine_contacts_.data(), 0, 1, 0);
    } else {
      std::memcpy(m->geom_rbound, x.reach, sizeof x.reach);
      mj_collision(m, d);
      contacts_ = d->contact;
      count_ = d->ncon;
    }
    return count_ > 0 ? contacts_[0].dist : 0;
  }

  Answer answer() const override {
    Answer answer;
    answer.touching = count_ > 0;
    if (!answer.touching) return answer;
    WeightedPoints points;
    for (int k = 0; k < count_; ++k) points.add(Vector3d(contacts_[k].pos), -contacts_[k].dist);
    answer.count = count_;
    answer.depth = points.deepest();
    answer.n_W = Vector3d(contacts_[0].frame);
    answer.point_W = points.mean();
    return answer;
  }

  std::string note() const override {
    return std::string("version ") + mj_versionString() + ", " +
           (part_ == Part::routine ? "the box-box entry of mjCOLLISIONFUNC alone"
                                   : "mj_collision: broad phase, filters, box-box, contact list; no kinematics");
  }

 private:
  struct Pair {
    mjtNum size[6], p[6], R[18], reach[2];
  };
  struct Delete {
    void operator()(mjModel* m) const { mj_deleteModel(m); }
    void operator()(mjData* d) const { mj_deleteData(d); }
  };

  Part part_;
  std::unique_ptr<mjModel, Delete> model_;
  std::unique_ptr<mjData, Delete> data_;
  std::vector<Pair> pairs_;
  std::array<mjContact, mjMAXCONPAIR> routine_contacts_{};
  const mjContact* contacts_ = nullptr;
  int count_ = 0;
};

}  // namespace

void add_ode_and_mujoco(Contenders& all) {
  all.push_back(std::make_unique<Ode>());
  all.push_back(std::make_unique<Mujoco>("MuJoCo", Mujoco::Part::routine));
  all.push_back(std::make_unique<Mujoco>("MuJoCo stage", Mujoco::Part::stage));
}

}  // namespace quayside::peers
