// A case as one unit, stepped from outside: prints the height of the load every half second.
#include <cstdio>
#include <exception>

#include "cases/case.h"
#include "harness/fmi/case_unit.h"

int main(int argc, char** argv) {
  using namespace quayside;
  if (argc != 2) {
    std::fprintf(stderr, "usage: step_case CASE.yaml\n");
    return 2;
  }
  try {
    const cases::Case description = cases::load_case(argv[1]);
    harness::CaseUnit crane("crane", description);
    harness::ValueReference height = 0;
    while (height < crane.variables().size() && crane.variables()[height].name != "load.position.z") ++height;

    crane.enter_initialization_mode(0);
    crane.exit_initialization_mode();
    crane.update_discrete_states();
    crane.enter_step_mode();
    const harness::Time step = harness::nanoseconds(0.5), end = harness::nanoseconds(description.duration);
    for (harness::Time time = 0; time + step <= end; time += step) {
      crane.do_step(time, step);
      std::printf("%4.1f s  %9.6f m\n", harness::seconds(time + step), crane.get(height));
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "step_case: %s\n", error.what());
    return 1;
  }
}
