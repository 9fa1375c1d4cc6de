// How a master steps its units: the co-simulation algorithms, behind one interface.
//
//   jacobi            all units step with the inputs of the step's beginning
//   gauss_seidel      units step in turn, each with inputs from those that have stepped already
//   iterated          steps again and again from the same beginning until what is connected agrees at the end
//   error_controlled  Gauss-Seidel in steps that are as long as the error of the connected values allows
//
// With inputs held over a step, the first two have an error of the order of the step, the third of its square. The
// last two go back to the beginning of a step: every unit has to save and restore its state.
#pragma once

#include <memory>
#include <string>

#include "harness/masters/network.h"

namespace quayside::harness {

// Of an iteration: converging, it gains a digit in a few; what has not converged after so many never will.
constexpr int kMaxRounds = 50;

struct MasterSettings {
  std::string method = "gauss_seidel";
  // Of connected values, relative to the largest in the same unit of measurement so far: what an iteration may leave, or
  // what a step may be wrong by.
  double tolerance = 1e-6;
  // What an iteration takes over of a new value, in (0, 1]. Less where stiff connections make iterations diverge.
  double relaxation = 1;
};

class Method {
 public:
  virtual ~Method() = default;

  // From `now` to `goal`, or less far where an event ends the step or the method wants a shorter one. Then all units
  // stand at the time that is returned, with inputs of that time. Throws StepFailed.
  virtual Reached step(Network& network, Time now, Time goal) = 0;

  // What steps leave behind for the next one. `restart`: nothing.
  virtual void restart() {}
  virtual void save(ByteWriter&) const {}
  virtual void restore(ByteReader&) {}
};

// Throws std::invalid_argument for a method that does not exist, a tolerance or relaxation out of range.
std::unique_ptr<Method> make_method(const MasterSettings& settings);

std::unique_ptr<Method> make_jacobi();
std::unique_ptr<Method> make_gauss_seidel();
std::unique_ptr<Method> make_iterated(double tolerance, double relaxation);
std::unique_ptr<Method> make_error_controlled(double tolerance);

}  // namespace quayside::harness
