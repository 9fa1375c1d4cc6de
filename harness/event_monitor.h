// Events of an engine: contacts made and broken, ropes slack and taut, switches landed and lifted, each at its time.
//
// The engine hands over what it knows at the two ends of each step and a function that tells the same at any time
// between them (dense output); the monitor finds the sign changes of SceneForces::Indicators and keeps the books.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "harness/engine_unit.h"
#include "harness/scene_forces.h"
#include "harness/state_bytes.h"

namespace quayside::harness {

// Force on the second of two named things, summed over their boxes [N].
Eigen::Vector3d group_force(const crane_models::ContactGroup& group, const SceneLoads& loads);

class EventMonitor {
 public:
  // What the engine knows at one moment.
  struct Sample {
    double time = 0;                          // [s]
    SceneForces::Indicators indicators;
    std::vector<Eigen::Vector3d> impulses;    // per contact group: ∫F dt on `b` from any fixed start [N s]
    std::vector<double> forces;               // per contact group: magnitude of the force now [N]
  };
  // Fills `sample` at a time within the step at hand.
  using SampleAt = std::function<void(double time, Sample& sample)>;

  // The scene must outlive this object.
  explicit EventMonitor(const crane_models::Scene& scene);

  const std::vector<crane_models::ContactGroup>& groups() const { return groups_; }  // crane_models::contact_groups
  Sample make_sample() const;

  // Forgets everything and takes the state of all signals from `now`. Contacts that are made already are reported as
  // made now; ropes and switches are not events yet.
  void start(const Sample& now);

  // One step from `begin` to `end`; `begin` is where the last step ended. Where a landed switch flips within it, only
  // what happens up to then is booked and the time of the flip is returned: the unit ends its step there and the next
  // one begins there.
  //
  // A signal that changes and changes back within one step is not seen: the steps are the resolution.
  std::optional<Time> advance(const Sample& begin, const Sample& end, const SampleAt& at);

  void note(Time time, EventKind kind, int lock);  // of a lock

  bool landed(int landed_switch) const { return switches_[landed_switch].on; }
  bool touching(int group) const { return contacts_[group].on; }
  // Time since which this group touches [s]. Meaningful while it does.
  double touching_since(int group) const { return contacts_[group].start; }

  std::vector<Event> take_events();
  std::vector<Event> open_contacts(const Sample& now) const;

  void save(ByteWriter& out) const;
  void restore(ByteReader& in);

 private:
  enum class Kind : std::uint8_t { rope, contact, landed };
  struct Signal {
    bool on = false;  // taut, touching, landed
  };
  struct Contact : Signal {
    double start = 0;                                           // [s]
    double peak_force = 0;                                      // [N]
    double time_before = 0, force_before = 0;                   // where the step before this one began [s, N]
    Eigen::Vector3d impulse_at_start = Eigen::Vector3d::Zero();  // [N s]
  };
  struct Crossing {
    Time time;
    Kind kind;
    int index;
  };
  struct Row {  // an Event whose subject is an index
    Time time;
    EventKind kind;
    int index;
    double impulse, peak_force, duration;
  };

  double indicator(Kind kind, int index, const Sample& sample) const;
  bool is_on(Kind kind, int index) const;
  bool flips(Kind kind, int index, const Sample& sample) const;
  Time locate(Kind kind, int index, const Sample& begin, const Sample& end, const SampleAt& at);
  void flip(const Crossing& crossing, const Sample& then);
  std::string subject(const Row& row) const;
  int count(Kind kind) const;

  const crane_models::Scene& scene_;
  std::vector<crane_models::ContactGroup> groups_;
  std::vector<Signal> ropes_, switches_;
  std::vector<Contact> contacts_;
  std::vector<Row> rows_;
  std::vector<Crossing> crossings_;
  Sample probe_;
};

}  // namespace quayside::harness
