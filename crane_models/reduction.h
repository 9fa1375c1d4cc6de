// "Model only what a scene needs": the Scene reduced to what its script can move.
#pragma once

#include <string>
#include <vector>

#include "crane_models/scene.h"

namespace quayside::crane_models {

// What the script does with the scene, as far as the reduction needs to know.
struct ScriptUse {
  std::vector<bool> drives_used;    // some command gives this drive a speed
  std::vector<bool> commands_used;  // some command changes it from its start
  std::vector<double> drive_travel;  // how far its value may go from its start at most [unit]
  std::vector<int> drive_changes;    // how often its speed changes
};

struct ReductionReport {
  struct Entry {
    std::string what;    // "load merged into spreader"
    std::string reason;  // "twistlocks stay closed for the whole script"
  };
  std::vector<Entry> entries;
  int bodies_before = 0, bodies_after = 0;
  int degrees_of_freedom_before = 0, degrees_of_freedom_after = 0;
  int pairs_before = 0, pairs_after = 0;
};

// Conservative: what might matter stays. Reported frames and drives keep their names.
Scene reduce(const Scene& full, const ScriptUse& use, ReductionReport& report);

}  // namespace quayside::crane_models
