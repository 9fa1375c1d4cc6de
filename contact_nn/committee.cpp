#include "contact_nn/committee.h"

#include <string_view>

#include "contact_nn/embedded_networks.h"
#include "contact_nn/gate_features.h"
#include "contact_nn/law_parameters.h"
#include "contact_nn/manifold.h"
#include "contact_nn/points_law.h"
#include "contact_nn/potential_law.h"
#include "contact_nn/separating_axes.h"

namespace quayside::contact_nn {

namespace {

NetworkFile gate_file(Law law, const ContactSettings& settings) {
  if (settings.network.empty() || settings.law != law) return shipped_gate(law);
  return read_network(settings.network, law == Law::potential ? kPotentialInterface : kPointsInterface);
}

class CommitteeModule final : public ContactModule {
 public:
  explicit CommitteeModule(const ContactSettings& settings)
      : law_(settings.law),
        parameters_(law_parameters(settings)),
        potential_gate_(gate_file(Law::potential, settings).network),
        points_gate_(gate_file(Law::points, settings).network) {}

  Manifold query(const Box& a, const Box& b, const Pose& X_AB, ContactCounters& counters,
                 double margin) const override {
    ++counters.queries;
    return contact_manifold(a, b, X_AB, margin);
  }

  ContactForce force(const Box& a, const Box& b, const Pose& X_AB, const RelativeVelocity& V_AB,
                     ContactCounters& counters) const override {
    ++counters.queries;
    if (surely_apart(a, b, X_AB)) return {};
    if (law_ == Law::points) return points_force(manifold(a, b, X_AB, counters), X_AB, V_AB, parameters_);
    const GateView view(a, b, X_AB);
    ++counters.network_evaluations;
    const PieceMask named = view.named(potential_gate_(view.inputs)), possible = possible_pieces(a, b, X_AB);
    if ((possible & ~named).any()) {
      ++counters.fallbacks;
      return potential_force(a, b, X_AB, V_AB, parameters_);
    }
    return potential_force(a, b, X_AB, V_AB, parameters_, named & possible);
  }

 private:
  Manifold manifold(const Box& a, const Box& b, const Pose& X_AB, ContactCounters& counters) const {
    ++counters.network_evaluations;
    const std::array<int, 3> named = top_three(points_gate_(GateView(a, b, X_AB).inputs));
    const NamedSeparation found = largest_separation(a, b, X_AB, named);
    if (found.certified) return contact_manifold(a, b, X_AB, 0, found.best);
    ++counters.fallbacks;
    return contact_manifold(a, b, X_AB, 0);
  }

  Law law_;
  LawParameters parameters_;
  PotentialGate potential_gate_;
  PointsGate points_gate_;
};

}  // namespace

NetworkFile shipped_gate(Law law) {
  return law == Law::potential
             ? network_from_bytes(embedded_gate_potential(), kPotentialInterface, "gate_potential.onnx (shipped)")
             : network_from_bytes(embedded_gate_points(), kPointsInterface, "gate_points.onnx (shipped)");
}

std::unique_ptr<ContactModule> make_committee_module(const ContactSettings& settings) {
  return std::make_unique<CommitteeModule>(settings);
}

}  // namespace quayside::contact_nn
