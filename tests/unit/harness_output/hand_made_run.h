// Recordings and runs whose every number is known.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "harness/run.h"

namespace quayside::harness {

// One column per signal, at the given times.
struct HandMadeSignal {
  std::string name, unit;
  std::function<double(double)> value;
};

inline Recording recorded(const std::vector<double>& times, const std::vector<HandMadeSignal>& signals) {
  Recording recording;
  recording.times = times;
  for (const HandMadeSignal& signal : signals) {
    recording.names.push_back(signal.name);
    recording.units.push_back(signal.unit);
    recording.columns.emplace_back();
    for (const double t : times) recording.columns.back().push_back(signal.value(t));
  }
  return recording;
}

// `count` + 1 times from `from` to `to`.
inline std::vector<double> evenly(double from, double to, int count) {
  std::vector<double> times;
  for (int i = 0; i <= count; ++i) times.push_back(from + (to - from) * i / count);
  return times;
}

inline std::function<double(double)> constant(double value) {
  return [value](double) { return value; };
}

inline Event event_at(double time, EventKind kind, const std::string& subject, double impulse = 0, double peak_force = 0,
                      double duration = 0) {
  return {nanoseconds(time), kind, subject, impulse, peak_force, duration};
}

// A load that sinks at 0.1 m/s from 1 m for 10 s and lands at 6.5 s, with velocity (0, 0.3, -0.4); `offset` shifts it
// along x, `delay` its landing.
inline EngineRun sinking_load(const std::string& engine, double offset = 0, double delay = 0) {
  EngineRun run;
  run.engine = engine;
  run.trajectory = recorded(evenly(0, 10, 100), {{"load.position.x", "m", constant(offset)},
                                                 {"load.position.y", "m", constant(20)},
                                                 {"load.position.z", "m", [](double t) { return 1 - 0.1 * t; }},
                                                 {"load.orientation.w", "1", constant(1)},
                                                 {"load.orientation.x", "1", constant(0)},
                                                 {"load.orientation.y", "1", constant(0)},
                                                 {"load.orientation.z", "1", constant(0)},
                                                 {"load.velocity.x", "m/s", constant(0)},
                                                 {"load.velocity.y", "m/s", constant(0.3)},
                                                 {"load.velocity.z", "m/s", constant(-0.4)}});
  run.events = {event_at(6.4 + delay, EventKind::contact_made, "load/upper"),
                event_at(6.5 + delay, EventKind::landed, "spreader.landed"),
                event_at(6.9 + delay, EventKind::rope_slack, "rope.front_left"),
                event_at(7.0 + delay, EventKind::contact_broken, "load/upper", 1.5e4, 6e5, 0.6)};
  run.open_contacts = {event_at(10, EventKind::contact_broken, "load/lower", 8e5, 3e5, 2.5)};
  run.energy = {100, 900, 500, 1500, 2000, 1600};
  run.statistics = {250, 700, 12, {5000, 4900, 20}, 0};
  run.wall_s = 0.5;
  run.simulated_s = 10;
  for (int i = 1; i <= 100; ++i) run.step_times_s.push_back(1e-3 * i);
  return run;
}

// One free body, reported as "load", above a static one.
inline RunResult hand_made_run(std::vector<EngineRun> engines) {
  RunResult result;
  result.description.file = "cases/sinking.yaml";
  result.description.name = "sinking";
  result.description.title = "A load sinks";
  result.description.duration = 10;
  crane_models::Body load;
  load.name = "load";
  load.mass = 30480;
  crane_models::Body ground;
  ground.name = "ground";
  ground.joint.type = crane_models::JointType::fixed;
  result.scene.bodies = {ground, load};
  result.scene.frames = {{"load", 1}};
  result.scene.pairs = {{0, 0, 1, 0}};
  result.reduction.entries = {{"spreader merged into load", "twistlocks stay closed for the whole script"}};
  result.reduction.bodies_before = 3;
  result.reduction.bodies_after = 2;
  result.reduction.degrees_of_freedom_before = 12;
  result.reduction.degrees_of_freedom_after = 6;
  result.reduction.pairs_before = 4;
  result.reduction.pairs_after = 1;
  result.engines = std::move(engines);
  return result;
}

}  // namespace quayside::harness
