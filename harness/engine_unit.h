// What the units that simulate a Scene have in common beyond the Unit interface: events, energy, statistics.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "contact_nn/contact.h"
#include "crane_models/scene.h"
#include "harness/unit.h"

namespace quayside::harness {

enum class EventKind {
  contact_made, contact_broken, rope_slack, rope_taut, landed, lifted, lock_closed, lock_opened,
  lock_refused,  // told to close where its pins are not in place
  tripped,       // a load limit of the machine, which stops its drives
  stopped,       // by the operator's emergency stop
};
const char* to_string(EventKind kind);

// One line of events.csv. Impulse, peak force and duration belong to contact_broken (and to contacts still made at the
// end of the run, which `open_contacts` reports): normal and friction force of A on B integrated over the contact.
struct Event {
  Time time = 0;
  EventKind kind{};
  std::string subject;    // "load/upper", "rope.front_left", "twistlocks"
  double impulse = 0;     // magnitude of ∫F dt [N s]
  double peak_force = 0;  // [N]
  double duration = 0;    // [s]
};

// Energies at the current time [J]; work and dissipation counted from the start.
//   residual = (kinetic + potential) − start − work_in + dissipated
struct EnergyLedger {
  double kinetic = 0;
  double potential = 0;    // gravity, ropes, locks, contacts
  double work_in = 0;      // by drives
  double dissipated = 0;   // ropes, locks (with what opening loses), contacts, joint damping
  double start = 0;        // kinetic + potential at the start
  double largest_exchange = 0;  // of |kinetic − its start|, |potential − its start|, work_in, dissipated so far
  double residual() const { return kinetic + potential - start - work_in + dissipated; }
};

struct EngineStatistics {
  std::uint64_t steps = 0;            // accepted steps of the integrator
  std::uint64_t rhs_evaluations = 0;  // of the dynamics
  std::uint64_t jacobians = 0;
  contact_nn::ContactCounters contact;
  std::uint64_t phantom_contacts = 0;  // MuJoCo: contacts outside geometric bounds, reported and not hidden
};

struct SolverSettings {
  double relative_tolerance = 1e-6;  // in (0, 1e-2]
  double max_step = 0;               // [s]; 0: no bound other than near contacts
  double mujoco_step = 0;            // [s]; 0: chosen from the stiffest time constant
  std::string integrator = "bdf";    // of the Simbody unit: see simbody/integrator.h
  std::string mujoco_integrator = "rk4";  // of the MuJoCo units: rk4, implicit or euler
  std::string free_bodies = "tree";       // of the Simbody unit: tree or direct, see MultibodyModel
  // Contact forces by our laws are evaluated at communication points and events and held in between, instead of at every
  // evaluation of the dynamics. Contacts of MuJoCo's own are not concerned.
  bool sampled_contact = false;
};

// Names of the variables of an engine unit, all engines alike, in this order:
//   inputs   <drive>.value, <drive>.rate, <drive>.acceleration, <drive>.jerk per drive; <command> per command
//   outputs  per ReportedFrame R: R.position.{x,y,z}, R.orientation.{w,x,y,z}, R.velocity.{x,y,z},
//            R.angular_velocity.{x,y,z}, R.tilt (angle between R's z axis and the world's);
//            per rope: <rope>.tension, <rope>.stretch; per lock with a command: <lock>.closed (boolean); per pair of bodies that may meet: contact.<a>.<b>.force;
//            per switch: <switch> (boolean); energy.{kinetic,potential,work_in,dissipated,residual}
std::vector<Variable> engine_variables(const crane_models::Scene& scene);

class EngineUnit : public Unit {
 public:
  virtual std::vector<Event> take_events() = 0;           // since the last call, in the order of time
  virtual std::vector<Event> open_contacts() const = 0;   // contacts that are made now, as contact_broken rows would be
  virtual EnergyLedger energy() const = 0;
  virtual EngineStatistics statistics() const = 0;
};

// "simbody", "mujoco_same_law" or "mujoco". Throws std::invalid_argument for another name or a scene it cannot build.
std::unique_ptr<EngineUnit> make_engine(const std::string& engine, const crane_models::Scene& scene,
                                        const contact_nn::ContactSettings& contact, const SolverSettings& solver);

}  // namespace quayside::harness
