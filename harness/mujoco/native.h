// MuJoCo as an independent model: its own tendons, equality constraints and contacts.
#pragma once

#include "harness/mujoco/engine.h"
#include "harness/mujoco/mjcf.h"

namespace quayside::harness::mujoco {

// Parameters as of `native_options`. Rest lengths are set at the begin of each step and, for the other stages, at their
// mean time. A tendon's damper does not know the rate of its limit; with the limit at L0 + damping_time · L̇0 the
// tension K (l − limit) + C l̇ is K (l − L0) + C (l̇ − L̇0), as it should be.
//
// Contacts that geometry does not allow (see phantom.h) are counted at every evaluation and left in. Between level boxes
// the 2.2.2 collider sometimes takes a pair of crossing edges for the contact, one point of the whole depth, instead of
// the faces, four points of half of it: stacks rattle by that while they settle. Crossing edges come with their whole depth, and
// so strike twice as stiff (peak force + 41 %); an edge that comes down on a face of its own length can be thrown back with ten
// times its impulse.
//
// The energy ledger counts what is known of MuJoCo's forces: ropes by their true stretch; locks and contacts as springs
// by their violation, and as dissipated what the rest of each force takes. It is summed by the trapezoidal rule; a
// change in the number of contact points moves elastic energy without anyone's work and stays in the residual.
class NativeEngine final : public Engine, private PassiveLaw {
 public:
  NativeEngine(const crane_models::Scene& scene, const contact_nn::ContactSettings& contact,
               const SolverSettings& solver);

 private:
  NativeEngine(const crane_models::Scene& scene, const contact_nn::ContactSettings& contact,
               const SolverSettings& solver, const MjcfOptions& options);
  void prepare_evaluation() override;
  void prepare_stages(double h) override;
  void read_loads() override;
  void integrate(double h, const std::vector<double>& rates_at_begin) override;
  PassiveLaw* law() override { return this; }
  // Adds no force, but sees the contacts of every stage.
  void add_passive_forces(const mjModel* model, mjData* data) override;

  // A contact pair as MuJoCo has it.
  struct Pair {
    int box_a, box_b;       // geoms of the boxes, also where a plane stands for one in contacts
    double reported_depth;  // see FlatContact
  };
  struct PairContact {
    int pair;
    double sign;  // of MuJoCo's normal, to point from a to b
  };

  void set_ropes(double after);
  PairContact find_pair(const mjContact& contact) const;
  void read_ropes();
  void read_contacts();
  void read_energy();

  std::vector<int> tendons_;                // per rope
  std::vector<std::vector<int>> equalities_;  // per lock and pin
  std::vector<Pair> pairs_;
  std::vector<int> pair_of_geoms_;          // geom × geom: index + 1 of the pair, negative when the other way round
};

}  // namespace quayside::harness::mujoco
