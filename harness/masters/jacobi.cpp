#include "harness/masters/method.h"

namespace quayside::harness {
namespace {

// Every unit holds the inputs of the step's beginning, so that their order does not matter but for events: the first unit
// may stop early at one of its own, and the others follow to there.
class Jacobi final : public Method {
 public:
  Reached step(Network& network, Time now, Time goal) override {
    Reached reached{goal};
    for (std::size_t i = 0; i < network.units().size() && reached.time > now; ++i) network.step(i, now, reached);
    network.carry_all(reached.time);
    return reached;
  }
};

}  // namespace

std::unique_ptr<Method> make_jacobi() { return std::make_unique<Jacobi>(); }

}  // namespace quayside::harness
