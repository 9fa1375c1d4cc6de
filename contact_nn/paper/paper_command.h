// quayside contact trihedra|evaluate|tune: the paper's data, its tables and its tuning made again.
#pragma once

namespace CLI {
class App;
}

namespace quayside::contact_nn {

// Adds the three commands to `quayside contact`.
void add_paper_commands(CLI::App& contact_app);

}  // namespace quayside::contact_nn
