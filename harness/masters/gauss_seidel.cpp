#include "harness/masters/method.h"

namespace quayside::harness {
namespace {

// Units step in turn; those that come later hold inputs of the step's end from those that came earlier.
class GaussSeidel final : public Method {
 public:
  Reached step(Network& network, Time now, Time goal) override {
    Reached reached{goal};
    for (std::size_t i = 0; i < network.units().size() && reached.time > now; ++i) {
      network.carry_to(i, now);
      network.step(i, now, reached);
    }
    network.carry_all(reached.time);
    return reached;
  }
};

}  // namespace

std::unique_ptr<Method> make_gauss_seidel() { return std::make_unique<GaussSeidel>(); }

}  // namespace quayside::harness
