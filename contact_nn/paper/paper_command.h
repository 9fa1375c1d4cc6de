// quayside contact trihedra|evaluate|tune|energy: the paper's data, its tables and its tuning made again, and its module in
// an integrator.
#pragma once

namespace CLI {
class App;
}

namespace quayside::contact_nn {

// Adds these commands to `quayside contact`.
void add_paper_commands(CLI::App& contact_app);

}  // namespace quayside::contact_nn
