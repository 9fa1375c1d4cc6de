// The impacts whose responses are kept: one box that strikes another, or the ground, in every way that matters.
#pragma once

#include <string>
#include <vector>

#include "contact_nn/contact.h"
#include "crane_models/scene.h"

namespace quayside::harness {

enum class Feature { face, edge, vertex, crossing };  // what strikes; crossing: an edge on an edge
enum class Struck { ground, box, hanging };           // hanging: both boxes hang on four ropes, and the blow comes from the side

struct Impact {
  Feature feature;
  Struck struck;
  double speed;     // at which the two approach along the normal [m/s]
  double mass;      // of the box that strikes [kg]
  double friction;  // Coulomb coefficient; with it the blow is oblique, by `kObliqueness`
  std::string name() const;  // "vertex on ground, 0.5 m/s, 30.48 t, oblique"
};

// Sliding speed over approach speed of oblique blows: an angle of 40° to the normal.
constexpr double kObliqueness = 0.8391;

// All of them.
std::vector<Impact> impact_matrix();

// The bodies are "struck" and "box", which is about to touch; the first point that touches is at the world's origin,
// `normal_W` points from the struck body to the box. Without gravity, but for hanging boxes.
struct ImpactScene {
  crane_models::Scene scene;
  Eigen::Vector3d normal_W = Eigen::Vector3d::UnitZ();
  double time_of_touch = 0;  // [s]
};
ImpactScene impact_scene(const Impact& impact);

}  // namespace quayside::harness
